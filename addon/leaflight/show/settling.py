# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces at rest get what they had no time for while their isovalue moved.

While it moves a surface in a window is as coarse as the hand asks for, and lit by what the bake
says. A moment after the last move its whole detail is made in the background; then its light is
traced at the vertices, round by round. The next move ends either. Renders have both before their
frame, and without a window nothing ever is coarse.
"""

import time
from dataclasses import dataclass

import bpy
import leaflight
import numpy as np
from leaflight.bake.settle import settle

from ..operators.background import BackgroundWork
from ..store import cache
from . import added, isosurface, preview, surface_object
from .isosurface import RADIANCE, RADIANCE_BACK

# Seconds that an isovalue must not have moved before the whole detail, and before settled light;
# and between two looks at the work.
WHOLE_PAUSE = 0.08
PAUSE = 0.4
POLL = 0.03

# Name of an object of this file -> its _Job.
_jobs = {}


def follows(depsgraph=None):
    """Whether surfaces may be coarse for now: in a window they are seen to at rest.

    depsgraph: that shows them, or None before it is evaluated, which renders do not announce.
    """
    return not bpy.app.background and (depsgraph is None or depsgraph.mode == "VIEWPORT")


def watch(objects):
    """Starts and ends work in the background as the surfaces of the objects need it."""
    if bpy.app.background:
        return
    wanted = {obj.name: obj for obj in objects if _is_wanted(obj)}
    gone = [name for name, job in _jobs.items() if not job.serves(wanted.get(name))]
    for name in gone:
        _jobs.pop(name).cancel()
    for name, obj in wanted.items():
        if name not in _jobs:
            _jobs[name] = _Job(obj)
    if _jobs and not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=POLL)


def settle_now(objects):
    """Gives the surfaces of the objects all that they lack. Failures go to their problems."""
    for obj in filter(_is_wanted, objects):
        forget(obj.name)
        surface_object.update(obj, surface_object.shown_isovalue(obj))
        if not _is_to_settle(obj):
            continue
        try:
            mesh, sides = _Resting.of(obj).mesh_and_sides()
            colours = {name: settle(side)[0] for name, side in sides.items()}
        except leaflight.LeaflightError as error:
            surface_object.problems[obj.name_full] = str(error)
            continue
        surface_object.settle(obj, mesh, colours, whole=True)


def forget(name=None):
    """Ends the work in the background, for the object of a name or for all."""
    for key in [name] if name in _jobs else list(_jobs) if name is None else []:
        _jobs.pop(key).cancel()


def _is_wanted(obj):
    """Whether the surface of an object lacks anything that is made at rest."""
    if obj.library or obj.data.library or obj.mode != "OBJECT":
        return False
    return surface_object.is_coarse(obj.data) or _is_to_settle(obj)


def _is_to_settle(obj):
    """Whether the surface of an object is to settle and has not yet."""
    mesh, volume = obj.data, added.volume_object(obj)
    settings = volume.leaflight
    if not settings.settle or not settings.bake_id or preview.of(volume) is not None:
        return False
    lit = RADIANCE in mesh.attributes
    return lit and len(mesh.vertices) > 0 and not surface_object.settled_state(mesh)[1]


@dataclass(frozen=True, eq=False)
class _Resting:
    """A surface that is to settle: of which bake, which of its volumes, at which leaf coordinate.

    back: whether its inner side settles, too; to_local: (4, 4), from where the volume was baked to
    the object's coordinates.
    """

    bake: object
    index: int
    c: float
    back: bool
    to_local: np.ndarray

    @classmethod
    def of(cls, obj):
        """Raises LeaflightError."""
        volume = added.volume_object(obj)
        bake, index = cache.bake_of(volume), volume.leaflight.bake_index
        # An inner side beside mirrors or glass keeps the bake's light.
        looks = [*bake.scene.leaves, *bake.scene.meshes]
        diffuse = all(look.scattering == "diffuse" for look in looks)
        baked = bake.volumes[index].index_to_world
        return cls(
            bake,
            index,
            _leaf_coordinate(bake, index, surface_object.shown_isovalue(obj)),
            diffuse and RADIANCE_BACK in obj.data.attributes,
            cache.volume_of(volume).index_to_world @ np.linalg.inv(baked),
        )

    def mesh_and_sides(self):
        """((vertices, triangles), local; a _core.Settle by the name of each attribute).

        In any thread. Raises LeaflightError.
        """
        mesh = self.bake.contour(self.c, self.index, at_rest=True)
        names = {RADIANCE: False, RADIANCE_BACK: True} if self.back else {RADIANCE: False}
        sides = {
            name: self.bake.settling(self.c, *mesh, volume=self.index, back=back)
            for name, back in names.items()
        }
        vertices, _, triangles = mesh
        vertices = vertices @ self.to_local[:3, :3].T + self.to_local[:3, 3]
        # Triangles are counter-clockwise seen from outside, which a mirror turns.
        mirrored = np.linalg.det(self.to_local[:3, :3]) < 0
        return (vertices, triangles[:, ::-1] if mirrored else triangles), sides


def _leaf_coordinate(bake, index, isovalue):
    """That of the bake at which a volume shows the isovalue."""
    window = tuple(bake.isovalue_of(index, c) for c in bake.isovalues)
    # One volume's is the isovalue, and shall not be rounded.
    return isovalue if window == bake.isovalues else np.interp(isovalue, window, bake.isovalues)


class _Job:
    """The work on the surface of an object, from a moment after it has come to rest."""

    def __init__(self, obj):
        self._label = surface_object.label_of(obj.data)
        # From the first look at it on, when the last move has been drawn, however long that took.
        self._since = None
        self._work = None
        # Written by the thread: what was made of an Isosurface, then (rounds done, the mesh at
        # rest, its colours, whether these are all).
        self._made = self._found = None
        self._rounds = 0

    def serves(self, obj):
        return obj is not None and surface_object.label_of(obj.data) == self._label

    def cancel(self):
        if self._work is not None:
            self._work.cancel()

    def step(self, obj):
        """Starts what is due, shows what was found since; False when nothing is to follow."""
        if self._since is None:
            self._since = time.monotonic()
        if surface_object.is_coarse(obj.data):
            self._make_whole(obj)
            return True
        return _is_to_settle(obj) and self._settle(obj)

    def _rests(self, seconds):
        return time.monotonic() >= self._since + seconds

    def _make_whole(self, obj):
        if self._work is None:
            if self._rests(WHOLE_PAUSE):
                surface = isosurface.isosurface_of(obj, surface_object.shown_isovalue(obj))
                self._work = BackgroundWork(lambda _: self._make(surface))
        elif not self._work.is_alive():
            work, self._work = self._work, None
            work.result()
            surface_object.finish(obj, *self._made)
            self._made = None

    def _make(self, surface):
        self._made = surface, surface.made()

    def _settle(self, obj):
        if self._work is None:
            if not self._rests(PAUSE):
                return True
            resting = _Resting.of(obj)
            self._work = BackgroundWork(lambda progress: self._refine(resting, progress))
        alive = self._work.is_alive()
        found = self._found
        if found is not None and found[0] > self._rounds:
            self._rounds, mesh, colours, whole = found
            surface_object.settle(obj, mesh, colours, whole)
        if not alive:
            self._work.result()
        return alive

    def _refine(self, resting, progress):
        mesh, sides = resting.mesh_and_sides()
        rounds = max(side.rounds for side in sides.values())
        for done in range(1, rounds + 1):
            for side in sides.values():
                side.refine(progress)
            colours = {name: side.settled()[0] for name, side in sides.items()}
            self._found = (done, mesh, colours, done == rounds)


def _tick():
    for name, job in list(_jobs.items()):
        obj = bpy.data.objects.get((name, None))
        if obj is None or obj.mode != "OBJECT" or not job.serves(obj):
            _jobs.pop(name).cancel()
            continue
        try:
            goes_on = job.step(obj)
        except leaflight.LeaflightError as error:
            surface_object.problems[obj.name_full] = str(error)
            goes_on = False
        if not goes_on:
            _jobs.pop(name, None)
    return POLL if _jobs else None
