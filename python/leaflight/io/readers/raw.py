# SPDX-License-Identifier: GPL-3.0-or-later
"""Headerless volumes: the caller gives the layout."""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from ..._core import Progress
from ...volume.setting_error import SettingError
from ...volume.volume import Volume
from .checks import index_to_world, text
from .stored import StoredVolume, lengths

TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")
ENDIANS: dict[str, Literal["<", ">"]] = {"little": "<", "big": ">"}


def open_volume(
    path: Path,
    dims: Sequence[int] | None = None,
    type: str | None = None,
    endian: str = "little",
    spacing: float | Sequence[float] = 1.0,
) -> StoredVolume:
    """x-fastest values; the file must hold exactly dims (nx, ny, nz) of them."""
    if dims is None or type is None:
        raise SettingError(
            f"{path}: a .raw file has no header; give its dimensions and the type of its values.",
            "dims",
            "type",
        )
    if len(dims) != 3 or any(n != int(n) or n < 1 for n in dims):
        raise SettingError(
            f"{path}: the dimensions must be three positive whole numbers, of voxels along x, y "
            "and z.",
            "dims",
        )
    if type not in TYPES:
        raise SettingError(
            f"{path}: the type {type} is not known; known are {', '.join(TYPES)}.", "type"
        )
    if endian not in ENDIANS:
        raise SettingError(f"{path}: the byte order must be little or big, not {endian}.", "endian")
    nx, ny, nz = (int(n) for n in dims)
    dtype = np.dtype(type).newbyteorder(ENDIANS[endian])
    needed, found = nx * ny * nz * dtype.itemsize, path.stat().st_size
    if needed != found:
        raise SettingError(
            f"{path}: {text(dims)} values of {type} are {needed} bytes, but the file holds "
            f"{found}; check dimensions and type.",
            "dims",
            "type",
        )
    matrix = index_to_world(path, spacing)

    def load(_frame: int, _channel: int, _progress: Progress) -> Volume:
        values = np.memmap(path, dtype, "r", shape=(nz, ny, nx))
        return Volume(values, matrix, path.stem)

    return StoredVolume((nx, ny, nz), dtype, load, lengths(matrix))
