# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Export > Leaflight: the light of the active volume for other programs."""

from pathlib import Path

import bpy
import leaflight
import numpy as np
from bpy_extras.io_utils import ExportHelper
from leaflight import LeaflightError
from leaflight.export.export import OF_SEQUENCE, OF_VOLUME, PAGE, SUFFIXES, absent_package
from leaflight.export.page_size import estimated_bytes

from .. import props, session
from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..props import EnumProperty, FloatProperty, IntProperty, StringProperty
from ..show import exploded, isovalues, lamps, texture
from ..store import cache, source_files
from ..translations import draw_wrapped, iface_

_FORMATS: tuple[tuple[str, str, str], ...] = (
    (".glb", "glTF (.glb)", "Lit isosurfaces for browsers and slides, with unlit vertex colors"),
    (".usdc", "USD (.usdc)", "Lit isosurfaces, several as frames"),
    (".usda", "USD as Text (.usda)", "Lit isosurfaces, several as frames"),
    (".ply", "PLY (.ply)", "One lit isosurface with its radiance"),
    (".vtp", "ParaView Surface (.vtp)", "One lit isosurface with its radiance"),
    (".vti", "ParaView Volume (.vti)", "Values with the radiance of all isosurfaces"),
    (".am", "Amira Colors (.am)", "Colors of all isosurfaces, four bytes per texel"),
)
if bpy.app.version >= (5, 0, 0):
    _FORMATS += (
        (".blend", "Blender (.blend)", "All isosurfaces with a slider, for Blender alone"),
    )

# Cache: (id of a bake, coarser) -> the _SizeJob for a page with its BackgroundWork.
_sizes = session.cache()


class ExportJob(jobs.Job):
    """Writes an export in the background, because large volumes take long."""

    cancelled = "The export was cancelled; nothing was written"

    def __init__(self, obj, path, values, **page):
        """Stores the bake and the isovalues to write. page: Other options of export()."""
        if not obj.leaflight.bake_id:
            raise LeaflightError(f'"{obj.name}" has no bake: bake it first.')
        self._bake, self._index = lamps.whole_of(obj), obj.leaflight.bake_index
        self._textures = _textures_of(obj)
        self._path, self._page = path, page
        self._isovalues = values
        self._surfaces = {}

    def run(self, progress):
        self._surfaces = leaflight.export(
            texture.retextured(self._bake(progress), self._textures),
            self._path,
            self._isovalues,
            volume=0 if self._path.suffix.lower() == PAGE else self._index,
            progress=progress,
            **self._page,
        )

    def apply(self):
        size = self._path.stat().st_size / 2**20
        triangles = sum(len(surface.triangles) for surface in self._surfaces.values())
        what = f"{triangles} triangles, " if self._surfaces else ""
        return f"{self._path.name}: {what}{size:.1f} MB"


class _SizeJob(jobs.Job):
    """Estimates the bytes of a page."""

    def __init__(self, obj, coarser):
        self._bake, self._coarser = cache.whole_of(obj), coarser
        self.bytes = None

    def run(self, progress):
        self.bytes = estimated_bytes(self._bake(progress), self._coarser)


def _size_of(obj, coarser):
    """Returns the estimated bytes of a page, None before the estimate. Raises the error of the
    estimate.
    """
    key = obj.leaflight.bake_id, coarser
    if key not in _sizes:
        job = _SizeJob(obj, coarser)
        _sizes[key] = job, jobs.BackgroundWork(job)
        bpy.app.timers.register(_redraw_browsers)
    job, work = _sizes[key]
    if work.is_alive():
        return None
    work.result()
    return job.bytes


def _redraw_browsers():
    """Redraws the file browsers from a timer, to show finished estimates."""
    goes_on = any(work.is_alive() for _, work in _sizes.values())
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "FILE_BROWSER":
                area.tag_redraw()
    return 0.1 if goes_on else None


class _ExportOperator(background.AskingOperator, ExportHelper):
    """Asks for a file by Blender's file browser, then writes it in the background."""

    bl_options = set()
    conditions = (jobs.is_free, *checks.BAKE)
    check_extension = None
    # Suffix of a new name.
    file_type = ""

    def ask(self, context, event):
        if not self.filepath:  # type: ignore[has-type]
            self.filepath = f"{active_volume(context).name}{self.file_type}"
        self.check(context)
        return ExportHelper.invoke(self, context, event)

    def check(self, _context):
        """Changes the suffix of the name to the chosen format."""
        path = Path(self.filepath)
        if path.suffix.lower() == self.file_type:
            return False
        known = path.suffix.lower() in SUFFIXES
        self.filepath = str(path.with_suffix("") if known else path) + self.file_type
        return True

    def start(self, context):
        path = Path(bpy.path.abspath(self.filepath))
        obj, suffix = active_volume(context), path.suffix.lower()
        absent = _absent(suffix)
        if absent:
            raise LeaflightError(f"{path}: {absent}")
        if suffix in OF_VOLUME:
            return ExportJob(obj, path, None)
        values = self.chosen_isovalues(obj)
        if len(cache.light_of(obj).volumes) > 1:
            values = [isovalues.common_isovalue(obj.leaflight, value) for value in values]
        return ExportJob(obj, path, values, **self.page_options(obj))

    def chosen_isovalues(self, obj):
        """Returns the isovalues to write, in data units. Raises LeaflightError."""
        return [obj.leaflight.isovalue]

    def page_options(self, _obj):
        return {}


class LEAFLIGHT_OT_export(_ExportOperator, bpy.types.Operator):
    bl_label = "Export Lit Isosurfaces"
    bl_description = (
        "Write one or several lit isosurfaces, or the light of all, for ParaView, Amira "
        "and other programs"
    )

    filename_ext = ".glb"
    filter_glob: StringProperty(
        default=";".join(f"*{suffix}" for suffix in SUFFIXES if suffix != PAGE), options={"HIDDEN"}
    )
    file_type: EnumProperty("Format", "Format of the file", _FORMATS, default=".glb")
    isovalues: EnumProperty(
        "Isovalues",
        "Isosurfaces to write",
        (
            ("CURRENT", "Current", "The shown isosurface"),
            ("RANGE", "Range", "Evenly spaced isovalues, as the frames of an animation"),
            ("LIST", "List", "A list of isovalues, as the frames of an animation"),
        ),
    )
    first: FloatProperty("From", "Isovalue of the first isosurface")
    last: FloatProperty("To", "Isovalue of the last isosurface")
    count: IntProperty("Count", "Number of isosurfaces", 24, min=2, soft_max=250)
    listed: StringProperty("List", "Isovalues in order, separated by spaces")

    def ask(self, context, event):
        self.first, self.last = isovalues.isovalue_range(active_volume(context).leaflight)
        return super().ask(context, event)

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "file_type")
        draw_wrapped(layout, _absent(self.file_type), 38, icon="ERROR")
        if self.file_type not in OF_SEQUENCE:
            return
        layout.row().prop(self, "isovalues", expand=True)
        if self.isovalues == "RANGE":
            props.draw(layout.column(align=True), self, "first", "last", "count")
        elif self.isovalues == "LIST":
            layout.prop(self, "listed")

    def page_options(self, obj):
        axis = exploded.axis_of(obj)
        if axis is None or self.file_type in OF_VOLUME:
            return {}
        to_world = np.array(obj.leaflight.bake_matrix).reshape(4, 4)[:3, :3]
        return {"explode": obj.leaflight_look.explode_distance * to_world @ axis}

    def chosen(self):
        # Ignore the isovalues that were chosen for another format.
        alone = {} if self.file_type in OF_SEQUENCE else {"isovalues": "CURRENT"}
        return {**super().chosen(), **alone}

    def chosen_isovalues(self, obj):
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
                f'"{self.listed}" is not a list of isovalues: give numbers, separated by spaces.'
            )
        return values


class LEAFLIGHT_OT_export_page(_ExportOperator, bpy.types.Operator):
    bl_label = "Export Web Page"
    bl_description = "Write a web page that shows all isosurfaces with their light in any browser"

    filename_ext = file_type = PAGE
    filter_glob: StringProperty(default=f"*{PAGE}", options={"HIDDEN"})
    coarser: IntProperty(
        "Coarser",
        "Number of times to halve the voxels and texels along each axis, for a smaller file",
        min=0,
        max=3,
    )

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "coarser")
        layout.label(text=self._size(active_volume(context)))

    def page_options(self, obj):
        return {"coarser": self.coarser, "lengths": _lengths(obj)}

    def _size(self, obj):
        # The volume may be deleted while the browser is open.
        if obj is None or not obj.leaflight.bake_id:
            return ""
        try:
            size = _size_of(obj, self.coarser)
        except Exception:  # the export reports why the page cannot be written
            return ""
        return iface_("Estimating its size") if size is None else f"About {size / 1e6:.0f} MB"


def _absent(suffix):
    """Returns a sentence about the missing package of a format, or an empty text."""
    package = absent_package(suffix)
    if package is None:
        return ""
    of_debian = {"vtk": "python3-vtk9", "meshio": "python3-meshio"}.get(package)
    return (
        f"writing {suffix} needs the Python package {package}, which Blender's Python lacks: "
        + source_files.remedy(of_debian, "use the command 'leaflight export' instead.")
    )


def _textures_of(obj):
    """Returns {number: texture or None} of the volumes that the bake of an object lights."""
    identifier = obj.leaflight.bake_id
    volumes = [
        other for other in obj.users_scene[0].objects if other.leaflight.bake_id == identifier
    ]
    # A copy of the object may have another texture.
    return {each.leaflight.bake_index: texture.texture_in_bake(each) for each in (*volumes, obj)}


def _lengths(obj):
    """Returns (length, unit) of a Blender unit in the coordinates of the file."""
    scales = obj.matrix_world.to_scale()
    if max(scales) - min(scales) > 1e-4 * max(scales):
        return 1.0, "units of Blender"
    return 1.0 / max(scales), obj.leaflight.unit


def _draw_menu(menu, _context):
    menu.layout.operator(
        LEAFLIGHT_OT_export.bl_idname, text="Leaflight Isosurfaces (.glb, .usd, .vti, ...)"
    )
    menu.layout.operator(LEAFLIGHT_OT_export_page.bl_idname, text="Leaflight Web Page (.html)")


MENUS = (("TOPBAR_MT_file_export", _draw_menu),)
