# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on triangle meshes, and interpolation of values at vertices.

A point is a facet, a triangle's number, with barycentric coordinates (u, v) of its second and third
vertex.
"""

from collections.abc import Iterator

import numpy as np

from ..arrays import Array

# Points per batch: the distances of a batch to all triangles are in memory together.
POINTS_AT_ONCE = 64


def random_facets(vertices: Array, triangles: Array, count: int, rng: np.random.Generator) -> Array:
    """Draws numbers (count,) of triangles in proportion to their area."""
    a, b, c = corners(vertices, triangles)
    cumulative = np.cumsum(np.linalg.norm(np.cross(b - a, c - a), axis=1))
    chosen = np.searchsorted(cumulative, rng.random(count) * cumulative[-1], side="right")
    facets: Array = np.minimum(chosen, len(triangles) - 1)
    return facets


def random_places(vertices: Array, triangles: Array, count: int, seed: int) -> tuple[Array, Array]:
    """Draws facets (count,) and coordinates (count, 2) of points uniform over the area."""
    rng = np.random.default_rng(seed)
    facets = random_facets(vertices, triangles, count, rng)
    root, v = np.sqrt(rng.random(count)), rng.random(count)
    return facets, np.stack([root - root * v, root * v], axis=1)


def positions(vertices: Array, triangles: Array, facets: Array, coordinates: Array) -> Array:
    """Returns world positions float64 (n, 3) of facets (n,) and coordinates (n, 2)."""
    a, b, c = corners(vertices, triangles[facets])
    places: Array = a + coordinates[:, :1] * (b - a) + coordinates[:, 1:] * (c - a)
    return places


def random_points(vertices: Array, triangles: Array, count: int, seed: int) -> Array:
    """Draws points (count, 3), float64, uniformly over the area of the triangles."""
    return positions(vertices, triangles, *random_places(vertices, triangles, count, seed))


def interpolated(vertices: Array, triangles: Array, values: Array, points: Array) -> Array:
    """Interpolates values (n, k) of the vertices at points (p, 3) of the mesh; returns (p, k)."""
    near = _TrianglesByBlock(vertices, triangles)
    result = np.empty((len(points), values.shape[1]))
    for members, candidates in near.candidates(points):
        for first in range(0, len(members), POINTS_AT_ONCE):
            rows = members[first : first + POINTS_AT_ONCE]
            result[rows] = _nearest(vertices, triangles[candidates], values, points[rows])
    return result


class _TrianglesByBlock:
    """Triangles by the block of space of their centroid; blocks are as wide as the longest edge.

    The centroid of a triangle at a point is therefore in the point's block or in an adjacent one.
    """

    def __init__(self, vertices: Array, triangles: Array) -> None:
        a, b, c = corners(vertices, triangles)
        self._size = max(np.linalg.norm(q - p, axis=1).max() for p, q in ((a, b), (b, c), (c, a)))
        middles = (a + b + c) / 3
        self._low = middles.min(axis=0)
        self._shape = self._blocks(middles).max(axis=0) + 3
        keys = self._keys(self._blocks(middles))
        self._order = np.argsort(keys, kind="stable")
        self._sorted = keys[self._order]
        steps = np.arange(-1, 2)
        self._beside = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), -1).reshape(-1, 3)

    def candidates(self, points: Array) -> Iterator[tuple[Array, Array]]:
        """Yields (numbers of points, numbers of triangles near them) until all points are done."""
        blocks, block_of = np.unique(
            np.clip(self._blocks(points), -1, self._shape - 2), axis=0, return_inverse=True
        )
        by_block = np.argsort(block_of.ravel(), kind="stable")
        ends = np.cumsum(np.bincount(block_of.ravel()))
        for block, members in zip(blocks, np.split(by_block, ends[:-1])):
            keys = self._keys(np.clip(block + self._beside, -1, self._shape - 2))
            keys = np.unique(keys)
            first = np.searchsorted(self._sorted, keys, "left")
            last = np.searchsorted(self._sorted, keys, "right")
            near = np.concatenate([self._order[i:j] for i, j in zip(first, last)])
            yield members, np.sort(near) if len(near) else np.arange(len(self._order))

    def _blocks(self, points: Array) -> Array:
        blocks: Array = np.floor((points - self._low) / self._size).astype(np.int64)
        return blocks

    def _keys(self, blocks: Array) -> Array:
        x, y, z = np.moveaxis(blocks + 1, -1, 0)
        keys: Array = (z * self._shape[1] + y) * self._shape[0] + x
        return keys


def _nearest(vertices: Array, triangles: Array, values: Array, points: Array) -> Array:
    """Returns interpolated values in the nearest of a few triangles."""
    a, b, c = corners(vertices, triangles)
    across = np.stack([b - a, c - a], axis=1)
    normals = np.cross(across[:, 0], across[:, 1])
    areas = np.linalg.norm(normals, axis=1)
    usable = areas > 0
    a, across, normals, areas = a[usable], across[usable], normals[usable], areas[usable]
    # Matrix from an offset to the first corner to (u, v, distance in sizes of the triangle).
    edges = np.stack([across[:, 0], across[:, 1], normals / np.sqrt(areas)[:, None]], axis=2)
    to_local = np.linalg.inv(edges)
    local = np.einsum("fij,pfj->pfi", to_local, points[:, None] - a)
    u, v, off = np.moveaxis(local, 2, 0)
    outside = np.maximum(0.0, np.maximum(np.maximum(-u, -v), u + v - 1.0))
    nearest = np.argmin(outside + np.abs(off), axis=1)
    rows = np.arange(len(nearest))
    u, v = u[rows, nearest, None], v[rows, nearest, None]
    at_a, at_b, at_c = (values[triangles[usable][nearest, k]] for k in range(3))
    nearby: Array = at_a + u * (at_b - at_a) + v * (at_c - at_a)
    return nearby


def corners(vertices: Array, triangles: Array) -> tuple[Array, Array, Array]:
    """Returns the three vertices of the triangles, float64 (m, 3) each."""
    a, b, c = (vertices[triangles[:, k]].astype(np.float64) for k in range(3))
    return a, b, c
