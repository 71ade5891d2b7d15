# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory of voxels: limits, types and arrays."""

import os
import tempfile
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

import leaflight._core as _core

from .._core import LeaflightError
from ..arrays import Array
from ..paths import AnyPath

# Smallest limit of a process, and the part of it that Python, libraries and threads need.
LEAST_LIMIT, _PROGRAM = 192 << 20, 96 << 20
# Share of a limit that volumes may take; larger volumes are stored in a file.
_SHARE_OF_VOLUMES = 0.25
# Share of the machine's memory for a process without a limit.
_SHARE_OF_MACHINE = 0.75
# Bytes per voxel of the bounds for rays, in addition to the values.
_BOUNDS = 2.6

_limit: int | None = None


def limit_memory(size: int | None, folder: AnyPath | None = None) -> None:
    """Limits this process to about `size` bytes of memory; None removes the limit.

    Volumes above a quarter of the limit are stored in files. A bake takes the finest texels whose
    light fits into the rest. The files have no name and disappear with the process.

    folder: Folder of these files on a disk. None is the folder of temporary files.
    Raises LeaflightError for less than LEAST_LIMIT.
    """
    global _limit
    if size is not None and size < LEAST_LIMIT:
        raise LeaflightError(
            f"The memory limit is below {LEAST_LIMIT >> 20} MiB, which libraries need: give a "
            "higher limit."
        )
    of_volumes = 0 if size is None else int(_SHARE_OF_VOLUMES * size)
    _core.limit_large_memory(of_volumes, os.path.abspath(folder or tempfile.gettempdir()))
    _limit = size


def memory_of_light(voxels: int) -> int | None:
    """Returns the bytes that the light of this many voxels may take; None if unknown."""
    if _limit is not None:
        return int((1 - _SHARE_OF_VOLUMES) * _limit) - _PROGRAM
    machine = _core.machine_memory()
    if machine == 0:
        return None
    in_memory, _ = _core.large_memory()
    left = _SHARE_OF_MACHINE * machine - in_memory - _BOUNDS * voxels - _PROGRAM
    # The other allocations are never all in use at once.
    return int(max(left, 0.2 * machine))


def is_limited() -> bool:
    """Returns True if limit_memory() set a limit."""
    return _limit is not None


# Voxel types of the core, narrowest first. Files of other types are converted.
VOXEL_TYPES = (np.uint8, np.int16, np.uint16, np.float32)


def new_voxels(shape: Iterable[int], dtype: DTypeLike) -> Array:
    """Returns an uninitialized array for the values of a volume, in memory or in a file.

    Raises LeaflightError if the disk is full.
    """
    return _core.large_array([int(n) for n in shape], np.dtype(dtype))


def bytes_of(voxels: Array) -> memoryview:
    """Returns the memory of a contiguous array, to be filled byte by byte."""
    return voxels.reshape(-1).view(np.uint8).data


def held_type(dtype: DTypeLike) -> np.dtype[Any]:
    """Returns the one of VOXEL_TYPES, a dtype, that stores values of this type."""
    kept = next((kept for kept in VOXEL_TYPES if np.can_cast(dtype, kept)), np.float32)
    return np.dtype(kept)


def as_voxels(values: Array) -> Array:
    """Returns a contiguous array in the narrowest of VOXEL_TYPES that holds its type, else float32.

    It is copied only if necessary.
    """
    kept = held_type(values.dtype)
    # float64 values beyond the range of float32 become infinite, and Field refuses them.
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(values, dtype=kept)
