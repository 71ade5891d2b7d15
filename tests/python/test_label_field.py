# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the smooth boundary of labels, their colors on it, and lobes of both signs."""

import leaflight
import numpy as np
import pytest
from leaflight import Volume, _core, read_volume
from leaflight.io.scene_file import cornell_box
from leaflight.scene.volume_texture import label_texture, sign_texture
from leaflight.volume import label_field as boundary
from leaflight.volume.label_field import has_lobes, unsigned, without_sign
from outcomes import refused

N = 40
Z, Y, X = np.mgrid[:N, :N, :N] - 0.5 * (N - 1) + 0.13


def label_field(labels):
    return boundary.label_field(labels, _core.Progress())


def ball(radius):
    return X**2 + Y**2 + Z**2 < radius**2


SHAPES = {
    "small ball": ball(2.5),
    "ball": ball(8.0),
    "large ball": ball(15.0),
    "cube": (abs(X) < 5) & (abs(Y) < 5) & (abs(Z) < 5),
    "plate of one voxel": (abs(X) < 12) & (abs(Y) < 12) & (np.abs(Z - 0.4) < 0.5),
    "at the border": X < -10.0,
}


def contour(field):
    """Returns vertices and triangles of the boundary, which the border of the volume closes."""
    closed = np.pad(field, 1)
    vertices, _, triangles = _core.contour(_core.Field(closed, np.eye(4)), 0.5)
    return vertices - 1.0, triangles


def corners_of(field):
    vertices, triangles = contour(field)
    return np.moveaxis(vertices[triangles].astype(np.float64), 1, 0)


@pytest.mark.parametrize("name", SHAPES)
def test_the_volume_is_that_of_the_voxels(name):
    inside = SHAPES[name]
    a, b, c = corners_of(label_field(inside.astype(np.uint8)))
    volume = abs(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
    assert abs(volume / inside.sum() - 1.0) < 0.01


@pytest.mark.parametrize("name", SHAPES)
def test_the_boundary_stays_between_the_same_voxels(name):
    inside = SHAPES[name]
    np.testing.assert_array_equal(label_field(inside.astype(np.int16)) > 0.5, inside)


def test_the_boundary_is_smooth():
    """Checks the area of a ball; the stairs of its voxels have 8 % more."""
    for radius in (8.0, 15.0):
        a, b, c = corners_of(label_field(ball(radius).astype(np.uint8)))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
        assert abs(area / (4.0 * np.pi * radius**2) - 1.0) < 0.02


def test_the_boundary_has_the_color_of_the_label_within():
    labels = np.zeros((N, N, N), np.uint8)
    labels[ball(12.0)] = 3
    labels[ball(12.0) & (X > 0)] = 7
    texture = label_texture(Volume(labels, name="two"))
    vertices, _ = contour(label_field(labels))
    colors = texture.at(vertices)
    expected = dict(texture.colors)
    middle = 0.5 * (N - 1) - 0.13
    for side, number in ((vertices[:, 0] < middle - 1, 3.0), (vertices[:, 0] > middle + 1, 7.0)):
        np.testing.assert_allclose(colors[side], np.tile(expected[number], (side.sum(), 1)), 1e-5)


def test_a_file_of_labels_is_read_as_their_boundary(tmp_path):
    np.save(tmp_path / "labels.npy", 5 * ball(8.0).astype(np.uint8))
    volume = read_volume(tmp_path / "labels.npy", field="labels")
    assert volume.values.dtype == np.float32 and 0.0 <= volume.values.min() < 0.4
    refused("choose one of absolute, labels", read_volume, tmp_path / "labels.npy", field="both")


def test_missing_values_are_no_labels_and_others_are_refused(tmp_path):
    np.save(tmp_path / "none.npy", np.zeros((4, 4, 4), np.uint8))
    refused("no labels above 0", read_volume, tmp_path / "none.npy", field="labels")
    holes = np.where(ball(8.0), np.float32(2.0), np.float32(np.nan))
    assert [number for number, _ in label_texture(Volume(holes)).colors] == [0.0, 2.0]
    halves = leaflight.Volume(np.linspace(0.0, 1.0, 64, dtype=np.float32).reshape(4, 4, 4))
    refused("not whole numbers", label_texture, halves)


def sampled(function, nodes=28):
    """Returns a Volume of function(x, y, z) over the box from -1 to 1."""
    axis = np.linspace(-1.0, 1.0, nodes)
    values = function(axis[None, None, :], axis[None, :, None], axis[:, None, None])
    return Volume(values.astype(np.float32), spacing=2.0 / (nodes - 1), origin=-1.0)


def p_orbital(x, y, z):
    return z * np.exp(-6.0 * np.sqrt(x * x + y * y + z * z))


def noisy_density(x, y, z):
    noise = np.random.default_rng(1).normal(0.0, 0.02, np.broadcast(x, y, z).shape)
    return np.exp(-6.0 * (x * x + y * y + z * z)) + noise


VOLUMES = {
    "p orbital": (p_orbital, True),
    "two charges": (lambda x, y, z: p_orbital(x, y, z - 0.4) - p_orbital(x, y, z + 0.4), True),
    "noisy density": (noisy_density, False),
    "level set": (lambda x, y, z: np.sqrt(x * x + y * y + z * z) - 0.6, False),
    "CT": (lambda x, y, z: np.where(x * x + y * y + z * z < 0.4, 60.0, -1000.0), False),
    "wave": (lambda x, y, z: np.sin(5.0 * x) * np.sin(5.0 * y) * np.sin(5.0 * z), False),
}


@pytest.mark.parametrize("name", VOLUMES)
def test_lobes_are_told_from_other_values_of_both_signs(name):
    function, expected = VOLUMES[name]
    assert has_lobes(sampled(function)) == expected


def test_the_lowest_integer_has_an_absolute_value():
    values = unsigned(np.array([-32768, -1, 0, 32767], np.int16))
    np.testing.assert_array_equal(values, [32768, 1, 0, 32767])
    assert unsigned(np.arange(3, dtype=np.uint8)).dtype == np.uint8


def test_a_file_is_read_without_sign(tmp_path):
    volume = sampled(p_orbital, 9)
    np.save(tmp_path / "p.npy", volume.values)
    read = read_volume(tmp_path / "p.npy", field="absolute")
    np.testing.assert_array_equal(read.values, np.abs(volume.values))
    assert (read_volume(tmp_path / "p.npy").values < 0).any()


def test_both_lobes_are_lit_in_their_colors():
    """Checks means of each lobe against the path tracer."""
    volume = sampled(p_orbital)
    scene = cornell_box().colored_by(sign_texture(volume))
    bake = leaflight.bake(without_sign(volume), scene, error=2.0, resolution=28, progress=False)
    isovalue = 0.3 * float(volume.values.max())
    points = bake.surface(isovalue).vertices
    radiance = bake.radiance(points)
    above, below = points[:, 2] > 0.05, points[:, 2] < -0.05
    assert radiance[above, 0].mean() > 2.0 * radiance[above, 2].mean()
    assert radiance[below, 2].mean() > 1.2 * radiance[below, 0].mean()
    for lobe in (above, below):
        truth, _ = bake.reference(points[lobe][::8], isovalue, spp=256)
        found = radiance[lobe][::8].mean(axis=0)
        np.testing.assert_allclose(found, truth.mean(axis=0), rtol=0.04, atol=0.004)
