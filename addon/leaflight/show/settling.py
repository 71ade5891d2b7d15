# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces at rest: their light is traced at the vertices, in place of what the bake says there.

While the isovalue moves the bake alone answers. A moment after the last move a surface settles in
the background, round by round; the next move ends that. Renders settle before their frame.
"""

import time

import bpy
import leaflight
import numpy as np
from leaflight.bake.settle import settle

from ..operators.background import BackgroundWork
from ..store import cache
from . import preview, surface_object

# Seconds that an isovalue must not have moved, and between two looks at the work.
PAUSE = 0.4
POLL = 0.1

# Full name of an object -> its _Job.
_jobs = {}


def watch(objects):
    """Starts and ends work in the background as the surfaces of the objects need it."""
    if bpy.app.background:
        return
    wanted = {obj.name_full: obj for obj in objects if _is_wanted(obj)}
    for name in [name for name, job in _jobs.items() if not job.serves(wanted.get(name))]:
        _jobs.pop(name).cancel()
    for name, obj in wanted.items():
        if name not in _jobs:
            _jobs[name] = _Job(obj)
    if _jobs and not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=POLL)


def settle_now(objects):
    """Settles the surfaces of the objects, all the way. Failures go to the surfaces' problems."""
    for obj in objects:
        if not _is_wanted(obj):
            continue
        forget(obj.name_full)
        try:
            sides = _sides(obj)
            colours = {name: settle(side)[0] for name, side in sides.items()}
        except leaflight.LeaflightError as error:
            surface_object.problems[obj.name_full] = str(error)
            continue
        surface_object.settle(obj, colours, whole=True)


def forget(name=None):
    """Ends the work in the background, for the object of a full name or for all."""
    for key in [name] if name in _jobs else list(_jobs) if name is None else []:
        _jobs.pop(key).cancel()


def _is_wanted(obj):
    """Whether the surface of an object is to settle and has not yet."""
    mesh = obj.data
    if not obj.leaflight.settle or not obj.leaflight.bake_id or obj.library or mesh.library:
        return False
    if preview.of(obj) is not None:
        return False
    lit = surface_object.RADIANCE in mesh.attributes
    return lit and len(mesh.vertices) > 0 and not surface_object.settled_state(mesh)[1]


def _sides(obj):
    """A _core.Settle for each colour attribute of the mesh, by its name. Raises LeaflightError.

    An inner side beside mirrors or glass keeps the bake's light.
    """
    bake, settings = cache.bake_of(obj), obj.leaflight
    index = settings.bake_index
    isovalue = surface_object.shown_isovalue(obj)
    # The same mesh as the object's, where the bake has it.
    mesh = bake.grids[index].contour(bake.volumes[index].field(), isovalue)
    c = _leaf_coordinate(bake, index, isovalue)
    sides = {surface_object.RADIANCE: bake.settling(c, *mesh, volume=index)}
    looks = [*bake.scene.leaves, *bake.scene.meshes]
    if surface_object.RADIANCE_BACK in obj.data.attributes:
        if all(look.scattering == "diffuse" for look in looks):
            back = bake.settling(c, *mesh, volume=index, back=True)
            sides[surface_object.RADIANCE_BACK] = back
    return sides


def _leaf_coordinate(bake, index, isovalue):
    """That of the bake at which a volume shows the isovalue."""
    window = tuple(bake.isovalue_of(index, c) for c in bake.isovalues)
    # One volume's is the isovalue, and shall not be rounded.
    return isovalue if window == bake.isovalues else np.interp(isovalue, window, bake.isovalues)


class _Job:
    """The work on the surface of an object, from a moment after it has come to rest."""

    def __init__(self, obj):
        self._label = surface_object.label_of(obj.data)
        self._due = time.monotonic() + PAUSE
        self._sides = self._work = None
        self._rounds = 0
        # Written by the thread: (rounds done, colours, whether these are all).
        self._found = None

    def serves(self, obj):
        return obj is not None and surface_object.label_of(obj.data) == self._label

    def cancel(self):
        if self._work is not None:
            self._work.cancel()

    def step(self, obj):
        """Starts when it is due, shows what was found since; False when nothing is to follow."""
        if self._work is None:
            if time.monotonic() < self._due:
                return True
            self._sides = _sides(obj)
            self._work = BackgroundWork(self._run)
        alive = self._work.is_alive()
        found = self._found
        if found is not None and found[0] > self._rounds:
            self._rounds, colours, whole = found
            surface_object.settle(obj, colours, whole)
        if not alive:
            self._work.result()
        return alive

    def _run(self, progress):
        rounds = max(side.rounds for side in self._sides.values())
        for done in range(1, rounds + 1):
            for side in self._sides.values():
                side.refine(progress)
            colours = {name: side.settled()[0] for name, side in self._sides.items()}
            self._found = (done, colours, done == rounds)


def _tick():
    for name, job in list(_jobs.items()):
        obj = next((o for o in bpy.data.objects if o.name_full == name), None)
        if not job.serves(obj):
            _jobs.pop(name).cancel()
            continue
        try:
            goes_on = job.step(obj)
        except leaflight.LeaflightError as error:
            surface_object.problems[name] = str(error)
            goes_on = False
        if not goes_on:
            _jobs.pop(name, None)
    return POLL if _jobs else None
