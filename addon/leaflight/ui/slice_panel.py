# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the slices of a volume's data."""

import bpy
import leaflight

from ..operators.active_volume import active_volume
from ..show import slices
from ..store import cache
from .sidebar import VolumePanel

_AXES = ("X", "Y", "Z")
# Across the axes of a patient's coordinates.
_OF_A_PATIENT = ("Sagittal", "Coronal", "Axial")


class LEAFLIGHT_PT_slices(VolumePanel, bpy.types.Panel):
    bl_label = "Slices"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        volume = active_volume(context)
        look = volume.leaflight_look
        try:
            data = cache.volume_of(volume)
        except leaflight.LeaflightError:
            return
        column = self.layout.column(align=True)
        for axis, name in enumerate(_OF_A_PATIENT if data.patient else _AXES):
            row = column.split(factor=0.4, align=True)
            row.prop(look, "slice_axes", index=axis, text=name, toggle=True)
            row = row.row(align=True)
            row.active = look.slice_axes[axis]
            text = f"{slices.position(volume, axis):.4g} {data.unit}".rstrip()
            row.prop(look, "slice_places", index=axis, text=text, slider=True)
        if any(look.slice_axes):
            self.layout.prop(look, "slice_colors")
            self.layout.prop(look, "slices_inside")


register, unregister = bpy.utils.register_classes_factory((LEAFLIGHT_PT_slices,))
