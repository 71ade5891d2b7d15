# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole detail of surfaces that were coarse while their isovalue moved.

In a window a surface is as coarse as the hand asks for while its isovalue moves. A moment after the
last move its whole detail is made in the background; the next move comes first. While lamps or
objects move it waits for sharp light (../bake/live.py). Renders have it before their frame, and
without a window nothing ever is coarse.
"""

import time

import bpy

from .. import session
from ..operators import failures, jobs
from . import isosurface, surface_object

# Seconds from the last move to the work, and between two looks at it.
PAUSE = 0.08
POLL = 0.03

# Name of an object of this file -> its _Job.
_jobs = session.remembered()

# Whether no work may start, since what is shown will not stay.
_is_held = False


def may_follow(depsgraph=None):
    """Whether surfaces may be coarse for now.

    depsgraph: that shows them, or None before it is evaluated, which renders do not announce.
    """
    return not bpy.app.background and (depsgraph is None or depsgraph.mode == "VIEWPORT")


def watch(objects):
    """Starts work in the background for the surfaces of the objects that are coarse."""
    if bpy.app.background:
        return
    coarse = {obj.name: obj for obj in objects if _is_to_be_made(obj)}
    for name in [name for name, job in _jobs.items() if not job.serves(coarse.get(name))]:
        _jobs.pop(name)
    for name, obj in coarse.items():
        if name not in _jobs:
            _jobs[name] = _Job(obj)
    if _jobs and not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=POLL)


def make_now(objects):
    """Makes it at once where it is missing. Failures go to the problems of the surfaces."""
    for obj in filter(_is_to_be_made, objects):
        _jobs.pop(obj.name, None)
        surface_object.update(obj, surface_object.shown_isovalue(obj))


def hold(is_held):
    """Has work wait until the next call, or no longer."""
    global _is_held
    _is_held = is_held


def forget():
    """Leaves all surfaces as they are."""
    _jobs.clear()


def _is_to_be_made(obj):
    if obj.library or obj.data.library or obj.mode != "OBJECT":
        return False
    return surface_object.is_coarse(obj.data)


class _Making(jobs.Job):
    """Makes the whole detail of an Isosurface; made: it and its arrays, once that is done."""

    def __init__(self, surface):
        self._surface, self.made = surface, None

    def run(self, _progress):
        self.made = self._surface, self._surface.made()


class _Job:
    """The work on the surface of an object."""

    def __init__(self, obj):
        self._label = surface_object.label_of(obj.data)
        # From the first look at it on, when the last move has been drawn, however long that took.
        self._since = None
        self._work = self._making = None

    def serves(self, obj):
        return obj is not None and surface_object.label_of(obj.data) == self._label

    def step(self, obj):
        """Starts what is due and shows what was made; False when that is done."""
        if self._since is None:
            self._since = time.monotonic()
        if self._work is None:
            if time.monotonic() >= self._since + PAUSE:
                surface = isosurface.isosurface_of(obj, surface_object.shown_isovalue(obj))
                self._making = _Making(surface)
                self._work = jobs.BackgroundWork(self._making)
            return True
        if self._work.is_alive():
            return True
        self._work.result()
        surface_object.finish(obj, *self._making.made)
        return False


def _tick():
    if _is_held:
        return POLL
    for name, job in list(_jobs.items()):
        obj = bpy.data.objects.get((name, None))
        if obj is None or obj.mode != "OBJECT" or not job.serves(obj):
            _jobs.pop(name)
            continue
        try:
            goes_on = job.step(obj)
        except Exception as error:
            surface_object.problems[obj.name_full] = failures.sentence_of(error)
            goes_on = False
        if not goes_on:
            _jobs.pop(name, None)
    return POLL if _jobs else None
