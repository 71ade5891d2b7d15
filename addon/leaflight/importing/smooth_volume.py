# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth: reads the volume again, with a Gaussian on its values or its normals."""

import bpy

from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..props import EnumProperty
from ..show import display, isovalues
from ..store import cache, source_files


class SmoothJob(jobs.Job):
    """Reads the file of a volume object again with different smoothing."""

    name = "Smooth"
    cancelled = "Smoothing was cancelled; nothing has changed"

    def __init__(self, obj, what, amount):
        self._name, self._what, self._amount = obj.name, what, amount
        self._path = source_files.path_of(obj.leaflight)
        self._choices = {**source_files.choices_of(obj.leaflight), what: amount}

    def run(self, progress):
        self._volume = source_files.read_volume(self._path, progress=progress, **self._choices)

    def apply(self):
        obj = bpy.data.objects.get((self._name, None))
        if obj is None or not obj.leaflight.is_volume:
            return self.cancelled
        settings, volume = obj.leaflight, self._volume
        # Set the property without its update, and cache the volume for that update.
        settings[self._what] = self._amount
        cache.keep_volume(obj, volume.capped() if settings.capped else volume)
        setattr(settings, self._what, self._amount)
        for surface in display.surfaces_of(obj):
            isovalues.limit(surface)
        cache.forget_unused()
        normals = "normals " if self._what == "smooth_normals" else ""
        return f"{obj.name}: {normals}smoothed by {self._amount:g} voxels"


_has_file = checks.needs(
    lambda c: active_volume(c).library is None and active_volume(c).leaflight.source,
    "The volume has no volume file: import it",
)


class LEAFLIGHT_OT_smooth(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Smooth"
    bl_description = (
        "Smooth the values against noise and 8-bit steps, or only the normals, so that "
        "isosurfaces stay where they are. A bake keeps its values, so bake again"
    )
    conditions = (jobs.is_free, *checks.VOLUME, _has_file)

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
        return SmoothJob(active_volume(context), self.what, float(self.amount))


CLASSES = (LEAFLIGHT_OT_smooth,)
