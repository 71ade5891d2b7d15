# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests meshes of isosurfaces in Python: with their radiance, without copies, manifolds."""

import gc

import leaflight
import numpy as np
import pytest
from leaflight._core import contour
from leaflight.scene.on_mesh import positions, random_places
from outcomes import refused


def _sides_used_twice(triangles):
    """Returns the directed edges that several triangles share; a manifold has none."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    numbers = sides[:, 0].astype(np.int64) << 32 | sides[:, 1]
    return len(numbers) - len(np.unique(numbers))


def _coincident(triangles):
    corners = np.sort(triangles, axis=1)
    return len(corners) - len(np.unique(corners, axis=0))


@pytest.mark.parametrize("isovalue", [24.5, 45.5, 70.5, 100.5, 150.5])
def test_no_triangles_of_colin27_coincide(colin27, isovalue):
    field = leaflight.read_volume(colin27).field()
    vertices, _, triangles = contour(field, isovalue, normals=False)
    assert len(triangles) > 100_000
    assert _sides_used_twice(triangles) == 0
    assert _coincident(triangles) == 0
    assert np.array_equal(np.unique(triangles), np.arange(len(vertices)))


def test_normals_only_where_asked_for(box_bake):
    field = box_bake.volume.field()
    vertices, normals, triangles = contour(field, 47.0)
    assert normals.shape == vertices.shape
    bare = contour(field, 47.0, normals=False)
    assert bare[1] is None
    np.testing.assert_array_equal(bare[0], vertices)
    np.testing.assert_array_equal(bare[2], triangles)


def test_contour_and_lookup_at_once(box_bake):
    field, grid = box_bake.volume.field(), box_bake.grid
    vertices, normals, triangles = contour(field, 47.0)
    lit = grid.lit_contour(field, 47.0, normals=True)
    for found, expected in zip(lit, (vertices, normals, triangles)):
        np.testing.assert_array_equal(found, expected)
    # The core looks up radiance before it rounds vertices to single precision.
    radiance = grid.lookup(field, vertices)
    np.testing.assert_allclose(lit[3], radiance, atol=1e-4 * radiance.max())
    assert lit[4] is None
    assert grid.lit_contour(field, 47.0, front=False)[3] is None
    refused("back", grid.lit_contour, field, 47.0, back=True)


def test_both_sides_and_texels_narrower_than_voxels(bump_scene):
    volume = leaflight.bump_box(12)
    settings = {"isovalues": (40, 60), "both_sides": True, "error": 20.0, "resolution": 23}
    bake = leaflight.bake(volume, bump_scene, **settings)
    field, grid = bake.volume.field(), bake.grid
    lit = grid.lit_contour(field, 50.0, back=True)
    assert len(lit[0]) > 3 * len(contour(field, 50.0)[0])
    np.testing.assert_array_equal(lit[3], grid.lookup(field, lit[0]))
    np.testing.assert_array_equal(lit[4], grid.lookup(field, lit[0], back=True))
    assert not np.array_equal(lit[3], lit[4])
    assert _sides_used_twice(lit[2]) == 0 and _coincident(lit[2]) == 0


def _error_between_vertices(bake, mesh):
    """Returns the RMS error of linear interpolation between the vertices."""
    vertices, _, triangles, radiance = mesh[:4]
    facets, coordinates = random_places(vertices, triangles, 5000, seed=1)
    weights = np.column_stack([1 - coordinates.sum(axis=1), coordinates])
    linear = np.einsum("nk,nkc->nc", weights, radiance[triangles[facets]])
    points = positions(vertices, triangles, facets, coordinates)
    return np.sqrt(np.mean((linear - bake.radiance(points)) ** 2))


@pytest.mark.parametrize("sides", [(True, False), (False, True), (True, True)])
def test_small_meshes_are_cut_where_light_steps(bump_scene, sides):
    volume = leaflight.bump_box(24)
    settings = {"isovalues": (40, 60), "error": 5.0, "resolution": 24, "both_sides": True}
    bake = leaflight.bake(volume, bump_scene, **settings)
    field, grid = volume.field(), bake.grid
    wished = {"front": sides[0], "back": sides[1]}
    plain = grid.lit_contour(field, 50.0, **wished)
    step = 0.01 / bake.scene.exposure
    cut = grid.lit_contour(field, 50.0, largest_step=step, **wished)
    assert plain[5] == cut[5] == len(plain[2])
    count = len(plain[0])
    assert 1.1 * count < len(cut[0]) < 16 * count
    np.testing.assert_array_equal(cut[0][:count], plain[0])
    assert _sides_used_twice(cut[2]) == 0 and _coincident(cut[2]) == 0
    for back, light in enumerate(cut[3:5]):
        assert (light is None) == (not sides[back])
        if light is not None:
            expected = grid.lookup(field, cut[0], back=bool(back))
            np.testing.assert_allclose(light, expected, atol=1e-4 * expected.max())
    if sides[0]:
        assert _error_between_vertices(bake, cut) < 0.6 * _error_between_vertices(bake, plain)
    # No difference is that large, so no edge is split.
    as_before = grid.lit_contour(field, 50.0, largest_step=1e9, **wished)
    np.testing.assert_array_equal(as_before[2], plain[2])


def test_arrays_that_are_held_stay_as_they_are(box_bake):
    field, grid = box_bake.volume.field(), box_bake.grid
    held = grid.lit_contour(field, 40.0)[0]
    copy = held.copy()
    for isovalue in (45.0, 50.0):
        grid.lit_contour(field, isovalue)
        contour(field, isovalue)
    np.testing.assert_array_equal(held, copy)


def test_memory_of_a_mesh_that_was_let_go_is_used_again(box_bake):
    field, grid = box_bake.volume.field(), box_bake.grid
    gc.collect()
    places = set()
    for _ in range(5):
        mesh = grid.lit_contour(field, 47.0)
        places.add((mesh[0].ctypes.data, mesh[2].ctypes.data, mesh[3].ctypes.data))
        del mesh
    assert len(places) == 1


def test_lookup_of_any_numbers(box_bake):
    field, grid = box_bake.volume.field(), box_bake.grid
    vertices = contour(field, 47.0)[0][:100]
    radiance = grid.lookup(field, vertices)
    for points in (vertices.astype(np.float64), np.asfortranarray(vertices), vertices.tolist()):
        np.testing.assert_array_equal(grid.lookup(field, points), radiance)
    np.testing.assert_array_equal(grid.lookup(field, vertices[::3]), radiance[::3])
    refused(r"shape \(n, 3\)", grid.lookup, field, vertices[:, :2])
    refused("numbers", grid.lookup, field, "nowhere")
