# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the graph of a height field under light in space against its light in the plane."""

from dataclasses import replace

import numpy as np
import pytest
from leaflight import flatland
from leaflight.flatland import graph


@pytest.fixture(scope="module")
def direct_bake():
    """Returns the 2D bump box with black walls and hardly any interreflection."""
    scene = flatland.flat_box()
    dark = replace(
        scene,
        walls=[replace(wall, albedo=(0.0, 0.0, 0.0)) for wall in scene.walls],
        isosurfaces=replace(scene.isosurfaces, albedo=(0.02, 0.02, 0.02)),
    )
    return flatland.bake_flatland(flatland.bump_box_2d(61), dark, resolution=61)


def _flattened(bake):
    """Returns the corrected texture at the centers of cells, and a mask of known texels."""
    texture = bake.texture() * flatland.BRIGHTNESS_CORRECTION
    known = bake.grid.mask() > 0
    corners = [(slice(a, a - 1 or None), slice(b, b - 1 or None)) for a in (0, 1) for b in (0, 1)]
    mean = sum(texture[corner] for corner in corners) / 4
    return mean, np.logical_and.reduce([known[corner] for corner in corners])


def test_the_mesh_is_the_graph():
    volume = flatland.bump_box_2d(9)
    vertices, triangles = graph.graph_mesh(volume, 2.0)
    assert vertices.shape == (81, 3) and triangles.shape == (128, 3)
    np.testing.assert_allclose(vertices[:, 2].reshape(9, 9), volume.values / 127.5, rtol=1e-5)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_a_steep_graph_is_lit_as_by_flattened_light(direct_bake):
    # Walls of infinite height and lamps repeat along z. Light in space then equals light in the
    # plane with the factor 2/pi (thesis 3.4.3). The graph is flat, so it sees the lamp at an angle.
    flattened, known = _flattened(direct_bake)
    ratios = []
    for height in (1.0, 4.0, 32.0):
        ordinary, _ = graph.graph_radiance(direct_bake, height=height, spp=1024)
        ratios.append(flattened[known].mean() / ordinary[known].mean())
    assert ratios[0] > ratios[1] > ratios[2]
    assert ratios[2] == pytest.approx(1, abs=0.06)
    # Single points agree, too, except for the mesh's facets and noise.
    assert np.corrcoef(flattened[known].ravel(), ordinary[known].ravel())[0, 1] > 0.95
