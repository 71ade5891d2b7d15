# SPDX-License-Identifier: GPL-3.0-or-later
"""The cache of bakes, by id, and of volumes, by their source or bake.

Nothing here is saved with the scene or refers to a Blender object. Neither undo nor loading a file
can therefore invalidate it. Missing entries are read again from their files.
"""

from contextlib import suppress
from dataclasses import replace
from functools import partial

import bpy
import leaflight
import numpy as np
from leaflight import LeaflightError
from leaflight.bake.load_bake import open_bake

from .. import session
from . import bake_files, reading, source_files

_volumes = session.remembered()
_bakes = session.remembered()
# Readings by bake id, while a thread computes the light of the walls.
_readings = session.remembered()
# Functions that a timer calls with the Progress while the walls of a bake are lit, and with None
# at the end.
watching = []

# Bytes of voxels above which unused volumes and bakes are freed. Playback loads many frames.
_MOST = 2 << 30

# Cache: path -> (state of the file, why it could not be read).
_damaged = session.remembered()


def volume_of(obj):
    """Returns the volume that an object shows, in local coordinates. Raises LeaflightError.

    The volume of the bake takes precedence over the source file, which may have changed.
    """
    key = _baked_key(obj)
    if key is not None:
        if key not in _volumes:
            _volumes[key] = _volume_of_bake(obj)
        return _volumes[key]
    return _source_volume(obj)


def world_volume(obj):
    """Returns volume_of() in world space."""
    # If the object has not moved since the bake, return exactly the baked volume.
    if _baked_key(obj) is not None and _flat(obj.matrix_world) == list(obj.leaflight.bake_matrix):
        return light_of(obj).volumes[obj.leaflight.bake_index]
    return _in_world(obj, volume_of(obj))


def volume_to_bake(obj):
    """Returns the volume in world space for a new bake. Raises LeaflightError.

    The file is read again if it has changed since the last bake.
    """
    if obj.leaflight.bake_id and source_files.changed_since_bake(obj):
        return _in_world(obj, _source_volume(obj))
    volume = world_volume(obj)
    # The source of a loaded bake's volume is the bake itself; the object may store a better one.
    return replace(volume, source=source_files.source_of(obj.leaflight) or volume.source)


def placed(volume, index_to_world):
    """Returns a volume in Blender's coordinates, which have neither a patient's axes nor a unit."""
    return replace(volume, index_to_world=index_to_world, unit="", patient=False)


def keep_volume(obj, volume):
    """Caches the volume that was read for an object without a bake."""
    settings = obj.leaflight
    _volumes[source_files.key_of(settings)] = _in_object(settings, volume)


def bake_of(obj):
    """Returns the bake that lights an object, with lit walls. Raises LeaflightError.

    Waits for the light of the walls. Returns None before the first bake.
    """
    bake = light_of(obj)
    if lacks_walls(obj):
        _finish(obj.leaflight.bake_id)
        return light_of(obj)
    return bake


def light_of(obj):
    """Returns the bake that lights an object, perhaps without the light of its walls.

    In a window, a thread computes the light of the walls, which takes up to a minute. Returns None
    before the first bake. Raises LeaflightError.
    """
    identifier = obj.leaflight.bake_id
    if not identifier:
        return None
    if identifier in _readings:
        return _readings[identifier].bake
    if identifier not in _bakes:
        _make_room()
        _open(identifier, bake_files.locate(obj), waits=obj.leaflight.frames > 1)
        return light_of(obj)
    return _bakes[identifier]


def _open(identifier, path, waits):
    """Reads a bake into the cache. waits: True if it returns only after the walls are lit."""
    if waits or bpy.app.background:
        _bakes[identifier] = _load(path, leaflight.load_bake)
        return
    bake, walls = _load(path, open_bake)
    if walls is None:
        _bakes[identifier] = bake
        return
    _readings[identifier] = begun = reading.Reading(path, bake, walls)
    bpy.app.timers.register(partial(_await, identifier, begun), persistent=True)


def whole_of(obj):
    """Returns a function that takes a Progress and returns the bake with lit walls.

    The function may run in any thread and waits until the Progress is canceled. Both raise
    LeaflightError.
    """
    bake, begun = light_of(obj), _readings.get(obj.leaflight.bake_id)
    return begun.result if begun is not None else lambda _progress: bake


def lacks_walls(obj):
    """True if the walls of the bake that lights an object are not yet lit."""
    return obj.leaflight.bake_id in _readings


def stop_readings():
    for begun in _readings.values():
        begun.cancel()
    _readings.clear()


def _await(identifier, begun):
    """Polls a reading from a timer, and returns the seconds until the next call."""
    is_wanted = _readings.get(identifier) is begun
    goes_on = is_wanted and begun.is_alive()
    if not is_wanted:
        begun.cancel()
    elif not goes_on:
        with suppress(LeaflightError):
            _finish(identifier)
    for call in watching:
        call(begun.progress if goes_on else None)
    return 0.1 if goes_on else None


def _finish(identifier):
    # Keep the reading until it ends. A render may wait for it in another thread than _await().
    begun = _readings.get(identifier)
    if begun is None:
        return
    try:
        _bakes[identifier] = begun.result()
    except LeaflightError as problem:
        _damaged[begun.path] = bake_files.state_of(begun.path), str(problem)
        raise
    finally:
        _readings.pop(identifier, None)


def grid_of(obj):
    """Returns the radiance grid of an object's bake, None before the first.

    Raises LeaflightError.
    """
    bake = light_of(obj)
    return bake.grids[obj.leaflight.bake_index] if bake is not None else None


def keep_bake(bake):
    _bakes[bake.id] = bake


def values_sha256(bake, index):
    """Returns the hash of a volume's values in a bake (leaflight.bake.provenance.values_sha256)."""
    return bake.provenance.volumes[index].values_sha256


def forget_unused():
    """Frees volumes and bakes that no object of the file refers to."""
    settings = [obj.leaflight for obj in bpy.data.objects if obj.leaflight.is_volume]
    volumes = {source_files.key_of(s) for s in settings} | {_key_in_bake(s) for s in settings}
    bakes = {s.bake_id for s in settings}
    for cache, kept in ((_volumes, volumes), (_bakes, bakes)):
        for key in [key for key in cache if key not in kept]:
            del cache[key]


def _make_room():
    volumes = [*_volumes.values(), *(one for bake in _bakes.values() for one in bake.volumes)]
    if sum(volume.values.nbytes for volume in volumes) > _MOST:
        forget_unused()


def _load(path, read):
    """Reads a bake. A damaged file is read again only after it has changed."""
    state = bake_files.state_of(path)
    known, error = _damaged.get(path, (None, None))
    if known is None or known != state:
        try:
            return read(path)
        except LeaflightError as problem:
            error = str(problem)
            _damaged[path] = state, error
    raise LeaflightError(error)


def _source_volume(obj):
    settings = obj.leaflight
    if not settings.source:
        raise LeaflightError(
            f'"{obj.name}" came with its bake and has no volume file of its own: relocate the '
            "bake, keep Capped as it was baked, or import the volume."
        )
    key = source_files.key_of(settings)
    if key not in _volumes:
        _make_room()
        volume = source_files.read(settings)
        _volumes[key] = _in_object(settings, volume.capped() if settings.capped else volume)
    return _volumes[key]


def _in_object(settings, volume):
    """Returns a volume of a file in the coordinates of its object."""
    return replace(volume, index_to_world=source_files.from_file(settings) @ volume.index_to_world)


def _baked_key(obj):
    """Returns a key of the volume in an object's bake.

    Returns None if the object has no readable bake or shows its volume otherwise than baked.
    """
    settings = obj.leaflight
    try:
        bake = light_of(obj)
    except LeaflightError:
        return None
    if bake is None or bake.scene.isosurfaces[settings.bake_index].capped != settings.capped:
        return None
    if source_files.smoothing_changed(settings):
        return None
    return _key_in_bake(settings)


def _key_in_bake(settings):
    return settings.bake_id, settings.bake_index, tuple(settings.bake_matrix)


def _volume_of_bake(obj):
    settings = obj.leaflight
    local_to_world = np.array(settings.bake_matrix, np.float64).reshape(4, 4)
    baked = light_of(obj).volumes[settings.bake_index]
    index_to_local = np.linalg.inv(local_to_world) @ baked.index_to_world
    return placed(baked, index_to_local)


def _in_world(obj, volume):
    index_to_world = np.array(obj.matrix_world, np.float64) @ volume.index_to_world
    return placed(volume, index_to_world)


def _flat(matrix):
    return [x for row in matrix for x in row]
