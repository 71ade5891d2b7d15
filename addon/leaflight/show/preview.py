# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes of an unfinished bake that light objects, without a file.

Only surfaces show them (surface_object.py). The properties of objects about their bake stay.
"""

import uuid
from dataclasses import dataclass

import numpy as np
from leaflight import LeaflightError

from .. import session
from ..store import cache, source_files

# Full name of an object -> its Preview.
_shown = session.cache()


@dataclass(frozen=True, eq=False)
class Preview:
    """The light of an object from a pass of an unfinished bake.

    bake: A leaflight.Bake.
    index: Number of the object's volume in the bake.
    volume: That volume in the object's coordinates.
    frame: Frame of the file that the volume is.
    changes: Changes of its values since the import (source_files.changes_of()).
    walls: The last Bake among the passes with lit walls, or None.
    walls_key: Key of the light of walls.
    """

    bake: object
    index: int
    volume: object
    frame: int
    changes: str
    walls: object
    walls_key: str


def put(obj, bake, index, matrix, changes=None):
    """Lights an object with a volume of a bake from its next update on.

    matrix: the object's transform at the bake, 16 numbers row by row. changes: of the values at the
        bake, by default as now.
    """
    last = _shown.get(obj.name_full)
    baked = bake.volumes[index]
    local_to_world = np.array(matrix, np.float64).reshape(4, 4)
    index_to_local = np.linalg.inv(local_to_world) @ baked.index_to_world
    volume = last.volume if last is not None else _own_volume(obj)
    if volume is None or not _is_same(volume, baked, index_to_local):
        volume = cache.placed(baked, index_to_local)
    if bake.walls is not None:
        walls = bake, uuid.uuid4().hex
    else:
        walls = (None, "") if last is None else (last.walls, last.walls_key)
    if changes is None:
        changes = source_files.changes_of(obj.leaflight)
    _shown[obj.name_full] = Preview(bake, index, volume, obj.leaflight.frame, changes, *walls)


def _own_volume(obj):
    try:
        return cache.volume_of(obj)
    except LeaflightError:
        return None


def _is_same(volume, baked, index_to_world):
    """True if a volume is the baked one at the same place, except for rounding."""
    if volume.values is not baked.values or volume.smooth_normals != baked.smooth_normals:
        return False
    atol = 1e-9 * np.abs(index_to_world).max()
    return np.allclose(volume.index_to_world, index_to_world, rtol=1e-9, atol=atol)


def of(obj):
    """Returns the Preview that lights an object.

    Returns None without one, or if the object shows another frame or changed values.
    """
    shown, settings = _shown.get(obj.name_full), obj.leaflight
    if shown is None or shown.frame != settings.frame:
        return None
    return shown if shown.changes == source_files.changes_of(settings) else None


def forget():
    """Clears all previews. Returns the full names of their objects, which need an update."""
    names = list(_shown)
    _shown.clear()
    return names
