# SPDX-License-Identifier: GPL-3.0-or-later
"""The isovalue, Stage and Bake above the viewport, where a scene has a volume: no tab to find."""

import bpy

from ..bake import bake, stopped
from ..operators import jobs
from ..operators.checks import active_volume
from ..stage import presets, stage


class LEAFLIGHT_MT_stage(bpy.types.Menu):
    bl_label = "Stage"
    bl_description = "Choose what to put around the volumes"

    def draw(self, _context):
        for key, preset in presets.PRESETS.items():
            operator = self.layout.operator(
                stage.LEAFLIGHT_OT_stage.bl_idname, text=preset.name, icon=preset.icon
            )
            operator.preset = key


def _draw(header, context):
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


CLASSES = (LEAFLIGHT_MT_stage,)


def register():
    bpy.types.VIEW3D_HT_tool_header.prepend(_draw)


def unregister():
    bpy.types.VIEW3D_HT_tool_header.remove(_draw)
