# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays that NumPy saved, [z, y, x] or [frame, z, y, x]: .npy, and .npz with several of them."""

import zipfile
from math import prod

import numpy as np

from ...volume.volume import Volume
from .checks import (
    DEFLATE_MOST,
    check_scalar,
    check_shape,
    check_size,
    choose_named,
    index_to_world,
    undecided,
)
from .stored import StoredVolume, lengths

_READ_HEADER = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def open_volume(path, dataset=None, spacing=1.0):
    """Pickled objects are never read."""
    matrix = index_to_world(path, spacing)
    if path.suffix.lower() == ".npy":
        with open(path, "rb") as file:
            shape, _, dtype = _header(file)
            stored = path.stat().st_size - file.tell()
        check_scalar(path, dtype)
        check_size(path, shape, dtype.itemsize, stored)
        return _stored(path, shape, dtype, matrix, lambda: np.load(path, mmap_mode="r"))

    with zipfile.ZipFile(path) as archive:
        arrays = {}
        for entry in archive.infolist():
            with archive.open(entry) as file:
                shape, _, dtype = _header(file)
            if _is_volume(shape, dtype):
                arrays[entry.filename.removesuffix(".npy")] = entry, shape, dtype
    names = tuple(arrays)
    name = choose_named(path, names, dataset)
    if name is None:
        return StoredVolume(None, np.dtype(np.float32), undecided(path, names), datasets=names)
    entry, shape, dtype = arrays[name]
    check_size(path, shape, dtype.itemsize, entry.compress_size, DEFLATE_MOST)

    def array():
        with np.load(path) as archive:
            return archive[name]

    return _stored(path, shape, dtype, matrix, array, names)


def _stored(path, shape, dtype, matrix, array, names=()):
    check_shape(path, shape)

    def load(frame, _channel, _progress):
        values = array()
        return Volume(values[frame] if len(shape) == 4 else values, matrix, path.stem)

    frames = shape[0] if len(shape) == 4 else 1
    dims = tuple(shape[-3:][::-1])
    return StoredVolume(dims, dtype, load, lengths(matrix), "", frames, datasets=names)


def _header(file):
    """(shape, whether Fortran's order, dtype)."""
    version = np.lib.format.read_magic(file)
    return _READ_HEADER[version](file)


def _is_volume(shape, dtype):
    return len(shape) in (3, 4) and prod(shape) > 0 and dtype.kind in "biuf"
