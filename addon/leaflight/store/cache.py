# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes and bakes in memory, by the files they came from.

Nothing here is saved with the scene or refers to a Blender object, so neither undo nor loading a
file can invalidate it: what is missing is read again from its path.
"""

from pathlib import Path

import bpy
import leaflight
import numpy as np

_volumes = {}
_bakes = {}


def volume_of(obj):
    """The volume of an object, in the object's local coordinates. Raises LeaflightError."""
    key = _volume_key(obj.leaflight)
    if key not in _volumes:
        *file, capped = key
        volume = _volume_of_bake(obj)
        if volume is None:
            volume = read_volume(*file)
            volume = volume.capped() if capped else volume
        _volumes[key] = volume
    return _volumes[key]


def world_volume(obj):
    """The volume of an object in world space, where it is baked. Raises LeaflightError."""
    volume = volume_of(obj)
    index_to_world = np.array(obj.matrix_world, np.float64) @ volume.index_to_world
    return leaflight.Volume(volume.values, index_to_world, volume.name, volume.source)


def read_volume(path, dims, value_type, endian, spacing, frame):
    """Reads a volume with the options that its kind of file takes; frame -1 is none chosen."""
    suffix = Path(path).suffix.lower()
    options = {}
    if suffix == ".raw":
        options = {"dims": dims, "type": value_type, "endian": endian}
    if suffix in {".raw", ".tif", ".tiff"} or Path(path).is_dir():
        options["spacing"] = spacing
    if frame >= 0:
        options["frame"] = frame
    return leaflight.read_volume(path, **options)


def keep_volume(obj, volume):
    _volumes[_volume_key(obj.leaflight)] = volume


def bake_of(obj):
    """The bake that lights an object, None before the first. Raises LeaflightError."""
    if not obj.leaflight.bake_path:
        return None
    path = bpy.path.abspath(obj.leaflight.bake_path)
    if path not in _bakes:
        _bakes[path] = leaflight.load_bake(path)
    return _bakes[path]


def grid_of(obj):
    """The radiance grid of an object's bake, None before the first. Raises LeaflightError."""
    bake = bake_of(obj)
    return bake.grids[obj.leaflight.bake_index] if bake is not None else None


def keep_bake(path, bake):
    _bakes[path] = bake


def forget_unused():
    """Frees what no object of the file refers to any more."""
    settings = [obj.leaflight for obj in bpy.data.objects if obj.leaflight.is_volume]
    volumes = {_volume_key(s) for s in settings}
    bakes = {bpy.path.abspath(s.bake_path) for s in settings}
    for cache, used in ((_volumes, volumes), (_bakes, bakes)):
        for key in [key for key in cache if key not in used]:
            del cache[key]


def clear():
    _volumes.clear()
    _bakes.clear()


def _volume_of_bake(obj):
    """The volume that the bake holds, None if there is no such file: one copy serves both."""
    settings = obj.leaflight
    try:
        bake = bake_of(obj)
    except leaflight.LeaflightError:
        return None
    if bake is None or bake.scene.leaves[settings.bake_index].capped != settings.capped:
        return None
    local_to_world = np.array(settings.bake_matrix, np.float64).reshape(4, 4)
    baked = bake.volumes[settings.bake_index]
    index_to_local = np.linalg.inv(local_to_world) @ baked.index_to_world
    return leaflight.Volume(baked.values, index_to_local, baked.name, baked.source)


def _volume_key(settings):
    return (
        bpy.path.abspath(settings.source),
        tuple(settings.dims),
        settings.value_type,
        settings.endian,
        tuple(settings.spacing),
        settings.frame,
        settings.capped,
    )
