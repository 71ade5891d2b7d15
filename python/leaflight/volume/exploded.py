# SPDX-License-Identifier: GPL-3.0-or-later
"""Exploded views: the parts of an isosurface moved apart along a direction.

A part is connected at or above the isovalue. Its cavities move with it.
"""

import numpy as np

import leaflight._core as _core

from ..arrays import Array
from .parts import shares_apart
from .volume import Volume


def explode_offsets(
    volume: Volume, isovalue: float, vertices: Array, triangles: Array, along: Array
) -> Array:
    """Returns the offsets, float32 (n, 3), of the vertices of an exploded isosurface.

    The middles of the two outermost parts move apart by `along`, and those between in proportion.
    vertices, triangles: The mesh of the isosurface, in world coordinates.
    along: Direction and distance (x, y, z).
    """
    along = np.asarray(along, np.float64)
    length = float(np.linalg.norm(along))
    offsets = np.zeros((len(vertices), 3), np.float32)
    if not len(vertices) or length == 0:
        return offsets
    part = _parts_of(volume, isovalue, vertices, triangles)
    places = np.asarray(vertices, np.float64) @ along / length
    middles = np.bincount(part, places) / np.bincount(part)
    offsets[:] = shares_apart(middles)[part, None] * along
    return offsets


def _parts_of(volume: Volume, isovalue: float, vertices: Array, triangles: Array) -> Array:
    """Returns the number of the part of each vertex, from 0 on."""
    numbers = _numbers_at(volume, isovalue, vertices)
    count = len(vertices)
    # Link vertices with a node of their voxels' part, which joins a cavity with what surrounds it.
    # The triangles join voxels that touch across an edge.
    linked = np.flatnonzero(numbers)
    nodes = count + numbers[linked]
    links = np.stack([linked, nodes, nodes], axis=1)
    joined = np.concatenate([triangles, links]).astype(np.int32)
    least = _core.connected_parts(joined, count + int(numbers.max()) + 1)[:count]
    part: Array = np.unique(least, return_inverse=True)[1].ravel()
    return part


def _numbers_at(volume: Volume, isovalue: float, vertices: Array) -> Array:
    """Returns the number of _core.components() of the nearest voxel around each vertex, or 0."""
    numbers, _ = _core.components(volume.field(), isovalue, _core.Progress())
    to_index = np.linalg.inv(volume.index_to_world)
    index = np.asarray(vertices, np.float64) @ to_index[:3, :3].T + to_index[:3, 3]
    first = np.clip(np.floor(index), 0, np.subtract(numbers.shape[::-1], 2)).astype(np.int64)
    found, nearest = np.zeros(len(vertices), np.int64), np.full(len(vertices), -1.0)
    for corner in np.ndindex(2, 2, 2):
        at = first + corner
        here = numbers[at[:, 2], at[:, 1], at[:, 0]]
        weight = np.prod(1.0 - abs(index - at), axis=1)
        better = (here > 0) & (weight > nearest)
        found[better], nearest[better] = here[better], weight[better]
    return found
