# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the file of a volume object again with another choice, such as smoothing, and shows it."""

import bpy

from ..bake import live
from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..props import EnumProperty
from ..show import isovalues
from ..stage import staleness
from ..store import cache, frame_bakes, source_files

has_file = checks.volume_needs(
    lambda volume: volume.library is None and volume.leaflight.source,
    "The volume has no volume file: import it",
)
CONDITIONS = (jobs.is_free, *checks.VOLUME, has_file)


class ReadAgainJob(jobs.Job):
    """name: Title of the job. choice: One of source_files.CHOICES. done: Function of the object to
    the report.
    """

    def __init__(self, obj, name, choice, value, done):
        self.name, self._choice, self._value, self._done = name, choice, value, done
        self.cancelled = f"{name} was cancelled; nothing has changed"
        self._object = obj.name
        self._path = source_files.path_of(obj.leaflight)
        self._choices = {**source_files.choices_of(obj.leaflight), choice: value}
        self._state = source_files.file_state(obj.leaflight)

    def run(self, progress):
        self._volume = cache.read(self._path, self._choices, self._state, progress)

    def apply(self):
        obj = bpy.data.objects.get((self._object, None))
        if obj is None or not obj.leaflight.is_volume:
            return self.cancelled
        settings, volume = obj.leaflight, self._volume
        if self._choice == "regions" and settings.frame_regions:
            frame_bakes.end_wipe(settings)
        # Set the property without its update, and cache the volume for that update.
        settings[self._choice] = self._value
        # Another frame, for example, may be shown by now.
        if source_files.choices_of(settings) == self._choices:
            cache.keep_volume(obj, volume.capped() if settings.capped else volume)
        setattr(settings, self._choice, self._value)
        isovalues.limit_all(obj)
        cache.forget_unused()
        staleness.forget()
        live.changed(bpy.context.scene)
        return self._done(obj)


class LEAFLIGHT_OT_smooth(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Smooth"
    bl_description = (
        "Smooth the values against noise and 8-bit steps, or only the normals, so that "
        "isosurfaces stay where they are. A bake keeps its values, so bake again"
    )
    conditions = CONDITIONS

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
        return ReadAgainJob(obj, "Smooth", self.what, amount, lambda obj: f"{obj.name}: {text}")
