# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Import > Image for Leaflight: flatland."""

import bpy
import leaflight
from bpy.props import EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper
from leaflight import flatland

from ..operators import checks
from ..show import graph_object


class LEAFLIGHT_OT_import_image(checks.LeaflightOperator, bpy.types.Operator, ImportHelper):
    bl_idname = "leaflight.import_image"
    bl_label = "Import Image (Flatland)"
    bl_description = "Show an image as the graph of its brightness, with isolines on it"

    filter_glob: StringProperty(default="*.png;*.jpg;*.jpeg;*.tif;*.tiff;*.exr", options={"HIDDEN"})
    source: EnumProperty(
        name="Height Field",
        items=[
            ("IMAGE", "Image", "The brightness of the chosen image"),
            ("BUMP_BOX", "Bump Box", "The reference data set of flatland; no file is read"),
        ],
    )
    size: FloatProperty(
        name="Size",
        description="Length of the longest side in Blender units",
        default=2.0,
        min=1e-3,
        soft_max=100.0,
    )
    height: FloatProperty(
        name="Height",
        description="Height of the graph as part of its longest side",
        default=0.25,
        min=0.0,
        soft_max=1.0,
    )
    count: IntProperty(name="Isolines", description="Number of isolines", default=12, min=1)
    nodes: IntProperty(
        name="Nodes", description="Nodes along each side of the bump box", default=200, min=4
    )

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
        for other in context.selected_objects:
            other.select_set(False)
        obj.select_set(True)
        context.view_layer.objects.active = obj
        rows, columns = field.values.shape
        self.report({"INFO"}, f"{field.name}: {columns} x {rows} pixels")


def _draw_menu(menu, _context):
    name = LEAFLIGHT_OT_import_image.bl_idname
    menu.layout.operator(name, text="Image for Leaflight, Flatland (.png, .jpg, .tif, .exr)")


CLASSES = (LEAFLIGHT_OT_import_image,)
MENUS = (("TOPBAR_MT_file_import", _draw_menu),)
