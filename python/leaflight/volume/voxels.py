# SPDX-License-Identifier: GPL-3.0-or-later
"""The arrays that hold the values of volumes."""

from collections.abc import Iterable
from typing import Any

import leaflight._core as _core
import numpy as np
from numpy.typing import DTypeLike

from ..arrays import Array

# Voxel types of the core, narrowest first. Files of other types are converted.
VOXEL_TYPES = (np.uint8, np.int16, np.uint16, np.float32)


def new_voxels(shape: Iterable[int], dtype: DTypeLike) -> Array:
    """An array for the values of a volume, whatever is in it, in memory or in a file.

    Raises LeaflightError where the disk has no room.
    """
    return _core.large_array([int(n) for n in shape], np.dtype(dtype))


def bytes_of(voxels: Array) -> memoryview:
    """The memory of a contiguous array of any type, to be filled byte by byte."""
    return voxels.reshape(-1).view(np.uint8).data


def held_type(dtype: DTypeLike) -> np.dtype[Any]:
    """The one of VOXEL_TYPES, a dtype, that values of this type are held in."""
    kept = next((kept for kept in VOXEL_TYPES if np.can_cast(dtype, kept)), np.float32)
    return np.dtype(kept)


def as_voxels(values: Array) -> Array:
    """The array in the narrowest of VOXEL_TYPES that holds all that its own type can, else float32.

    C-contiguous; a copy only where it must be.
    """
    kept = held_type(values.dtype)
    # float64 values beyond the range of float32 become infinite, which Field refuses by itself.
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(values, dtype=kept)
