# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the file of a volume object again with another choice, and shows the result."""

import bpy

from ..bake import live
from ..operators import checks, jobs
from ..operators.checks import active_volume
from ..show import display, isovalues
from ..stage import staleness
from ..store import cache, frame_bakes, source_files

has_file = checks.needs(
    lambda c: active_volume(c).library is None and active_volume(c).leaflight.source,
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
        cache.keep_volume(obj, volume.capped() if settings.capped else volume)
        setattr(settings, self._choice, self._value)
        for surface in display.surfaces_of(obj):
            isovalues.limit(surface)
        cache.forget_unused()
        staleness.forget()
        live.changed(bpy.context.scene)
        return self._done(obj)
