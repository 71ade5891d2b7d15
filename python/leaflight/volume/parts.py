# SPDX-License-Identifier: GPL-3.0-or-later
"""Separate parts of a volume: connected voxels at or above an isovalue.

A part that goes takes the voxels around it along, up to a distance, where its edge fades out. Their
values become at most that of the surroundings, so lower isosurfaces show no shell.
"""

from collections.abc import Callable

import numpy as np

import leaflight._core as _core

from .._core import LeaflightError
from ..arrays import Array
from .memory import as_voxels

# Distance in voxels to which the edge of a part fades out.
_FADE = 4
# Distance in voxels from a point within which a part is found.
_REACH = 2


def parts_of(values: Array, isovalue: float, progress: _core.Progress) -> tuple[Array, Array]:
    """Returns (numbers [z, y, x], sizes) of _core.components().

    Raises LeaflightError if there is no part, and Cancelled.
    """
    field = _core.Field(as_voxels(values), np.eye(4))
    numbers, sizes = _core.components(field, isovalue, progress)
    if len(sizes) == 1:
        raise LeaflightError(f"There is nothing at or above the isovalue {isovalue:g}.")
    return numbers, sizes


def part_at(numbers: Array, index: Array) -> int:
    """Returns the number of the part next to an index position (x, y, z), or 0."""
    first = np.maximum(np.floor(index).astype(int) - _REACH + 1, 0)
    last = np.floor(index).astype(int) + _REACH + 1
    if (last <= first).any():
        return 0
    z, y, x = (slice(first[a], last[a]) for a in (2, 1, 0))
    near = numbers[z, y, x]
    places = np.argwhere(near)
    if not len(places):
        return 0
    nearest = np.argmin(np.linalg.norm(places[:, ::-1] + first - index, axis=1))
    return int(near[tuple(places[nearest])])


def without(values: Array, goes: Array, stays: Array, check: Callable[[], None]) -> Array:
    """Returns the values without parts.

    goes, stays: Voxels of the parts, bool [z, y, x]. check: It may raise Cancelled.
    """
    around, kept = goes, stays
    for _ in range(_FADE):
        check()
        around, kept = _grown(around) & ~kept, _grown(kept) & ~around
    check()
    rim = _grown(around) & ~around & ~kept & np.isfinite(values)
    found = values.copy()
    if rim.any():
        level = np.median(values[rim]).astype(values.dtype)
    else:
        level = np.nanmin(values)
    found[around] = np.minimum(values[around], level)
    return found


def _grown(voxels: Array) -> Array:
    """Returns the voxels and their next neighbors."""
    found = voxels.copy()
    for axis in range(3):
        to, source = np.moveaxis(found, axis, 0), np.moveaxis(voxels, axis, 0)
        to[1:] |= source[:-1]
        to[:-1] |= source[1:]
    return found
