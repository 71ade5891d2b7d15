# SPDX-License-Identifier: GPL-3.0-or-later
"""Exploded views: which vertices move, how far, and what is exported."""

import leaflight
import numpy as np
import pytest
from leaflight import Volume
from leaflight._core import connected_parts, contour
from leaflight.volume.exploded import explode_offsets
from leaflight.volume.regions import Apart, HalfSpace
from outcomes import refused
from test_regions import MATRICES, balls, cut

CENTERS = ((-0.6, 0.0, 0.0), (0.0, 0.1, 0.0), (0.65, 0.0, 0.0))


def exploded(volume, isovalue, along):
    """Returns vertices, triangles and offsets."""
    vertices, _, triangles = contour(volume.field(), isovalue)
    return vertices, triangles, explode_offsets(volume, isovalue, vertices, triangles, along)


@pytest.mark.parametrize("matrix", MATRICES.values(), ids=MATRICES)
def test_balls_move_apart_in_proportion(matrix):
    volume = balls(matrix, CENTERS, (0.25, 0.2, 0.25))
    along = matrix[:3, :3] @ [1.0, 0.0, 0.0]
    vertices, triangles, offsets = exploded(volume, 300.0, along)
    assert offsets.dtype == np.float32
    local = (vertices - matrix[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T
    ball = np.digitize(local[:, 0], [-0.3, 0.3])
    # A sheared direction measures places by its own projection.
    middles = [(vertices[ball == k] @ along).mean() for k in range(3)]
    shares = (middles - 0.5 * (middles[0] + middles[2])) / (middles[2] - middles[0])
    np.testing.assert_allclose(offsets, shares[ball, None] * along, atol=1e-5)
    assert np.allclose(offsets[ball == 2] - offsets[ball == 0][0], along, atol=1e-5)


def test_a_cavity_moves_with_the_part_around_it():
    volume = balls(centers=CENTERS[::2], radii=(0.3, 0.3))
    z, y, x = np.meshgrid(*[np.linspace(-1, 1, len(volume.values))] * 3, indexing="ij")
    # A bubble within the first ball, beside its middle.
    bubble = np.sqrt((x + 0.68) ** 2 + y**2 + z**2) < 0.08
    hollow = Volume(np.where(bubble, 0, volume.values), volume.index_to_world)
    vertices, triangles, offsets = exploded(hollow, 200.0, (0.0, 0.0, 0.0) + np.eye(3)[0])
    assert len(np.unique(connected_parts(triangles, len(vertices)))) == 3
    assert len(np.unique(offsets, axis=0)) == 2
    left = vertices[:, 0] < 0
    np.testing.assert_allclose(offsets[left], [[-0.5, 0, 0]] * left.sum())


def test_no_triangle_is_stretched_where_voxels_touch_across_an_edge():
    noise = np.random.default_rng(3).random((20, 20, 20)).astype(np.float32)
    vertices, triangles, offsets = exploded(Volume(noise), 0.72, (0.0, 0.0, 9.0))
    assert len(np.unique(offsets, axis=0)) > 20
    assert (offsets[triangles] == offsets[triangles[:, :1]]).all()


def test_one_part_stays():
    _, _, offsets = exploded(balls(), 300.0, (1.0, 0.0, 0.0))
    assert len(offsets) and not offsets.any()


def test_meshes_are_exported_exploded(bump_scene, tmp_path):
    volume = balls(centers=CENTERS[::2], radii=(0.3, 0.3))
    baked = leaflight.bake(volume, bump_scene, isovalues=(200, 400), resolution=16, error=20.0)
    closed = leaflight.export(baked, tmp_path / "closed.glb", [300.0])[300.0]
    apart = leaflight.export(baked, tmp_path / "apart.glb", [300.0], explode=(2.0, 0, 0))[300.0]
    moved = apart.vertices - closed.vertices
    np.testing.assert_allclose(moved[:, 0], np.sign(closed.vertices[:, 0]), atol=1e-5)
    np.testing.assert_array_equal(apart.radiance, closed.radiance)
    sentence = "leave out the options for single ones"
    refused(sentence, leaflight.export, baked, tmp_path / "all.vti", explode=(2.0, 0, 0))


@pytest.mark.parametrize("matrix", MATRICES.values(), ids=MATRICES)
@pytest.mark.parametrize("dtype", [np.float32, np.uint16])
def test_parts_move_apart_in_the_data(matrix, dtype):
    volume = balls(matrix, CENTERS, (0.25, 0.2, 0.25), dtype)
    along = matrix[:3, :3] @ [1.0, 0.3, 0.0]
    vertices, _, offsets = exploded(volume, 300.0, along)
    moved = cut(volume, Apart(tuple(along), 300.0))
    assert moved.values.dtype == dtype
    found, _, _ = contour(moved.field(), 300.0)
    steps = offsets.astype(np.float64) @ np.linalg.inv(volume.index_to_world)[:3, :3].T
    whole = np.rint(steps) @ volume.index_to_world[:3, :3].T
    # Offsets are by mean vertices there and by mean voxels here.
    size = np.linalg.norm(volume.index_to_world[:3, :3], axis=0).max()
    assert len(found) == len(vertices)
    low, high = found.min(axis=0), found.max(axis=0)
    np.testing.assert_allclose(low, (vertices + whole).min(axis=0), atol=1.01 * size)
    np.testing.assert_allclose(high, (vertices + whole).max(axis=0), atol=1.01 * size)


def test_parts_are_ordered_by_their_places_in_the_world():
    values = np.zeros((20, 8, 40), np.float32)
    values[14, 5, 2], values[5, 5, 16], values[5, 5, 30] = 100, 200, 300
    moved = cut(Volume(values, spacing=(1, 1, 5)), Apart((20.0, 0.0, 20.0), 50.0))
    # Their shares of the direction are 1.8, 1.025 and 1.375.
    places = [np.argwhere(moved.values == value)[0] for value in (200, 300, 100)]
    first, last = places[0], places[2]
    np.testing.assert_array_equal(last - first, [9 + 4, 0, -14 + 20])
    np.testing.assert_array_equal(places[1] - first, [2, 0, 14 + 9])


def test_parts_that_move_keep_their_edges():
    volume = balls(centers=CENTERS[::2], radii=(0.3, 0.3))
    moved = cut(volume, Apart((1.0, 0.0, 0.0), 500.0))
    # The volume grows by the way of its parts, and what they left is empty.
    assert moved.values.shape == (48, 48, 48 + 24)
    assert np.unique(moved.values[:, 24, 36]).tolist() == [0.0]
    kept = contour(volume.field(), 450.0)[0], contour(moved.field(), 450.0)[0]
    assert len(kept[0]) == len(kept[1])


def test_parts_that_cannot_move_apart_are_refused():
    half = HalfSpace((0.0, 0.0, 0.5), (0.0, 0.0, 1.0))
    refused("after a capped cut", cut, balls(), half, Apart((1.0, 0.0, 0.0), 300.0))
    refused("shorter distance", cut, balls(), Apart((50.0, 0.0, 0.0), 300.0))
    refused("must not be 0", cut, balls(), Apart((0.0, 0.0, 0.0), 300.0))
