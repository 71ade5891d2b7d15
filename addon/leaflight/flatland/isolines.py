# SPDX-License-Identifier: GPL-3.0-or-later
"""Flatland: File > Import > Image for Leaflight, the properties of a graph, and Bake Isolines."""

import time
import uuid

import bpy
import leaflight
from bpy_extras.io_utils import ImportHelper
from leaflight import LeaflightError, flatland
from leaflight.flatland.flat_scene import load_flat_scene

from .. import versions
from ..operators import background, checks, jobs
from ..props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)
from ..show import display
from ..show.bake_properties import ERROR
from . import graph_object


def _changed(settings, _context):
    if settings.is_flatland:
        graph_object.rebuild(settings.id_data)


class LeaflightFlatSettings(bpy.types.PropertyGroup):
    """A graph, its isolines and the settings of its bake: Object.leaflight_flat."""

    source: StringProperty(
        "Image",
        "File of the image; empty is the bump box",
        subtype="FILE_PATH",
        options=versions.RELATIVE_PATH,
    )
    nodes: IntProperty("Nodes", default=200, min=4)
    height: FloatProperty(
        "Height",
        "Height of the graph, as a share of its longest side",
        0.25,
        min=0.0,
        soft_max=1.0,
        update=_changed,
    )
    low: FloatProperty("Lowest Isovalue", "Lowest isovalue that is lit", update=_changed)
    high: FloatProperty("Highest Isovalue", "Highest isovalue that is lit", update=_changed)
    count: IntProperty(
        "Isolines",
        "Number of isolines, evenly spaced between lowest and highest isovalue",
        12,
        min=1,
        soft_max=100,
        update=_changed,
    )
    width: FloatProperty(
        "Line Width",
        "Width of the isolines, as a share of the longest side",
        0.008,
        min=1e-5,
        soft_max=0.1,
        update=_changed,
    )
    brightness_correction: BoolProperty(
        "Brightness Correction",
        "Multiply the light by 2 / pi, to match the same scene in space",
        True,
        update=_changed,
    )
    scene_file: StringProperty(
        "Scene",
        "Scene file with walls and lamps; empty is the flatland box",
        subtype="FILE_PATH",
        options=versions.RELATIVE_PATH,
    )
    resolution: IntProperty(
        "Resolution",
        "Texels along the longest side; 0 takes those that the image needs",
        min=0,
        soft_max=4096,
    )
    error: FloatProperty(**ERROR)
    seed: IntProperty("Seed", "Seed of the random numbers", min=0)
    bake_id: StringProperty("Bake Identifier")
    is_flatland: BoolProperty("Leaflight Flatland")


class LEAFLIGHT_OT_import_image(checks.LeaflightOperator, bpy.types.Operator, ImportHelper):
    bl_label = "Import Image (Flatland)"
    bl_description = "Show the brightness of an image as a graph with isolines"

    filter_glob: StringProperty(default="*.png;*.jpg;*.jpeg;*.tif;*.tiff;*.exr", options={"HIDDEN"})
    source: EnumProperty(
        "Height Field",
        items=[
            ("IMAGE", "Image", "Brightness of the selected image"),
            ("BUMP_BOX", "Bump Box", "Reference data of flatland, without a file"),
        ],
    )
    size: FloatProperty(
        "Size", "Length of the longest side in Blender units", 2.0, min=1e-3, soft_max=100.0
    )
    height: FloatProperty(
        "Height", "Height of the graph, as a share of its longest side", 0.25, min=0.0, soft_max=1.0
    )
    count: IntProperty("Isolines", "Number of isolines", 12, min=1)
    nodes: IntProperty("Nodes", "Nodes along each side of the bump box", 200, min=4)

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "source")
        if self.source == "BUMP_BOX":
            layout.prop(self, "nodes")
        for name in ("size", "height", "count"):
            layout.prop(self, name)

    def run(self, context):
        path = bpy.path.abspath(self.filepath) if self.source == "IMAGE" else ""
        field = flatland.read_image(path) if path else flatland.bump_box_2d(self.nodes)
        low, high = leaflight.default_isovalue_range(field)
        settings = {
            "source": path,
            "nodes": self.nodes,
            "height": self.height,
            "count": self.count,
            "low": low,
            "high": high,
        }
        obj = graph_object.create(context, field, self.size, settings)
        display.select(context, [obj], obj)
        rows, columns = field.values.shape
        self.report({"INFO"}, f"{field.name}: {columns} x {rows} pixels")


def _draw_menu(menu, _context):
    name = LEAFLIGHT_OT_import_image.bl_idname
    menu.layout.operator(name, text="Image for Leaflight, Flatland (.png, .jpg, .tif, .exr)")


class FlatBakeJob(jobs.Job):
    """A bake of all isolines of an image: its inputs, the work, and lighting the object."""

    def __init__(self, obj):
        """Reads the settings. Raises LeaflightError if they cannot be baked."""
        settings = obj.leaflight_flat
        self.object_name = obj.name
        scene = bpy.path.abspath(settings.scene_file)
        self._arguments = {
            "volume": graph_object.field_of(obj),
            "scene": load_flat_scene(scene) if scene else None,
            "isovalues": (settings.low, settings.high),
            "resolution": settings.resolution or None,
            "error": settings.error,
            "seed": settings.seed,
        }
        self.latest = self._shown = None

    def run(self, progress):
        """Bakes the isolines, in any thread. Touches no Blender data."""
        start = time.perf_counter()
        self.bake = flatland.bake_flatland(**self._arguments, on_pass=self._keep, progress=progress)
        if progress.cancelled:
            raise leaflight.Cancelled
        self.seconds = time.perf_counter() - start

    def _keep(self, bake):
        self.latest = bake

    def show(self):
        """Lights the object with the last pass."""
        if self.latest is not self._shown:
            self._shown = self.latest
            self._rebuild(self.latest)

    def ended(self):
        self._rebuild(None)
        return super().ended()

    def _rebuild(self, passed):
        obj = bpy.data.objects.get(self.object_name)
        if obj is not None and obj.leaflight_flat.is_flatland:
            graph_object.rebuild(obj, passed)

    def apply(self):
        obj = bpy.data.objects.get(self.object_name)
        if obj is None or not obj.leaflight_flat.is_flatland:
            raise LeaflightError(
                f'"{self.object_name}" was deleted, so the bake lights nothing: import it again.'
            )
        identifier = uuid.uuid4().hex
        graph_object.keep_bake(identifier, self.bake)
        obj.leaflight_flat.bake_id = identifier
        graph_object.rebuild(obj)
        return f"Baked all isolines in {self.seconds:.1f} s"


class LEAFLIGHT_OT_bake_flatland(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Bake Isolines"
    bl_description = "Compute the light on all isolines within the plane. Esc cancels"
    conditions = (
        jobs.is_free,
        checks.needs(
            lambda context: context.object and context.object.leaflight_flat.is_flatland,
            "Select the graph of an image first (File > Import > Image for Leaflight)",
        ),
        checks.in_object_mode,
    )

    def start(self, context):
        return FlatBakeJob(context.object)


CLASSES = (LeaflightFlatSettings, LEAFLIGHT_OT_import_image, LEAFLIGHT_OT_bake_flatland)
PROPERTIES = ((bpy.types.Object, "leaflight_flat", PointerProperty(LeaflightFlatSettings)),)
MENUS = (("TOPBAR_MT_file_import", _draw_menu),)
