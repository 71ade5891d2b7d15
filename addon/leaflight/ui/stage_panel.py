# SPDX-License-Identifier: GPL-3.0-or-later
"""The Stage panel, and the strip above the viewport, which works without the sidebar."""

import bpy

from .. import props
from ..bake import bake, stopped
from ..operators import jobs
from ..operators.checks import active_volume
from ..stage import hidden, presets, stage
from ..stage import orientation as orientation_of
from ..translations import iface_
from .sidebar import VolumePanel, sentence, split


class LEAFLIGHT_PT_stage(VolumePanel, bpy.types.Panel):
    bl_label = "Stage"

    def draw(self, context):
        layout = self.layout
        chosen = context.scene.leaflight_stage
        layout.prop(chosen, "preset", text="")
        if chosen.preset == presets.MY_SCENE:
            layout.prop(chosen, "collection", text="")
        layout.operator(stage.LEAFLIGHT_OT_stage.bl_idname, icon="CUBE")
        layout.operator(stage.LEAFLIGHT_OT_frame_isosurface.bl_idname, icon="CAMERA_DATA")
        if chosen.preset != presets.MY_SCENE:
            layout.prop(chosen, "height")
        self._draw_orientation(context)
        overlay = getattr(context.space_data, "overlay", None)
        if overlay is not None:
            layout.prop(overlay, "show_overlays", text="Grid and Outlines")
        others = hidden.all_hidden(context.scene)
        if others:
            sentence(context, layout, iface_("Hidden: %s") % hidden.names(others), icon="HIDE_ON")
            layout.operator(hidden.LEAFLIGHT_OT_show_hidden.bl_idname, icon="LOOP_BACK")
        for warning in chosen.warnings.splitlines():
            sentence(context, layout, warning, icon="ERROR")
        if active_volume(context).leaflight.bake_walls:
            layout.prop(context.scene.leaflight, "show_walls")

    def _draw_orientation(self, context):
        """Draws the orientation of the volume, and the buttons that rotate it by 90 degrees."""
        orientation = active_volume(context).leaflight_orientation
        if orientation.is_unknown:
            text = iface_("The file has no orientation: choose Up and Front")
            sentence(context, self.layout, text, icon="QUESTION")
        column = self.layout.column(align=True)
        column.enabled = jobs.running() is None
        split(column)
        props.draw(column, orientation, "up", "front")
        row = column.row(align=True)
        row.label(text="Turn 90 Degrees")
        for way, icon in (("TIP", "TRIA_DOWN"), ("ROLL", "FILE_REFRESH"), ("TURN", "TRIA_RIGHT")):
            turn = orientation_of.LEAFLIGHT_OT_turn_volume.bl_idname
            row.operator(turn, text="", icon=icon).way = way


class LEAFLIGHT_MT_stage(bpy.types.Menu):
    bl_label = "Stage"
    bl_description = "Choose objects around the volumes"

    def draw(self, _context):
        for key, preset in presets.PRESETS.items():
            operator = self.layout.operator(
                stage.LEAFLIGHT_OT_stage.bl_idname, text=preset.name, icon=preset.icon
            )
            operator.preset = key


def _draw_strip(header, context):
    obj = active_volume(context)
    if obj is None or context.mode != "OBJECT":
        return
    row = header.layout.row(align=True)
    slider = row.row(align=True)
    slider.ui_units_x = 10
    slider.prop(obj.leaflight, '["isovalue"]', text="Isovalue", slider=True)
    row.separator()
    button = row.row(align=True)
    button.ui_units_x = 4
    button.operator(stage.LEAFLIGHT_OT_stage.bl_idname, icon="CUBE")
    row.menu("LEAFLIGHT_MT_stage", text="", icon="DOWNARROW_HLT")
    row.separator()
    _draw_bake(row)
    header.layout.separator()


def _draw_bake(row):
    work = jobs.running()
    button = row.row(align=True)
    if work is not None:
        button.ui_units_x = 12
        button.label(text=work.status(), icon="TIME")
        row.operator(stopped.LEAFLIGHT_OT_stop_bake.bl_idname, text="", icon="CANCEL")
    elif stopped.offered() is not None:
        row.operator(stopped.LEAFLIGHT_OT_keep_bake.bl_idname, icon="CHECKMARK")
        row.operator(stopped.LEAFLIGHT_OT_throw_bake_away.bl_idname, text="", icon="TRASH")
    else:
        button.ui_units_x = 4
        button.operator(bake.LEAFLIGHT_OT_bake.bl_idname, text="Bake", icon="LIGHT_AREA")


def register():
    bpy.types.VIEW3D_HT_tool_header.prepend(_draw_strip)


def unregister():
    bpy.types.VIEW3D_HT_tool_header.remove(_draw_strip)
