# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the baked still beside that of Cycles."""

import bpy

from ..compare import render_comparison
from ..operators.checks import active_volume
from ..show import added
from .sidebar import VolumePanel, sentence


class LEAFLIGHT_PT_comparison(VolumePanel, bpy.types.Panel):
    bl_label = "Comparison"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, volume = self.layout, active_volume(context)
        layout.operator(
            render_comparison.LEAFLIGHT_OT_render_comparison.bl_idname, icon="RENDER_STILL"
        )
        if added.added_to(volume):
            sentence(context, layout, "Of the volume's own isosurface alone", icon="INFO")
        comparison = volume.leaflight.comparison
        if comparison:
            sentence(context, layout, comparison)


CLASSES = (LEAFLIGHT_PT_comparison,)
