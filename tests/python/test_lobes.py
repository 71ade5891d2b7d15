# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests volumes with lobes of both signs, shown together in two colors."""

import leaflight
import numpy as np
import pytest
from leaflight import Volume, read_volume
from leaflight.io.scene_file import cornell_box
from leaflight.scene.volume_texture import sign_texture
from leaflight.volume.lobes import has_lobes, unsigned, without_sign


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
