# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""File > Export > Leaflight: the light of the active volume for other programs."""

from pathlib import Path

import bpy
import leaflight
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper
from leaflight.export.export import OF_SEQUENCE, OF_VOLUME, PAGE, SUFFIXES
from leaflight.export.page_volume import estimated_bytes

from ..operators import background, checks
from ..operators.active_volume import active_volume
from ..show import isovalues, lamps
from ..store import cache

LeaflightError = leaflight.LeaflightError

_FORMATS = (
    (".glb", "glTF (.glb)", "Lit isosurfaces for browsers and slides, unlit vertex colors"),
    (".usdc", "USD (.usdc)", "Lit isosurfaces, several as frames"),
    (".usda", "USD as Text (.usda)", "Lit isosurfaces, several as frames"),
    (".ply", "PLY (.ply)", "One lit isosurface with its radiance"),
    (".vtp", "ParaView Surface (.vtp)", "One lit isosurface with its radiance"),
    (".vti", "ParaView Volume (.vti)", "The values with the radiance of all isosurfaces"),
    (".am", "Amira Colors (.am)", "The colors of all isosurfaces, four bytes a texel"),
    (PAGE, "Web Page (.html)", "All isosurfaces with their light, in any browser, by itself"),
)


class ExportJob(background.Job):
    """The file is written in the background; large volumes take their time."""

    def __init__(self, obj, path, values, coarser=0):
        self._bake, self._index = lamps.bake_of(obj), obj.leaflight.bake_index
        if self._bake is None:
            raise LeaflightError(f'"{obj.name}" has no bake yet: bake it first.')
        self._path, self._coarser = path, coarser
        self._isovalues = values
        self._surfaces = {}

    def run(self, progress):
        self._surfaces = leaflight.export(
            self._bake,
            self._path,
            self._isovalues,
            volume=self._index,
            progress=progress,
            coarser=self._coarser,
        )

    def ended(self):
        return "The export was cancelled; nothing was written"

    def apply(self):
        size = self._path.stat().st_size / 2**20
        triangles = sum(len(surface.triangles) for surface in self._surfaces.values())
        what = f"{triangles} triangles, " if self._surfaces else ""
        return f"{self._path.name}: {what}{size:.1f} MB"


class LEAFLIGHT_OT_export(background.BackgroundOperator, bpy.types.Operator, ExportHelper):
    bl_idname = "leaflight.export"
    bl_label = "Export Lit Isosurfaces"
    bl_description = (
        "Write the lit isosurface of the selected volume, several, or the light of all of them, "
        "for ParaView, amira, browsers and other programs"
    )

    filename_ext = ".glb"
    check_extension = None
    filter_glob: StringProperty(
        default=";".join(f"*{suffix}" for suffix in SUFFIXES), options={"HIDDEN"}
    )
    file_type: EnumProperty(
        name="Format", description="Kind of file to write", items=_FORMATS, default=".glb"
    )
    isovalues: EnumProperty(
        name="Isovalues",
        description="Which isosurfaces to write",
        items=(
            ("CURRENT", "Current", "The isosurface that is shown"),
            ("RANGE", "Range", "Several at even distances, as the frames of an animation"),
            ("LIST", "List", "These, as the frames of an animation"),
        ),
    )
    first: FloatProperty(name="From", description="Isovalue of the first isosurface")
    last: FloatProperty(name="To", description="Isovalue of the last isosurface")
    count: IntProperty(
        name="Count", description="Number of isosurfaces", default=24, min=2, soft_max=250
    )
    listed: StringProperty(
        name="List", description="Isovalues to write in their order, separated by spaces"
    )
    coarser: IntProperty(
        name="Coarser",
        description="Halve voxels and texels so many times along each axis, for a smaller file",
        min=0,
        max=3,
    )
    asked: BoolProperty(options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        return cls.is_free() and checks.has_bake(cls, context)

    def invoke(self, context, event):
        if self.asked:
            return self.run_modal(context)
        self._by_hand = True
        settings = active_volume(context).leaflight
        self.first, self.last = isovalues.isovalue_range(settings)
        if not self.filepath:  # type: ignore[has-type]
            self.filepath = f"{active_volume(context).name}{self.file_type}"
        self.check(context)
        return ExportHelper.invoke(self, context, event)

    def check(self, _context):
        """The name follows the format that is chosen."""
        path = Path(self.filepath)
        if path.suffix.lower() == self.file_type:
            return False
        known = path.suffix.lower() in SUFFIXES
        self.filepath = str(path.with_suffix("") if known else path) + self.file_type
        return True

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "file_type")
        if self.file_type == PAGE:
            layout.prop(self, "coarser")
            layout.label(text=self._size_of_page(active_volume(context)))
            return
        if self.file_type in OF_VOLUME:
            return
        if self.file_type in OF_SEQUENCE:
            layout.row().prop(self, "isovalues", expand=True)
            if self.isovalues == "RANGE":
                column = layout.column(align=True)
                for name in ("first", "last", "count"):
                    column.prop(self, name)
            elif self.isovalues == "LIST":
                layout.prop(self, "listed")

    def execute(self, context):
        if getattr(self, "_by_hand", False):
            # What the file browser executes cannot itself go on in the background.
            names = ("filepath", "file_type", "isovalues", "first", "last", "count", "listed")
            chosen = {name: getattr(self, name) for name in (*names, "coarser")}
            if self.file_type not in OF_SEQUENCE:
                # What was chosen for another format is not shown for this one.
                chosen["isovalues"] = "CURRENT"
            return bpy.ops.leaflight.export("INVOKE_DEFAULT", asked=True, **chosen)
        return super().execute(context)

    def start(self, context):
        path = Path(bpy.path.abspath(self.filepath))
        obj, suffix = active_volume(context), path.suffix.lower()
        if suffix in OF_VOLUME:
            return ExportJob(obj, path, None)
        values = [obj.leaflight.isovalue] if suffix == PAGE else self._values(obj)
        if len(cache.bake_of(obj).volumes) > 1:
            values = [isovalues.common_isovalue(obj.leaflight, value) for value in values]
        if suffix == PAGE:
            return ExportJob(obj, path, values, self.coarser)
        return ExportJob(obj, path, values)

    def _size_of_page(self, obj):
        try:
            bake = cache.bake_of(obj)
        except LeaflightError:
            bake = None
        if bake is None:
            return ""
        return f"About {estimated_bytes(bake, self.coarser) / 1e6:.0f} MB"

    def _values(self, obj):
        """The isovalues, in data units. Raises LeaflightError."""
        if self.isovalues == "CURRENT":
            return [obj.leaflight.isovalue]
        if self.isovalues == "RANGE":
            return np.linspace(self.first, self.last, self.count)
        try:
            values = [float(value) for value in self.listed.replace(",", " ").split()]
        except ValueError:
            values = []
        if not values:
            raise LeaflightError(
                f'"{self.listed}" is no list of isovalues: give numbers, separated by spaces.'
            )
        return values


def _draw_menu(menu, _context):
    name = LEAFLIGHT_OT_export.bl_idname
    menu.layout.operator(name, text="Leaflight (.glb, .usd, .vti, ...)")
    menu.layout.operator(name, text="Leaflight Web Page (.html)").file_type = PAGE


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_export)
    bpy.types.TOPBAR_MT_file_export.append(_draw_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(_draw_menu)
    bpy.utils.unregister_class(LEAFLIGHT_OT_export)
