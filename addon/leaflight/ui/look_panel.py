# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of how the isosurfaces look."""

import bpy

from ..operators.checks import active_volume
from ..show import look, surface_material
from . import isosurface_look
from .sidebar import VolumePanel, sentence, split


class LEAFLIGHT_PT_isosurfaces(VolumePanel, bpy.types.Panel):
    bl_label = "Isosurfaces"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        split(layout)
        volume = active_volume(context)
        settings = volume.leaflight
        layout.operator_menu_enum(
            isosurface_look.LEAFLIGHT_OT_isosurface_preset.bl_idname, "preset", text="Look"
        )
        layout.prop(settings, "isosurface_scattering")
        if settings.isosurface_scattering == "GLASS":
            layout.prop(settings, "isosurface_ior")
        row = layout.row()
        if settings.isosurface_stops:
            row.template_list(
                "LEAFLIGHT_UL_stops",
                "",
                settings,
                "isosurface_stops",
                settings,
                "isosurface_stop",
                rows=3,
            )
        else:
            row.prop(settings, "isosurface_albedo")
        buttons = row.column(align=True)
        buttons.operator(isosurface_look.LEAFLIGHT_OT_add_stop.bl_idname, text="", icon="ADD")
        if settings.isosurface_stops:
            buttons.operator(
                isosurface_look.LEAFLIGHT_OT_remove_stop.bl_idname, text="", icon="REMOVE"
            )
        column = layout.column(align=True)
        column.prop(settings, "isosurface_emission")
        column.prop(settings, "isosurface_emission_strength")
        layout.prop(settings, "capped")
        column = layout.column(align=True)
        column.prop(volume.leaflight_look, "gloss")
        row = column.row()
        row.active = volume.leaflight_look.gloss > 0
        row.prop(volume.leaflight_look, "roughness")
        layout.prop(volume.leaflight_look, "opacity")
        layout.prop(volume.leaflight_look, "dust")
        if surface_material.is_recolored(volume):
            sentence(context, layout, look.NEW_COLOR, icon="INFO")


class LEAFLIGHT_UL_stops(bpy.types.UIList):
    """The stops of the color ramp, each with its isovalue and its color."""

    def draw_item(self, _context, layout, _data, item, _icon, _active, _property):
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(item, "isovalue", text="", emboss=False)
        row.prop(item, "color", text="")


CLASSES = (LEAFLIGHT_UL_stops, LEAFLIGHT_PT_isosurfaces)
