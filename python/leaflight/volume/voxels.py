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
