# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of isosurfaces as Python gets them: with their radiance, without copies, manifolds."""

import gc

import leaflight
import numpy as np
import pytest
from leaflight import LeaflightError
from leaflight._core import contour


def _sides_used_twice(triangles):
    """Sides of triangles that several have in the same direction, of which a manifold has none."""
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
    assert box_bake.grid.contour(field, 47.0, normals=False)[1] is None


def test_contour_and_lookup_at_once(box_bake):
    field, grid = box_bake.volume.field(), box_bake.grid
    vertices, normals, triangles = grid.contour(field, 47.0)
    lit = grid.lit_contour(field, 47.0, normals=True)
    np.testing.assert_array_equal(lit[0], vertices)
    np.testing.assert_array_equal(lit[1], normals)
    np.testing.assert_array_equal(lit[2], triangles)
    # Looked up before vertices are rounded to single precision.
    radiance = grid.lookup(field, vertices)
    np.testing.assert_allclose(lit[3], radiance, atol=1e-4 * radiance.max())
    assert lit[4] is None
    assert grid.lit_contour(field, 47.0, front=False)[3] is None
    with pytest.raises(LeaflightError, match="inner side"):
        grid.lit_contour(field, 47.0, back=True)


def test_both_sides_and_texels_narrower_than_voxels(bump_scene):
    volume = leaflight.bump_box(12)
    bake = leaflight.bake(
        volume,
        bump_scene,
        isovalues=(40, 60),
        both_sides=True,
        samples=2,
        photons=2000,
        resolution=23,
    )
    field, grid = bake.volume.field(), bake.grid
    lit = grid.lit_contour(field, 50.0, back=True)
    assert len(lit[0]) > 3 * len(contour(field, 50.0)[0])
    np.testing.assert_array_equal(lit[3], grid.lookup(field, lit[0]))
    np.testing.assert_array_equal(lit[4], grid.lookup(field, lit[0], back=True))
    assert not np.array_equal(lit[3], lit[4])
    assert _sides_used_twice(lit[2]) == 0 and _coincident(lit[2]) == 0


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
    np.testing.assert_array_equal(grid.lookup(field, vertices.astype(np.float64)), radiance)
    np.testing.assert_array_equal(grid.lookup(field, np.asfortranarray(vertices)), radiance)
    np.testing.assert_array_equal(grid.lookup(field, vertices[::3]), radiance[::3])
    np.testing.assert_array_equal(grid.lookup(field, vertices.tolist()), radiance)
    with pytest.raises(LeaflightError, match=r"shape \(n, 3\)"):
        grid.lookup(field, vertices[:, :2])
    with pytest.raises(LeaflightError, match="numbers"):
        grid.lookup(field, "nowhere")
