# SPDX-License-Identifier: GPL-3.0-or-later
"""The walls of a bake, without those between the viewer and the volumes.

Outside a room, a viewer would see some walls from behind. The walls in front are left out, as in a
doll's house. Walls without baked light are shaded locally, so that their colors explain those on
the isosurface.
"""

from dataclasses import dataclass

import leaflight._core as _core
import numpy as np

from ..arrays import Array
from ..bake.baked import Bake
from .camera import bounds_of
from .lamps import lamps_of


@dataclass(frozen=True, eq=False)
class RoomMesh:
    """A mesh of the scene that is shown.

    number: Number of the mesh in the scene.
    vertices, triangles: float32 (n, 3), and triangles.
    is_of_room: True for a flat wall, or a mesh around the middle of the volumes.
    is_lit: True if it has baked light at its vertices.
    albedo, emission: Colors.
    """

    number: int
    vertices: Array
    triangles: Array
    is_of_room: bool
    is_lit: bool
    albedo: Array
    emission: Array


def room_meshes(bake: Bake) -> list[RoomMesh]:
    """Returns the RoomMesh of each diffuse mesh of a Bake's scene, without mirrors and glass."""
    middle = np.mean(bounds_of(bake), axis=0)
    walls, found = bake.walls, []
    for number, mesh in enumerate(bake.scene.meshes):
        if mesh.scattering == "diffuse":
            vertices, triangles = mesh.vertices, mesh.triangles
            if walls is not None:
                vertices, triangles = walls.mesh(number)
            albedo = np.array(mesh.albedo, np.float64)
            if mesh.texture is not None:
                albedo = albedo * mesh.texture.mean(axis=(0, 1))
            is_of_room, is_lit = _is_of_room(vertices, middle), walls is not None
            emission = np.array(mesh.emission)
            found.append(
                RoomMesh(number, vertices, triangles, is_of_room, is_lit, albedo, emission)
            )
    return found


def _is_of_room(vertices: Array, middle: Array) -> bool:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    if np.all((low < middle) & (middle < high)):
        return True
    centerd = vertices.astype(np.float64) - vertices.mean(axis=0)
    size = np.linalg.svd(centerd, compute_uv=False)
    return bool(size[2] <= 1e-4 * size[0])


class SeenWalls:
    """The walls seen from a point, with the light of one isosurface (common isovalue).

    local: True uses local shading, as if no light of walls were baked.
    """

    def __init__(self, bake: Bake, isovalue: float, eye: Array, local: bool = False) -> None:
        middle = np.mean(bounds_of(bake), axis=0)
        self._lamps = lamps_of(bake.scene)
        self._mesh: _core.Mesh | None = None
        sides: tuple[list[Array], list[Array]] = ([], [])
        vertices, triangles, colors, count = [], [], [], 0
        walls = None if local else bake.walls
        for mesh in room_meshes(bake):
            facets = mesh.triangles.astype(np.int64)
            if mesh.is_of_room:
                facets = facets[~_is_between(mesh.vertices, facets, eye, middle)]
            vertices.append(mesh.vertices)
            triangles.append(facets + count)
            count += len(mesh.vertices)
            colors += [np.concatenate([mesh.albedo, mesh.emission])] * len(facets)
            if walls is not None:
                for back in (False, True):
                    sides[back].append(walls.radiance(mesh.number, isovalue, back=back))
        if not colors:
            return
        self._vertices = np.concatenate(vertices).astype(np.float32)
        self._triangles = np.concatenate(triangles).astype(np.uint32)
        self._colors = np.array(colors)
        self._sides = None if walls is None else [np.concatenate(side) for side in sides]
        self._mesh = _core.Mesh("walls", self._vertices, self._triangles, (0.0, 0.0, 0.0))

    def hits(self, origins: Array, directions: Array) -> tuple[Array, Array]:
        """Returns (distances (n,), infinite for none; radiance (n, 3)) for rays (n, 3)."""
        distances, radiance = np.full(len(origins), np.inf), np.zeros((len(origins), 3))
        if self._mesh is None:
            return distances, radiance
        distances, facets, (u, v) = _transposed(_core.mesh_hits(self._mesh, origins, directions))
        hit = facets >= 0
        corners = self._triangles[facets[hit]]
        a, b, c = (self._vertices[corners[:, k]].astype(np.float64) for k in range(3))
        normals = np.cross(b - a, c - a)
        behind = (normals * directions[hit]).sum(axis=1) > 0.0
        if self._sides is None:
            normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]
            normals[behind] *= -1.0
            points = origins[hit] + distances[hit, None] * directions[hit]
            light = self._lamps.irradiance(points, normals, origins[hit])
            colors = self._colors[facets[hit]]
            radiance[hit] = colors[:, :3] * light + colors[:, 3:]
            return distances, radiance
        weights = np.stack([1.0 - u - v, u, v], axis=1)[hit]
        for back in (False, True):
            mixed = (self._sides[back][corners] * weights[..., None]).sum(axis=1)
            radiance[np.flatnonzero(hit)[behind == back]] = mixed[behind == back]
        return distances, radiance


def _transposed(hits: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
    distances, facets, coordinates = hits
    return distances, facets, coordinates.T


def _is_between(vertices: Array, triangles: Array, eye: Array, middle: Array) -> Array:
    """Returns a mask of triangles whose plane separates the eye from the middle of the volumes."""
    a, b, c = (vertices[triangles[:, k]].astype(np.float64) for k in range(3))
    normals = np.cross(b - a, c - a)
    sides = ((eye - a) * normals).sum(axis=1), ((middle - a) * normals).sum(axis=1)
    is_between: Array = sides[0] * sides[1] < 0.0
    return is_between
