# SPDX-License-Identifier: GPL-3.0-or-later
"""The lit walls of a bake, without those that stand between the viewer and the volumes.

Who goes around a box of walls would see them from behind; as of a doll's house, the walls in front
are left out.
"""

import leaflight._core as _core
import numpy as np

from .camera import bounds_of


def lit_meshes(bake):
    """[(number, vertices, triangles, whether it is of the room)] of the surroundings that are lit.

    A mesh is of the room if it is flat, as a wall is, or goes around the volumes' middle. None are
    lit where the surroundings were not baked; mirrors and glass never are.
    """
    if bake.surroundings is None:
        return []
    middle = np.mean(bounds_of(bake), axis=0)
    found = []
    for number, mesh in enumerate(bake.scene.meshes):
        if mesh.scattering == "diffuse":
            vertices, triangles = bake.surroundings.mesh(number)
            found.append((number, vertices, triangles, _is_of_room(vertices, middle)))
    return found


def _is_of_room(vertices, middle):
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    if np.all((low < middle) & (middle < high)):
        return True
    centred = vertices.astype(np.float64) - vertices.mean(axis=0)
    size = np.linalg.svd(centred, compute_uv=False)
    return bool(size[2] <= 1e-4 * size[0])


class SeenWalls:
    """The walls that are seen from a point, with the light of one isosurface (leaf coordinate)."""

    def __init__(self, bake, isovalue, eye):
        middle = np.mean(bounds_of(bake), axis=0)
        vertices, triangles, sides, count = [], [], ([], []), 0
        for number, points, facets, is_of_room in lit_meshes(bake):
            if is_of_room:
                facets = facets[~_is_between(points, facets, eye, middle)]
            vertices.append(points)
            triangles.append(facets + count)
            count += len(points)
            for back in (False, True):
                sides[back].append(bake.surroundings.radiance(number, isovalue, back=back))
        self._triangles = np.concatenate(triangles) if triangles else np.zeros((0, 3), np.int32)
        self._mesh = None
        if len(self._triangles) == 0:
            return
        self._vertices = np.concatenate(vertices)
        self._sides = [np.concatenate(side) for side in sides]
        self._mesh = _core.Mesh("walls", self._vertices, self._triangles, (0.0, 0.0, 0.0))

    def hits(self, origins, directions):
        """(distances (n,), infinite for none; radiance (n, 3)) of rays (n, 3)."""
        distances, radiance = np.full(len(origins), np.inf), np.zeros((len(origins), 3))
        if self._mesh is None:
            return distances, radiance
        distances, facets, (u, v) = _transposed(_core.mesh_hits(self._mesh, origins, directions))
        hit = facets >= 0
        corners = self._triangles[facets[hit]]
        weights = np.stack([1.0 - u - v, u, v], axis=1)[hit]
        a, b, c = (self._vertices[corners[:, k]].astype(np.float64) for k in range(3))
        behind = (np.cross(b - a, c - a) * directions[hit]).sum(axis=1) > 0.0
        for back in (False, True):
            mixed = (self._sides[back][corners] * weights[..., None]).sum(axis=1)
            radiance[np.flatnonzero(hit)[behind == back]] = mixed[behind == back]
        return distances, radiance


def _transposed(hits):
    distances, facets, coordinates = hits
    return distances, facets, coordinates.T


def _is_between(vertices, triangles, eye, middle):
    """Whether the plane of each triangle parts the eye from the middle of the volumes."""
    a, b, c = (vertices[triangles[:, k]].astype(np.float64) for k in range(3))
    normals = np.cross(b - a, c - a)
    return ((eye - a) * normals).sum(axis=1) * ((middle - a) * normals).sum(axis=1) < 0.0
