# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""File > Import > Volume for Leaflight."""

import bpy
import leaflight
from bpy.props import (
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    IntVectorProperty,
    StringProperty,
)
from bpy_extras.io_utils import ImportHelper

from ..show import isovalues, properties, surface_object
from ..store import cache, source_files


class LEAFLIGHT_OT_import_volume(bpy.types.Operator, ImportHelper):
    bl_idname = "leaflight.import_volume"
    bl_label = "Import Volume"
    bl_description = "Read a scalar volume and show one of its isosurfaces"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(
        default="*.vdb;*.nii;*.nii.gz;*.nrrd;*.nhdr;*.raw;*.tif;*.tiff", options={"HIDDEN"}
    )
    size: FloatProperty(
        name="Size",
        description="Length of the volume's longest side in Blender units",
        default=2.0,
        min=1e-3,
        soft_max=100.0,
    )
    dims: IntVectorProperty(
        name="Dimensions", description="Voxels along x, y and z of a .raw file", size=3, min=0
    )
    value_type: EnumProperty(
        name="Type",
        description="Type of the values in a .raw file",
        items=properties.VALUE_TYPE_ITEMS,
    )
    endian: EnumProperty(
        name="Byte Order",
        description="Byte order of the values in a .raw file",
        items=properties.ENDIAN_ITEMS,
    )
    spacing: FloatVectorProperty(
        name="Voxel Size",
        description="Distance of the voxels along x, y and z, for .raw files and TIFF stacks",
        size=3,
        default=(1.0, 1.0, 1.0),
        min=1e-9,
    )
    frame: IntProperty(
        name="Frame",
        description="Which volume of a series to read, counted from 0; -1 for a single volume",
        default=-1,
        min=-1,
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "size")
        layout.prop(self, "frame")
        suffix = self.filepath.lower().rpartition(".")[2]
        if suffix == "raw":
            layout.prop(self, "dims")
            layout.prop(self, "value_type")
            layout.prop(self, "endian")
        if suffix in {"raw", "tif", "tiff"}:
            layout.prop(self, "spacing")

    def execute(self, context):
        path = bpy.path.abspath(self.filepath)
        layout = {
            "dims": tuple(self.dims),
            "value_type": self.value_type,
            "endian": self.endian,
            "spacing": tuple(self.spacing),
            "frame": self.frame,
        }
        try:
            volume = source_files.read_volume(path, **layout)
            low, high = volume.field().range
            window = leaflight.default_window(volume)
            isovalue = leaflight.default_isovalue(volume)
        except leaflight.LeaflightError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

        obj = surface_object.create(context, volume, self.size)
        settings = obj.leaflight
        settings.source = path
        for name, value in layout.items():
            setattr(settings, name, value)
        settings.low, settings.high = window
        settings.is_volume = True
        cache.forget_unused()
        cache.keep_volume(obj, volume)
        settings["isovalue"] = isovalue
        settings.limit_isovalue((low, high), window, isovalue)
        surface_object.update(obj, isovalue)

        for other in context.selected_objects:
            other.select_set(False)
        obj.select_set(True)
        context.view_layer.objects.active = obj
        isovalues.lock_interface(context.scene)
        nz, ny, nx = volume.values.shape
        self.report(
            {"INFO"}, f"{volume.name}: {nx} x {ny} x {nz} voxels, values {low:g} to {high:g}"
        )
        return {"FINISHED"}


def _draw_menu(menu, _context):
    menu.layout.operator(LEAFLIGHT_OT_import_volume.bl_idname, text="Volume for Leaflight")


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_import_volume)
    bpy.types.TOPBAR_MT_file_import.append(_draw_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(_draw_menu)
    bpy.utils.unregister_class(LEAFLIGHT_OT_import_volume)
