# SPDX-License-Identifier: GPL-3.0-or-later
"""The graph of a height field as a surface in space, lit by ordinary light (thesis Fig. 3.2).

Flattened light stays in the plane of its isovalue; ordinary light crosses planes. Both are compared
on the same graph. Walls and lamps of the plane are raised to the height of the graph. Lamps keep
their power, so their radiance is 2/pi of the flattened one (thesis Eq. 3.7).
"""

import leaflight._core as _core
import numpy as np
from leaflight import LeaflightError, Volume
from leaflight.arrays import Array
from leaflight.flatland import BRIGHTNESS_CORRECTION, FlatBake
from leaflight.scene.scene import is_color

# Height of the graph, in longest sides of the height field.
GRAPH_HEIGHT = 1.0


def graph_radiance(
    bake: FlatBake,
    height: float = GRAPH_HEIGHT,
    spp: int = 64,
    seed: int = 0,
    threads: int = 0,
    progress: _core.Progress | None = None,
) -> tuple[Array, Array]:
    """Computes path-traced radiance of the graph under ordinary light.

    bake: A FlatBake with the height field and the scene.
    height: Height of the graph above its lowest value, in longest sides.
    spp: Paths per point.
    Returns (radiance, standard_error), float32 (ny - 1, nx - 1, 3) each, in the middle of each
    cell. Raises LeaflightError, Cancelled.
    """
    vertices, triangles = graph_mesh(bake.volume, height)
    scene = _scene_in_space(bake, vertices, triangles)
    ny, nx = (n - 1 for n in bake.volume.values.shape)
    # The two triangles of a cell share the middle of their diagonal.
    first = list(range(0, len(triangles), 2))
    places = np.tile([0.0, 0.5], (len(first), 1))
    radiance, error = _core.reference_walls(
        scene, 0, first, places, 0.5, spp, seed, threads, progress or _core.Progress()
    )
    return radiance.reshape(ny, nx, 3), error.reshape(ny, nx, 3)


def graph_mesh(volume: Volume, height: float = GRAPH_HEIGHT) -> tuple[Array, Array]:
    """Returns the graph over an image: vertices float32 (ny nx, 3), triangles uint32 (m, 3)."""
    values = volume.values
    ny, nx = values.shape
    low, high = volume.field().bounds
    size = float(np.max(np.subtract(high, low)))
    bottom, top = volume.field().range
    j, i = np.mgrid[0:ny, 0:nx]
    matrix = volume.index_to_world
    plane = np.stack([i, j], axis=-1) @ matrix[:2, :2].T + matrix[:2, 2]
    z = height * size * (values - bottom) / (top - bottom)
    vertices = np.concatenate([plane, z[..., None]], axis=-1).reshape(-1, 3)
    corner = (j[:-1, :-1] * nx + i[:-1, :-1]).ravel()
    right, above, across = corner + 1, corner + nx, corner + nx + 1
    pairs = np.stack([corner, right, across, corner, across, above], axis=-1)
    return vertices.astype(np.float32), pairs.reshape(-1, 3).astype(np.uint32)


def _scene_in_space(bake: FlatBake, vertices: Array, triangles: Array) -> _core.Scene:
    """Returns the graph with the plane's walls and lamps raised to its height; open above."""
    top = float(vertices[:, 2].max())
    albedo = bake.scene.isosurfaces.albedo
    if not is_color(albedo):
        raise LeaflightError(
            "The isolines have several colors, but their graph has only one: give them one color."
        )
    meshes = [_core.Mesh("graph", vertices, triangles, albedo)]
    for wall in bake.scene.walls:
        flat = np.asarray(wall.vertices, np.float32)
        count = len(flat)
        raised = np.concatenate(
            [np.c_[flat, np.full(count, level, np.float32)] for level in (0.0, top)]
        )
        a, b = np.asarray(wall.segments, np.uint32).T
        faces = np.concatenate([np.c_[a, b, b + count], np.c_[a, b + count, a + count]])
        meshes.append(_core.Mesh(wall.name, raised, faces.astype(np.uint32), wall.albedo))
    lamps = [
        _core.AreaLight(
            lamp.name,
            (*lamp.corner, 0.0),
            # In the reverse order, the lamp faces the left of the edge in the plane.
            (0.0, 0.0, top),
            (*lamp.edge, 0.0),
            tuple(BRIGHTNESS_CORRECTION * np.asarray(lamp.radiance)),
        )
        for lamp in bake.scene.lamps
    ]
    return _core.Scene([], meshes, lamps, isovalues=(0.0, 1.0))
