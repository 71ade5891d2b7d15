# SPDX-License-Identifier: GPL-3.0-or-later
"""The full detail of surfaces that were coarse while their isovalue moved.

In a window a surface is coarse while its isovalue moves. A moment after the last move a thread
makes its full detail. The next move has priority. While lamps or objects move, the work waits for
sharp light (../bake/live.py). Renders get full detail before each frame. Without a window no
surface is ever coarse.
"""

import time

import bpy

from .. import session
from ..operators import failures, jobs
from ..store.reading import StillReading
from . import isosurface, surface_object

# Seconds from the last move to the start of the work, and between two polls.
PAUSE = 0.08
POLL = 0.03

# Name of an object in this file -> its _Job.
_jobs = session.cache()

# True if no work may start, because the present surfaces will not stay.
_is_held = False


def may_follow(depsgraph=None):
    """True if surfaces may be coarse for now.

    depsgraph: the one that shows them, or None before its evaluation. Renders have no such event.
    """
    return not bpy.app.background and (depsgraph is None or depsgraph.mode == "VIEWPORT")


def watch(objects):
    """Starts background work for the coarse surfaces among these objects."""
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
    """Makes missing detail at once. Failures go to surface_object.problems."""
    for obj in filter(_is_to_be_made, objects):
        _jobs.pop(obj.name, None)
        surface_object.update(obj, surface_object.shown_isovalue(obj))


def hold(is_held):
    """Stops new work if True, and allows it again if False."""
    global _is_held
    _is_held = is_held


def forget():
    """Drops all work and leaves the surfaces as they are."""
    _jobs.clear()


def _is_to_be_made(obj):
    if obj.library or obj.data.library or obj.mode != "OBJECT":
        return False
    return surface_object.is_coarse(obj.data)


class _Making(jobs.Job):
    """Makes the full detail of an Isosurface. made: The Isosurface and its arrays, when done."""

    def __init__(self, surface):
        self._surface, self.made = surface, None

    def run(self, _progress):
        self.made = self._surface, self._surface.made()


class _Job:
    """The work on the surface of an object."""

    def __init__(self, obj):
        self._label = surface_object.label_of(obj.data)
        # Time of the first poll, which comes after the last move was drawn.
        self._since = None
        self._work = self._making = None

    def serves(self, obj):
        return obj is not None and surface_object.label_of(obj.data) == self._label

    def step(self, obj):
        """Starts the work when it is due, and shows its result. Returns False once it is done."""
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
        except StillReading:
            goes_on = True
        except Exception as error:
            surface_object.problems[obj.name_full] = failures.sentence_of(error)
            goes_on = False
        if not goes_on:
            _jobs.pop(name, None)
    return POLL if _jobs else None
