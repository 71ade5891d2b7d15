# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of looks, clip box, slices, animations, labels and comparisons."""

import bpy
from leaflight import LeaflightError

from .. import props
from ..bake import bake
from ..compare import render_comparison
from ..edit import add_isosurface, animation, label_operators, labels, looks
from ..importing import regions
from ..operators.checks import active_volume
from ..show import data_faces, display, exploded, look, surface_material, texture
from ..store import source_files
from ..translations import iface_
from . import clip_outline
from .sidebar import ClosedPanel, sentence, split


class LEAFLIGHT_PT_isosurfaces(ClosedPanel, bpy.types.Panel):
    bl_label = "Isosurfaces"

    def draw(self, context):
        layout = self.layout
        split(layout)
        volume = active_volume(context)
        settings = volume.leaflight
        layout.operator_menu_enum(
            looks.LEAFLIGHT_OT_isosurface_preset.bl_idname, "preset", text="Look"
        )
        layout.prop(settings, "isosurface_scattering")
        if settings.isosurface_scattering == "GLASS":
            layout.prop(settings, "isosurface_ior")
        row = layout.row()
        if settings.isosurface_stops:
            name, stops = "LEAFLIGHT_UL_stops", (settings, "isosurface_stops")
            row.template_list(name, "", *stops, settings, "isosurface_stop", rows=3)
        else:
            row.prop(settings, "isosurface_albedo")
        buttons = row.column(align=True)
        buttons.operator(looks.LEAFLIGHT_OT_add_stop.bl_idname, text="", icon="ADD")
        if settings.isosurface_stops:
            buttons.operator(looks.LEAFLIGHT_OT_remove_stop.bl_idname, text="", icon="REMOVE")
        _draw_texture(layout, volume)
        emission = "isosurface_emission", "isosurface_emission_strength"
        props.draw(layout.column(align=True), settings, *emission)
        layout.prop(settings, "capped")
        shown, column = volume.leaflight_look, layout.column(align=True)
        column.prop(shown, "gloss")
        row = column.row()
        row.active = shown.gloss > 0
        row.prop(shown, "roughness")
        props.draw(layout, shown, "opacity", "dust")
        column = layout.column(align=True)
        column.row(align=True).prop(shown, "explode_axis", expand=True)
        if exploded.axis_of(volume) is not None:
            column.prop(shown, "explode_distance")
            column.operator(regions.LEAFLIGHT_OT_move_parts.bl_idname)
        if surface_material.is_recolored(volume):
            sentence(context, layout, look.NEW_COLOR, icon="INFO")


def _draw_texture(layout, volume):
    settings = volume.leaflight
    layout.prop(settings, "texture_kind")
    if settings.texture_kind not in texture.OWN:
        layout.prop(settings, "texture_volume")
        if settings.texture_volume is None and settings.texture_kind != "CHANNELS":
            return
    if settings.texture_kind == "SLICES" and not texture.is_colored(volume):
        layout.label(text="No capped cut: use Cut Data", icon="INFO")
    if settings.texture_kind == "LABELS":
        _draw_labels(layout, volume)
        return
    if settings.texture_kind == "CHANNELS":
        props.draw(layout, settings, "texture_green", "texture_blue", "texture_srgb")
    else:
        props.draw(layout, settings, "texture_map", "texture_reverse", "texture_steps")
    props.draw(layout.column(align=True), settings, "texture_low", "texture_high")
    layout.prop(settings, "texture_symmetric")


def _draw_labels(layout, volume):
    """Draws the labels of the map that colors a volume."""
    label_map = label_operators.label_map_of(volume)
    if label_map is None:
        return
    settings = label_map.leaflight
    layout.template_list("LEAFLIGHT_UL_labels", "", settings, "labels", settings, "label", rows=6)
    if volume.leaflight.field == "labels":
        row = layout.row(align=True)
        row.use_property_split = False
        row.operator_enum(label_operators.LEAFLIGHT_OT_show_labels.bl_idname, "which")
    layout.operator(label_operators.LEAFLIGHT_OT_read_label_table.bl_idname)


class LEAFLIGHT_UL_labels(bpy.types.UIList):
    """The labels of a label map. The search is by name."""

    def draw_item(self, context, layout, _data, item, _icon, _active, _property):
        row = layout.row(align=True)
        row.use_property_split = False
        # Labels that only color a scan have no surfaces.
        if active_volume(context).leaflight.field == "labels":
            icon = "HIDE_OFF" if item.is_shown else "HIDE_ON"
            row.prop(item, "is_shown", text="", icon=icon, emboss=False)
        row.prop(item, "name", text="", emboss=False)
        color = row.row()
        color.ui_units_x = 2
        color.prop(item, "color", text="")


class LEAFLIGHT_UL_stops(bpy.types.UIList):
    """The stops of the color ramp, each with its isovalue and its color."""

    def draw_item(self, _context, layout, _data, item, _icon, _active, _property):
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(item, "isovalue", text="", emboss=False)
        row.prop(item, "color", text="")


class LEAFLIGHT_PT_clip(ClosedPanel, bpy.types.Panel):
    bl_label = "Clip Box"

    def draw(self, context):
        layout = self.layout
        volume = active_volume(context)
        shown = volume.leaflight_look
        row = layout.row(align=True)
        row.prop(shown, "box", text="", icon="MESH_CUBE")
        row.operator(add_isosurface.LEAFLIGHT_OT_add_clip_box.bl_idname, text="", icon="ADD")
        if shown.box is None or not shown.box.users_scene:
            return
        clip_outline.panel_is_open(context)
        row = layout.row(align=True)
        row.prop(shown, "keep", expand=True)
        in_data = look.is_in_data(volume, shown.box)
        column = layout.column(align=True)
        column.active = not in_data
        column.prop(shown, "cut_colors")
        for obj in display.surfaces_of(volume):
            text = iface_("Cut %s") % f"{obj.leaflight.isovalue:g}"
            column.prop(obj.leaflight_look, "is_cut", text=text)
        layout.operator_menu_enum(regions.LEAFLIGHT_OT_cut_data.bl_idname, "cut", text="Cut Data")
        if in_data and not context.scene.leaflight_live:
            _draw_bake(layout, volume, context)
        if shown.box.type != "EMPTY" and not shown.box.hide_render:
            text = iface_('"%s" is rendered and baked: hide it in renders') % shown.box.name
            sentence(context, layout, text, icon="ERROR")


def _draw_bake(layout, volume, context):
    """Draws a button that lights a cut of the data, unless a bake has lit it."""
    settings = volume.leaflight
    if settings.bake_id and not source_files.regions_alone_changed(settings):
        return
    if settings.bake_id:
        sentence(context, layout, "Light near the cut is an estimate", icon="INFO")
    layout.operator(bake.LEAFLIGHT_OT_bake.bl_idname, text="Bake the Cut", icon="LIGHT_AREA")


_AXES = ("X", "Y", "Z")
# Names of the slices across the axes of a patient.
_OF_A_PATIENT = ("Sagittal", "Coronal", "Axial")


class LEAFLIGHT_PT_slices(ClosedPanel, bpy.types.Panel):
    bl_label = "Slices"

    def draw(self, context):
        volume = active_volume(context)
        settings, shown = volume.leaflight, volume.leaflight_look
        column = self.layout.column(align=True)
        names = _OF_A_PATIENT if source_files.is_patient(settings) else _AXES
        for axis, name in enumerate(names):
            row = column.split(factor=0.4, align=True)
            row.prop(shown, "slice_axes", index=axis, text=name, toggle=True)
            row = row.row(align=True)
            row.active = shown.slice_axes[axis]
            row.prop(shown, "slice_places", index=axis, text=_place(volume, axis), slider=True)
        if any(shown.slice_axes):
            props.draw(self.layout, shown, "slice_colors", "slices_inside")


def _place(volume, axis):
    """Returns the position of a slice as text, in the unit of the file."""
    try:
        return f"{data_faces.slice_position(volume, axis):.4g} {volume.leaflight.unit}".rstrip()
    except LeaflightError:
        return ""


class LEAFLIGHT_PT_animation(ClosedPanel, bpy.types.Panel):
    bl_label = "Animation"

    def draw(self, _context):
        self.layout.row(align=True).operator_enum(animation.LEAFLIGHT_OT_animate.bl_idname, "kind")


class LEAFLIGHT_PT_labels(ClosedPanel, bpy.types.Panel):
    bl_label = "Scale and Labels"

    def draw(self, context):
        settings = active_volume(context).leaflight
        if not settings.unit:
            text = iface_("The file has no unit of length")
            sentence(context, self.layout, text, icon="QUESTION")
        self.layout.prop(settings, "unit_choice")
        row = self.layout.row(align=True)
        row.operator(labels.LEAFLIGHT_OT_add_scale_bar.bl_idname)
        row.operator(labels.LEAFLIGHT_OT_add_letters.bl_idname)
        row = self.layout.row(align=True)
        row.operator(labels.LEAFLIGHT_OT_add_orientation_cube.bl_idname)
        row.operator(labels.LEAFLIGHT_OT_add_color_bar.bl_idname)


class LEAFLIGHT_PT_comparison(ClosedPanel, bpy.types.Panel):
    bl_label = "Comparison"

    def draw(self, context):
        layout, volume = self.layout, active_volume(context)
        layout.operator(
            render_comparison.LEAFLIGHT_OT_render_comparison.bl_idname, icon="RENDER_STILL"
        )
        if display.added_to(volume):
            sentence(context, layout, "Only for the volume's first isosurface", icon="INFO")
        comparison = volume.leaflight.comparison
        if comparison:
            sentence(context, layout, comparison)
