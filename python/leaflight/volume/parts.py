# SPDX-License-Identifier: GPL-3.0-or-later
"""Separate parts of a volume: connected voxels at or above an isovalue.

A part that goes or moves takes the voxels around it along, up to a distance, where its edge fades
out. Values at the place of a removed part become at most that of the surroundings, so lower
isosurfaces show no shell.
"""

from collections.abc import Callable, Iterator

import numpy as np

import leaflight._core as _core

from .._core import LeaflightError
from ..arrays import Array
from .memory import as_voxels, new_voxels

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


def shares_apart(middles: Array) -> Array:
    """Returns how far each part moves if the two outermost ones move apart by 1.

    The others move in proportion. All are 0 if the parts are at one place.
    middles: Places of the parts on a line.
    """
    low, high = middles.min(), middles.max()
    return (middles - 0.5 * (low + high)) / (high - low) if high > low else 0.0 * middles


def offsets_apart(numbers: Array, along: Array, toward: Array) -> Array:
    """Returns the offsets of parts in voxels, int64 (parts + 1, 3), [z, y, x]; row 0 is 0.

    along: Direction and distance of shares_apart() of their middles, in voxels [z, y, x].
    toward: Step of a voxel [z, y, x] along this direction of the world, which differs from `along`
        if voxels are no cubes.
    """
    z, y, x = (np.arange(n) * step for n, step in zip(numbers.shape, toward))
    places = z[:, None, None] + y[:, None] + x
    middles = (np.bincount(numbers.ravel(), places.ravel()) / np.bincount(numbers.ravel()))[1:]
    offsets = np.zeros((len(middles) + 1, 3), np.int64)
    offsets[1:] = np.rint(shares_apart(middles)[:, None] * along)
    return offsets


def apart(
    values: Array, numbers: Array, offsets: Array, check: Callable[[], None]
) -> tuple[Array, list[int]]:
    """Returns the values of parts that have moved, and the index (x, y, z) of their first node.

    Between parts there is the lowest value. numbers: of parts_of(). check: It may raise Cancelled.
    """
    numbers = numbers.copy()
    for _ in range(_FADE):
        check()
        for to, source in _neighbors(numbers, numbers.copy()):
            np.copyto(to, source, where=to == 0)
    first = np.minimum(offsets.min(axis=0), 0)
    shape = np.maximum(offsets.max(axis=0), 0) - first + values.shape
    found = new_voxels(shape.tolist(), values.dtype)
    found[...] = np.nanmin(values)
    # Parts with the same offset move together.
    steps, step_of = np.unique(offsets, axis=0, return_inverse=True)
    steps_of_voxels = np.where(numbers > 0, step_of.ravel()[numbers], -1)
    for number, step in enumerate(steps):
        check()
        start = step - first
        to = found[tuple(slice(a, a + n) for a, n in zip(start, values.shape))]
        np.fmax(to, values, out=to, where=steps_of_voxels == number)
    return found, first[::-1].tolist()


def _neighbors(to: Array, source: Array) -> Iterator[tuple[Array, Array]]:
    """Yields views of an array and of the next neighbors of its voxels in another one."""
    for axis in range(3):
        to_axis, from_axis = np.moveaxis(to, axis, 0), np.moveaxis(source, axis, 0)
        yield to_axis[1:], from_axis[:-1]
        yield to_axis[:-1], from_axis[1:]


def _grown(voxels: Array) -> Array:
    """Returns the voxels and their next neighbors."""
    found = voxels.copy()
    for to, source in _neighbors(found, voxels):
        to |= source
    return found
