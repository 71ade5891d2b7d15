# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of what surrounds the volumes."""

import bpy

from ..stage import aside, presets, stage
from ..translations import iface_
from .sidebar import VolumePanel, sentence


class LEAFLIGHT_PT_stage(VolumePanel, bpy.types.Panel):
    bl_label = "Stage"

    def draw(self, context):
        layout = self.layout
        chosen = context.scene.leaflight_stage
        layout.prop(chosen, "preset", text="")
        if chosen.preset == presets.MY_SCENE:
            layout.prop(chosen, "collection", text="")
        layout.operator(stage.LEAFLIGHT_OT_stage.bl_idname, icon="CUBE")
        hidden = aside.all_aside(context.scene)
        if hidden:
            sentence(context, layout, iface_("Set aside: %s") % aside.names(hidden), icon="HIDE_ON")
            layout.operator(aside.LEAFLIGHT_OT_bring_back.bl_idname, icon="LOOP_BACK")
        for warning in chosen.warnings.splitlines():
            sentence(context, layout, warning, icon="ERROR")
        if context.object.leaflight.bake_surroundings:
            layout.prop(context.scene.leaflight, "show_walls")


def register():
    bpy.utils.register_class(LEAFLIGHT_PT_stage)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_PT_stage)
