# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes of scattered points with values, by Shepard's interpolation (thesis 4.3.1)."""

import math
from collections.abc import Sequence

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from .setting_error import SettingError
from .volume import Volume

# Reach of a point, in voxels from the node that is nearest to it.
REACH = 3
# Exponent of the distance in the weights (thesis Eq. 3.11).
POWER = 5
# Nearer than this, in voxels, a point counts as lying on the node.
NEAREST = 1e-3
# Tolerances in voxels within which points are nodes of a grid: for coordinates rounded to a few
# digits, and at most for those rounded to single precision.
EVEN, ROUNDED = 0.02, 0.25
# Limits on the default number of nodes along the longest side.
FEWEST, MOST = 16, 256


def interpolated(
    points: Array,
    values: Array,
    name: str,
    source: str = "",
    nodes: Sequence[int] | None = None,
) -> Volume:
    """Returns a Volume through points (n, 3) with values (n,), on the box that they fill.

    Points that are the nodes of a grid, in any order, keep their values. Otherwise each node is the
    mean of the points within REACH voxels, weighted by distance^-5. Nodes that no point reaches
    take the mean of their neighbors, so that no holes are left. Points with a coordinate or a value
    that is not finite are left out.

    nodes: Nodes along the longest side, or along x, y and z. The default is about one for each
        point.
    Raises LeaflightError if the points do not fill a box.
    """
    points, values = np.asarray(points, np.float64), np.asarray(values, np.float64)
    grid = _regular(points)
    if grid is not None and _fits(nodes, grid[0]):
        counts, step, first, places = grid
        array = np.full(counts[::-1], np.nan)
        array[tuple(places.T[::-1])] = values
        return Volume(array, None, name, source, spacing=step, origin=first)
    known = np.isfinite(points).all(axis=1) & np.isfinite(values)
    points, values = points[known], values[known]
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3),) * 2
    sides = high - low
    if len(points) < 4 or not (sides > 0).all():
        raise LeaflightError(
            f"{source or name}: the {len(points)} points do not fill a box; give points that "
            "differ along x, y and z."
        )
    counts, step = _grid(source or name, sides, len(points), nodes)
    # Center the nodes, because the sides need not be whole numbers of voxels.
    first = low + 0.5 * (sides - step * (counts - 1))
    array = _filled(*_averages((points - first) / step, values, counts))
    return Volume(array.astype(np.float32), None, name, source, spacing=step, origin=first)


def _regular(points: Array) -> tuple[Array, Array, Array, Array] | None:
    """Returns (counts, distances, first position, node of each point) of a complete grid, else
    None.
    """
    if len(points) < 8 or not np.isfinite(points).all():
        return None
    # Coordinates may be rounded to single precision.
    rounding = np.finfo(np.float32).eps * np.abs(points).max(axis=0)
    counts, steps, places = [], [], []
    for along, slack in zip(points.T, rounding):
        gaps = np.diff(np.sort(along))
        count = int((gaps > 0.5 * gaps.max()).sum()) + 1
        if count < 2:
            return None
        step = np.ptp(along) / (count - 1)
        place = (along - along.min()) / step
        if np.abs(place - np.rint(place)).max() > EVEN + min(ROUNDED, slack / step):
            return None
        counts.append(count)
        steps.append(step)
        places.append(np.rint(place).astype(np.int64))
    if math.prod(counts) != len(points):
        return None
    nodes = np.stack(places, axis=-1)
    if len(np.unique(np.ravel_multi_index(nodes.T, counts))) != len(points):
        return None
    return np.array(counts), np.array(steps), points.min(axis=0), nodes


def _fits(nodes: Sequence[int] | None, counts: Array) -> bool:
    """Returns True if the chosen nodes equal those of a grid with these counts."""
    return nodes is None or list(nodes) in ([*counts], [max(counts)])


def _grid(
    source: str, sides: Array, points: int, nodes: Sequence[int] | None
) -> tuple[Array, Array]:
    """Returns the nodes along x, y and z, and the distances between them."""
    if nodes is not None and len(nodes) == 3 and min(nodes) >= 2:
        counts = np.array(nodes, int)
        return counts, sides / (counts - 1)
    if nodes is not None and (len(nodes) != 1 or nodes[0] < 2):
        raise SettingError(
            f"{source}: the number of nodes must be one integer (longest side) or three, at least "
            "2 each.",
            "dims",
        )
    if nodes is not None:
        step = sides.max() / (nodes[0] - 1)
    else:
        # About one node for each point.
        step = _lattice_step(sides, points)
        step = np.clip(step, sides.max() / (MOST - 1), sides.max() / (FEWEST - 1))
    counts = np.maximum(2, np.rint(sides / step).astype(int) + 1)
    return counts, sides / (counts - 1) if nodes is None else np.full(3, step)


def _lattice_step(sides: Array, points: int) -> float:
    """Returns the distance at which a cubic lattice in a box has this many nodes."""
    low, high = 0.0, float(sides.max())
    for _ in range(60):
        step = 0.5 * (low + high)
        low, high = (step, high) if np.prod(sides / step + 1) > points else (low, step)
    return high


def _averages(places: Array, values: Array, counts: Array) -> tuple[Array, Array]:
    """Returns (weighted sums, sums of weights) at the nodes, [z, y, x].

    places: Positions of the points, in voxels.
    """
    shape = tuple(counts[::-1])
    sums, weights = np.zeros(np.prod(shape)), np.zeros(np.prod(shape))
    nearest = np.rint(places).astype(np.int64)
    offsets = np.arange(-REACH, REACH + 1)
    for offset in np.stack(np.meshgrid(offsets, offsets, offsets), axis=-1).reshape(-1, 3):
        nodes = nearest + offset
        inside = ((nodes >= 0) & (nodes < counts)).all(axis=1)
        nodes = nodes[inside]
        distance = np.linalg.norm(places[inside] - nodes, axis=1)
        weight = np.maximum(distance, NEAREST) ** -POWER
        at = np.ravel_multi_index(nodes.T[::-1], shape)
        sums += np.bincount(at, weight * values[inside], sums.size)
        weights += np.bincount(at, weight, sums.size)
    return sums.reshape(shape), weights.reshape(shape)


def _filled(sums: Array, weights: Array) -> Array:
    """Returns the means. Nodes without points take those of their neighbors, layer by layer."""
    known = weights > 0
    means = np.divide(sums, weights, out=np.zeros_like(sums), where=known)
    while not known.all():
        padded, seen = np.pad(means * known, 1), np.pad(known.astype(np.float64), 1)
        total, count = (_neighbors(array) for array in (padded, seen))
        new = ~known & (count > 0)
        means[new] = total[new] / count[new]
        known |= new
    return means


def _neighbors(padded: Array) -> Array:
    """Returns the sum over the six neighbors of each inner voxel."""
    inner = slice(1, -1)
    total = np.zeros(tuple(n - 2 for n in padded.shape))
    for axis in range(3):
        for side in (slice(0, -2), slice(2, None)):
            index = [inner] * 3
            index[axis] = side
            total += padded[tuple(index)]
    return total
