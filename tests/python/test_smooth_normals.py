# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests smoothed normals, which do not move the isosurfaces."""

import leaflight
import leaflight._core as _core
import numpy as np
import pytest
from leaflight.scene.lights import SunLight
from leaflight.scene.scene import Isosurfaces, SceneDescription
from outcomes import refused
from scipy.ndimage import gaussian_filter

SIGMA = 1.3
SETTINGS = {"isovalues": (80.5, 150.5), "resolution": 20, "error": 20.0}


@pytest.fixture(scope="module")
def values():
    """Returns a noisy ball of bytes, cut in the middle."""
    z, y, x = (np.mgrid[:30, :30, :30] - 14.5) / 14.5
    ball = 200 - 130 * np.sqrt(x * x + y * y + z * z)
    ball += np.random.default_rng(8).normal(0, 6, ball.shape)
    return np.uint8(ball.clip(0, 255))[:17].copy()


def smooth(values):
    return gaussian_filter(values.astype(np.float64), SIGMA, mode="nearest", truncate=3.0)


def expected_normals(values, vertices):
    """Returns normals by central differences at voxels (x, y, z), interpolated."""
    gradients = np.stack(np.gradient(values)[::-1], axis=-1)
    at = np.minimum(vertices.astype(int), np.array(values.shape[::-1]) - 2)
    local = vertices - at
    total = np.zeros_like(vertices)
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, local, 1 - local), axis=1, keepdims=True)
        x, y, z = (at + corner).T
        total -= weight * gradients[z, y, x]
    return total / np.linalg.norm(total, axis=1, keepdims=True)


def test_isosurfaces_stay_and_their_normals_are_smooth(values, tmp_path):
    np.save(tmp_path / "ball.npy", values)
    sharp = leaflight.read_volume(tmp_path / "ball.npy")
    volume = leaflight.read_volume(tmp_path / "ball.npy", smooth_normals=SIGMA)
    assert volume.values.dtype == np.uint8
    np.testing.assert_array_equal(volume.values, sharp.values)
    assert volume.source.endswith(f"ball.npy, normals smoothed by {SIGMA} voxels")
    vertices, normals, triangles = _core.contour(volume.field(), 110.5)[:3]
    sharp_vertices, sharp_normals, sharp_triangles = _core.contour(sharp.field(), 110.5)[:3]
    np.testing.assert_array_equal(triangles, sharp_triangles)
    np.testing.assert_array_equal(vertices, sharp_vertices)
    assert np.abs(normals - expected_normals(smooth(values), vertices)).max() < 1e-3
    assert np.abs(sharp_normals - expected_normals(values.astype(float), vertices)).max() < 1e-3
    out = (vertices - 14.5) / np.linalg.norm(vertices - 14.5, axis=1, keepdims=True)
    assert (normals * out).sum(axis=1).min() > 0.9 > (sharp_normals * out).sum(axis=1).min()


def test_caps_are_no_part_of_what_is_smoothed(values):
    plain = leaflight.Volume(values, smooth_normals=SIGMA)
    capped = plain.capped()
    assert capped.layers == 1 and capped.smooth_normals == SIGMA
    vertices, normals, _ = _core.contour(capped.field(), 110.5)[:3]
    # Select vertices on the ball, one voxel from the cut. Their differences use the cut's layer as
    # usual.
    beside = np.flatnonzero((vertices[:, 2] > 14) & (vertices[:, 2] <= 15))
    beside = beside[np.hypot(*(vertices[beside, :2] - 14.5).T) > 5]
    expected = expected_normals(smooth(values), vertices[beside])
    assert len(beside) > 50 and np.abs(normals[beside] - expected).max() < 1e-3


def test_a_bake_has_them_in_its_light_and_its_file(values, tmp_path):
    volume = leaflight.Volume(values, smooth_normals=SIGMA)
    bake = leaflight.bake(volume, **SETTINGS)
    sharp = leaflight.bake(leaflight.Volume(values), **SETTINGS)
    assert bake.id != sharp.id
    surface = bake.surface(110.5)
    light, other = surface.radiance, sharp.surface(110.5).radiance
    assert np.std(light) < 0.8 * np.std(other)
    bake.save(tmp_path / "bake.vdb")
    again = leaflight.load_bake(tmp_path / "bake.vdb")
    assert again.id == bake.id and again.volumes[0].smooth_normals == SIGMA
    # Files store half precision.
    np.testing.assert_allclose(again.radiance(surface.vertices), light, rtol=1e-3)


def test_light_does_not_see_the_stairs_of_masks():
    """Checks that a tilted half space of zeros and ones under a sun is as bright as a plane."""
    z, y, x = np.mgrid[:24, :24, :24]
    mask = np.uint8(3 * (z - 12) + (x - 12) < 0)
    # The sun does not reach the vertical sides of the stairs.
    sun = SunLight("sun", (2**-0.5, 0.0, -(2**-0.5)), (1.0, 1.0, 1.0))
    scene = SceneDescription("stairs", [Isosurfaces("stairs", (0.5, 0.5, 0.5))], 1.0, [], [sun])
    volume = leaflight.Volume(mask, smooth_normals=3.0)
    surface = leaflight.bake(volume, scene, isovalues=(0.4, 0.6), resolution=24).surface(0.5)
    is_inside = np.all(np.abs(surface.vertices[:, :2] - 11.5) < 6, axis=1)
    light = surface.radiance[is_inside].mean(axis=1)
    plane = 0.5 / np.pi * 2 / 20**0.5
    # Some shadows between the stairs remain.
    assert len(light) > 300 and np.mean(light < 0.9 * plane) < 0.1
    # Few lines light single texels, since few values of a mask lie between zero and one.
    assert np.quantile(light, 0.99) < 1.07 * plane


def test_coarser_volumes_have_as_smooth_ones(values):
    coarser = leaflight.Volume(values, smooth_normals=2.0).coarser()
    assert coarser.smooth_normals == 1.0


def test_flatland():
    z, x = np.mgrid[:20, :20]
    volume = leaflight.Volume(np.float32(x * x + z), smooth_normals=1.0)
    flat = leaflight.Volume(np.float32(x * x + z))
    assert volume.field().range == flat.field().range


def test_refused():
    refused("smooth_normals", leaflight.Volume, np.zeros((2, 2, 2)), smooth_normals=11.0)
