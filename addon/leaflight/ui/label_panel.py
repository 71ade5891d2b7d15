# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of what is written beside a volume: a scale bar, and letters for a patient's sides."""

import bpy

from ..operators import checks
from ..operators.checks import active_volume
from ..stage import labels, orientation_cube
from ..translations import iface_
from .sidebar import VolumePanel, sentence


class LEAFLIGHT_OT_add_scale_bar(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.add_scale_bar"
    bl_label = "Scale Bar"
    bl_description = "Put a bar of a round length before the volume, in the unit of its file"

    conditions = (
        *checks.VOLUME,
        checks.needs(
            lambda context: active_volume(context).leaflight.unit, "Choose the unit of length first"
        ),
    )

    def run(self, context):
        labels.add_scale_bar(context, active_volume(context))


class LEAFLIGHT_OT_add_letters(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.add_letters"
    bl_label = "Orientation"
    bl_description = (
        "Put letters at the sides of a patient: R and L, A and P, S and I for right and left, "
        "front and back, up and down"
    )

    def run(self, context):
        labels.add_letters(context, active_volume(context))


class LEAFLIGHT_OT_add_orientation_cube(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.add_orientation_cube"
    bl_label = "Orientation Cube"
    bl_description = (
        "Put a cube into the lower left corner of the camera's picture that turns as the volume "
        "does and names its sides"
    )

    def run(self, context):
        orientation_cube.add_cube(context, active_volume(context))


class LEAFLIGHT_PT_labels(VolumePanel, bpy.types.Panel):
    bl_label = "Scale and Labels"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        settings = active_volume(context).leaflight
        if not settings.unit:
            text = iface_("The file gives no unit of length")
            sentence(context, self.layout, text, icon="QUESTION")
        self.layout.prop(settings, "unit_choice")
        row = self.layout.row(align=True)
        row.operator(LEAFLIGHT_OT_add_scale_bar.bl_idname)
        row.operator(LEAFLIGHT_OT_add_letters.bl_idname)
        self.layout.operator(LEAFLIGHT_OT_add_orientation_cube.bl_idname)


CLASSES = (
    LEAFLIGHT_OT_add_scale_bar,
    LEAFLIGHT_OT_add_letters,
    LEAFLIGHT_OT_add_orientation_cube,
    LEAFLIGHT_PT_labels,
)
