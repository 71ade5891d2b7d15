# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds which side of isosurfaces is seen from outside: front (lower values) or back.

The inside of a level set is low, and so are negative lobes: their backs are seen.
"""

import itertools
from collections.abc import Sequence

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from .volume import Volume

# If backs are more than this share of the visible area, the isosurface is seen from its back.
MOSTLY = 0.6
# Parallel rays along each side of a square around the volume, from 14 directions.
_ACROSS = 32
# Larger volumes are thinned to the first number of voxels, and at least the second along each axis.
_MOST_VOXELS, _LEAST = 1 << 20, 8


def back_shares(values: Array, index_to_world: Array, isovalues: Sequence[float]) -> list[float]:
    """Returns the share of backs in the visible area of each isosurface, seen from all around.

    An empty isosurface has 0. values: [z, y, x]; index_to_world: as in a Volume.
    """
    most = max(1, round((values.size / _MOST_VOXELS) ** (1 / 3)))
    steps = [min(most, max(1, n // _LEAST)) for n in values.shape]
    some = np.ascontiguousarray(values[tuple(slice(None, None, step) for step in steps)])
    matrix = np.asarray(index_to_world, np.float64) @ np.diag([*steps[::-1], 1.0])
    try:
        field = Volume(some, matrix).field()
    except LeaflightError:
        # All voxels that were kept are equal.
        return [0.0] * len(isovalues)
    origins, directions = _rays_around(np.asarray(field.bounds, np.float64))
    shares = []
    for isovalue in isovalues:
        distances, is_back = _core.isosurface_hits(field, origins, directions, isovalue)
        seen = np.isfinite(distances)
        shares.append(float(np.mean(is_back[seen] == 1)) if seen.any() else 0.0)
    return shares


def _rays_around(bounds: Array) -> tuple[Array, Array]:
    """Returns rays from the axes and the diagonals towards a box: origins and directions (n, 3)."""
    low, high = bounds
    middle, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    places = radius * ((np.arange(_ACROSS) + 0.5) / _ACROSS * 2.0 - 1.0)
    u, v = (each.reshape(-1, 1) for each in np.meshgrid(places, places))
    origins, directions = [], []
    for axis in itertools.product((-1.0, 0.0, 1.0), repeat=3):
        if np.count_nonzero(axis) == 2 or not any(axis):
            continue
        forward = np.array(axis) / np.linalg.norm(axis)
        right = np.cross(forward, np.eye(3)[np.abs(forward).argmin()])
        right /= np.linalg.norm(right)
        origins.append(middle - 2.0 * radius * forward + u * right + v * np.cross(right, forward))
        directions.append(np.broadcast_to(forward, origins[-1].shape))
    return np.concatenate(origins), np.ascontiguousarray(np.concatenate(directions))
