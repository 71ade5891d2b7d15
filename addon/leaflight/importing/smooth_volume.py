# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth: reads the volume again, with a Gaussian on its values or its normals."""

import bpy

from ..operators import background
from ..operators.checks import active_volume
from ..props import EnumProperty
from . import read_again


class LEAFLIGHT_OT_smooth(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Smooth"
    bl_description = (
        "Smooth the values against noise and 8-bit steps, or only the normals, so that "
        "isosurfaces stay where they are. A bake keeps its values, so bake again"
    )
    conditions = read_again.CONDITIONS

    what: EnumProperty(
        "Apply To",
        items=[
            ("smooth", "Values", "Values, and with them isosurfaces and normals"),
            ("smooth_normals", "Normals", "Only normals; isosurfaces do not change"),
        ],
    )
    amount: EnumProperty(
        "Smooth",
        items=[
            ("0", "Not Smoothed", "As in the file"),
            ("0.5", "By 0.5 Voxels", "Standard deviation of the Gaussian"),
            ("1", "By 1 Voxel", "Standard deviation of the Gaussian; suits most 8-bit scans"),
            ("1.5", "By 1.5 Voxels", "Standard deviation of the Gaussian"),
            ("2", "By 2 Voxels", "Standard deviation of the Gaussian"),
            ("3", "By 3 Voxels", "Standard deviation of the Gaussian"),
        ],
        default="1",
    )

    def start(self, context):
        amount = float(self.amount)
        normals = "normals " if self.what == "smooth_normals" else ""
        text = f"{normals}smoothed by {amount:g} voxels"
        obj = active_volume(context)
        return read_again.ReadAgainJob(
            obj, "Smooth", self.what, amount, lambda obj: f"{obj.name}: {text}"
        )
