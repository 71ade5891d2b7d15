# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of what surrounds the volumes."""

import bpy

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
        """Which way the volume stands, and the turns by 90 degrees that change it."""
        orientation = active_volume(context).leaflight_orientation
        if orientation.is_unknown:
            text = iface_("The file has no orientation: choose Up and Front")
            sentence(context, self.layout, text, icon="QUESTION")
        column = self.layout.column(align=True)
        column.enabled = jobs.running() is None
        split(column)
        column.prop(orientation, "up")
        column.prop(orientation, "front")
        row = column.row(align=True)
        row.label(text="Turn 90 Degrees")
        for way, icon in (("TIP", "TRIA_DOWN"), ("ROLL", "FILE_REFRESH"), ("TURN", "TRIA_RIGHT")):
            turn = orientation_of.LEAFLIGHT_OT_turn_volume.bl_idname
            row.operator(turn, text="", icon=icon).way = way


CLASSES = (LEAFLIGHT_PT_stage,)
