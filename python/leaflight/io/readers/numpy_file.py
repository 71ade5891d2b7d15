# SPDX-License-Identifier: GPL-3.0-or-later
"""NumPy arrays [z, y, x] or [frame, z, y, x]: .npy, and .npz with several of them."""

import zipfile
from collections.abc import Callable, Sequence
from math import prod
from pathlib import Path
from typing import IO, Any

import numpy as np

from ..._core import Progress
from ...arrays import Array
from ...volume.volume import Volume
from .checks import (
    DEFLATE_MOST,
    check_scalar,
    check_shape,
    check_size,
    choose_named,
    index_to_world,
)
from .stored import StoredVolume, lengths

_READ_MAGIC: Callable[[IO[bytes]], tuple[int, int]] = np.lib.format.read_magic
_Header = tuple[tuple[int, ...], bool, np.dtype[Any]]
_READ_HEADER: dict[tuple[int, int], Callable[[IO[bytes]], _Header]] = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
    # Version 3.0 differs from 2.0 only in names of fields, which volumes do not have.
    (3, 0): np.lib.format.read_array_header_2_0,
}


def open_volume(
    path: Path, dataset: str | None = None, spacing: float | Sequence[float] = 1.0
) -> StoredVolume:
    """Opens an array. Never reads pickled objects."""
    matrix = index_to_world(path, spacing)
    if not zipfile.is_zipfile(path):
        with open(path, "rb") as file:
            shape, _, dtype = _header(file)
            stored = path.stat().st_size - file.tell()
        check_scalar(path, dtype)
        check_size(path, shape, dtype.itemsize, stored)
        return _stored(path, shape, dtype, matrix, lambda: np.load(path, mmap_mode="r"))

    with zipfile.ZipFile(path) as archive:
        arrays = {}
        for entry in archive.infolist():
            with archive.open(entry) as packed:
                shape, _, dtype = _header(packed)
            if _is_volume(shape, dtype):
                arrays[entry.filename.removesuffix(".npy")] = entry, shape, dtype
    names = tuple(arrays)
    name = choose_named(path, names, dataset)
    entry, shape, dtype = arrays[name]
    check_size(path, shape, dtype.itemsize, entry.compress_size, DEFLATE_MOST)

    def array() -> Array:
        with np.load(path) as archive:
            loaded: Array = archive[name]
        return loaded

    return _stored(path, shape, dtype, matrix, array, names)


def _stored(
    path: Path,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    matrix: Array,
    array: Callable[[], Array],
    names: tuple[str, ...] = (),
) -> StoredVolume:
    check_shape(path, shape)

    def load(frame: int, _channel: int, _progress: Progress) -> Volume:
        values = array()
        return Volume(values[frame] if len(shape) == 4 else values, matrix, path.stem)

    frames = shape[0] if len(shape) == 4 else 1
    dims = tuple(shape[-3:][::-1])
    return StoredVolume(dims, dtype, load, lengths(matrix), "", frames, datasets=names)


def _header(file: IO[bytes]) -> _Header:
    """Returns (shape, True for Fortran order, dtype)."""
    return _READ_HEADER[_READ_MAGIC(file)](file)


def _is_volume(shape: tuple[int, ...], dtype: np.dtype[Any]) -> bool:
    return len(shape) in (3, 4) and prod(shape) > 0 and dtype.kind in "biuf"
