# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the slices of a volume's data."""

import bpy
from leaflight import LeaflightError

from ..operators.checks import active_volume
from ..show import slices
from ..store import source_files
from .sidebar import VolumePanel

_AXES = ("X", "Y", "Z")
# Across the axes of a patient's coordinates.
_OF_A_PATIENT = ("Sagittal", "Coronal", "Axial")


class LEAFLIGHT_PT_slices(VolumePanel, bpy.types.Panel):
    bl_label = "Slices"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        volume = active_volume(context)
        settings, look = volume.leaflight, volume.leaflight_look
        column = self.layout.column(align=True)
        names = _OF_A_PATIENT if source_files.is_patient(settings) else _AXES
        for axis, name in enumerate(names):
            row = column.split(factor=0.4, align=True)
            row.prop(look, "slice_axes", index=axis, text=name, toggle=True)
            row = row.row(align=True)
            row.active = look.slice_axes[axis]
            row.prop(look, "slice_places", index=axis, text=_place(volume, axis), slider=True)
        if any(look.slice_axes):
            self.layout.prop(look, "slice_colors")
            self.layout.prop(look, "slices_inside")


def _place(volume, axis):
    """Of a slice, as a text in the unit of the file."""
    try:
        return f"{slices.position(volume, axis):.4g} {volume.leaflight.unit}".rstrip()
    except LeaflightError:
        return ""


CLASSES = (LEAFLIGHT_PT_slices,)
