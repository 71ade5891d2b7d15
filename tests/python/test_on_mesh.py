# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests points on triangle meshes, and the probes on them for Cycles."""

import numpy as np
import pytest
from leaflight.measure.cycles import _lay_out, _mesh, _pack
from leaflight.scene.on_mesh import interpolated, positions, random_places
from leaflight.scene.scene import Mesh

# A bent sheet of three triangles; the last one is much smaller.
VERTICES = np.array([[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0], [3, 0, 0.5]], dtype=np.float32)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]], dtype=np.uint32)
AREAS = np.array([4.5, 4.5, 0.75])


def linear(points):
    return np.stack([points @ [1.0, 2.0, 3.0], 5.0 - points @ [2.0, 0.0, 1.0]], axis=-1)


def test_what_is_linear_over_the_mesh_is_interpolated_exactly():
    points = positions(VERTICES, TRIANGLES, *random_places(VERTICES, TRIANGLES, 500, seed=2))
    found = interpolated(VERTICES, TRIANGLES, linear(VERTICES), points)
    np.testing.assert_allclose(found, linear(points), atol=1e-5)


def test_between_the_vertices_of_a_large_mesh(box_bake):
    surface = box_bake.surface(47.0)
    facets, coordinates = random_places(surface.vertices, surface.triangles, 400, 5)
    points = positions(surface.vertices, surface.triangles, facets, coordinates)
    a, b, c = (surface.radiance[surface.triangles[facets, k]] for k in range(3))
    expected = a + coordinates[:, :1] * (b - a) + coordinates[:, 1:] * (c - a)
    found = interpolated(surface.vertices, surface.triangles, surface.radiance, points)
    np.testing.assert_allclose(found, expected, atol=1e-4)
    # A point far from the mesh takes values of the nearest triangle.
    far = interpolated(surface.vertices, surface.triangles, surface.radiance, points[:1] + 9.0)
    assert np.isfinite(far).all()


def test_triangles_without_area_hold_no_points():
    flat = np.concatenate([TRIANGLES, [[0, 0, 1], [2, 2, 2]]]).astype(np.uint32)
    points = positions(VERTICES, flat, *random_places(VERTICES, flat, 100, seed=2))
    found = interpolated(VERTICES, flat, linear(VERTICES), points)
    np.testing.assert_allclose(found, linear(points), atol=1e-5)


@pytest.mark.parametrize("sides", [[3, 1, 0, 2, 1, 1], [1], [5], [1] * 100, [0, 40, 1]])
def test_squares_of_pixels_do_not_overlap(sides):
    places, (width, height) = _pack(np.array(sides))
    taken = np.zeros((height, width), dtype=int)
    assert set(places) == {i for i, side in enumerate(sides) if side > 0}
    for number, (x, y) in places.items():
        assert x + sides[number] <= width and y + sides[number] <= height
        taken[y : y + sides[number], x : x + sides[number]] += 1
    assert taken.max() == 1


@pytest.mark.parametrize("count", [1, 3, 400])
def test_probes_lie_where_cycles_bakes_their_pixels(count):
    mesh = _mesh(Mesh("sheet", VERTICES, TRIANGLES, (0.5, 0.5, 0.5)))
    probes, pixels, (width, height), uv = _lay_out(mesh, count, seed=3)
    assert len(set(pixels)) == len(pixels) >= count
    # Each texture coordinate must be the center of the probe's pixel.
    a, b, c = (uv[probes.facets, k] * [width, height] for k in range(3))
    u, v = probes.coordinates.T[..., None]
    assert (u > 0).all() and (v > 0).all() and (u + v < 1).all()
    centers = np.stack([pixels % width, pixels // width], axis=1) + 0.5
    np.testing.assert_allclose(a + u * (b - a) + v * (c - a), centers, atol=1e-3)
    on_mesh = positions(VERTICES, TRIANGLES, probes.facets, probes.coordinates)
    np.testing.assert_array_equal(probes.points, on_mesh)
    shares = np.bincount(probes.facets, probes.weights, minlength=3)
    assert shares.sum() == pytest.approx(1)
    if count == 400:
        np.testing.assert_allclose(shares, AREAS / AREAS.sum(), atol=4 * np.sqrt(0.25 / count))
