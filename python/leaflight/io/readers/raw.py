# SPDX-License-Identifier: GPL-3.0-or-later
"""Raw values without a header, or after one to skip. The caller gives the layout."""

from collections.abc import Sequence
from math import prod
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..._core import Progress
from ...volume.setting_error import SettingError
from ...volume.volume import Volume
from .checks import index_to_world, text
from .stored import StoredVolume, lengths
from .value_files import ValueFiles

TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")
_WHOLE = (slice(None),) * 3
ENDIANS: dict[str, Literal["<", ">"]] = {"little": "<", "big": ">"}


def open_volume(
    path: Path,
    dims: Sequence[int] | None = None,
    type: str | None = None,
    endian: str = "little",
    spacing: float | Sequence[float] = 1.0,
    skip: int = 0,
) -> StoredVolume:
    """Opens values, x fastest.

    dims: Numbers of values (nx, ny, nz). They must end exactly at the end of the file.
    skip: Bytes before the values; -1 if the values are the end of the file, after anything.
    """
    if dims is None or type is None:
        raise SettingError(
            f"{path}: a {path.suffix} file has no header; give its dimensions and the type of its "
            "values.",
            "dims",
            "type",
        )
    if len(dims) != 3 or any(n != int(n) or n < 1 for n in dims):
        raise SettingError(
            f"{path}: the dimensions are not three positive integers; give the voxels along x, y "
            "and z.",
            "dims",
        )
    if type not in TYPES:
        raise SettingError(
            f"{path}: the type {type} is unknown; choose one of {', '.join(TYPES)}.", "type"
        )
    if endian not in ENDIANS:
        raise SettingError(
            f"{path}: the byte order {endian} is unknown; choose little or big.", "endian"
        )
    if skip != int(skip) or skip < -1:
        raise SettingError(
            f"{path}: the number of bytes to skip is {skip}; give a whole number, or -1 for "
            "everything before the values.",
            "skip",
        )
    nx, ny, nz = (int(n) for n in dims)
    dtype = np.dtype(type).newbyteorder(ENDIANS[endian])
    shape, stored = (nz, ny, nx), ValueFiles((path,), skip=int(skip))
    _check_length(path, shape, dtype, int(skip))
    matrix = index_to_world(path, spacing)

    def load(_frame: int, _channel: int, progress: Progress) -> Volume:
        return Volume(stored.read(shape, dtype, _WHOLE, progress), matrix, path.stem)

    return StoredVolume((nx, ny, nz), dtype, load, lengths(matrix))


def _check_length(path: Path, shape: Sequence[int], dtype: np.dtype[Any], skip: int) -> None:
    """Raises SettingError unless the values end exactly at the end of the file."""
    needed, found = prod(shape) * dtype.itemsize, path.stat().st_size
    left = found - max(skip, 0)
    if needed == left or (skip == -1 and needed <= left):
        return
    behind = f" behind the {skip} that are skipped" if skip > 0 else ""
    header = f": {left - needed} more, which may be a header to skip" if needed < left else ""
    raise SettingError(
        f"{path}: {text(shape[::-1])} values of {dtype.name} take {needed} bytes, but the file "
        f"holds {max(0, left)}{behind}{header}; check dimensions and type.",
        "dims",
        "type",
        *(["skip"] if header or skip > 0 else []),
    )
