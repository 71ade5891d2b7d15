# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the generated particle volumes."""

from math import factorial

import numpy as np
import pytest
from leaflight.io.sources import GENERATED, is_generated, open_volume
from leaflight.volume.particles import HYDROGEN_REACH, hydrogen, lapr, neuron, nucleons
from outcomes import refused


@pytest.mark.parametrize("generate, thesis", [(nucleons, 101), (lapr, 120)])
def test_two_volumes_in_one_box(generate, thesis):
    volumes = generate()
    assert len(volumes) == 2
    for volume in volumes:
        assert volume.values.shape == (thesis,) * 3 and volume.values.dtype == np.float32
        assert volume.values.min() >= 0 and volume.values.max() == 255
        np.testing.assert_allclose(volume.field().bounds, [[0, 0, 0], [1, 1, 1]], atol=1e-12)
        # At the border, values must be below the thesis's isovalues, which start at 24.
        for axis in range(3):
            for end in (0, -1):
                assert volume.values.take(end, axis=axis).max() < 24
        for isovalue in (24, 79, 170):
            assert 0 < (volume.values > isovalue).mean() < 0.25


@pytest.mark.parametrize("generate", [nucleons, lapr])
def test_the_nodes_sample_one_density(generate):
    """Checks that resolutions share their particles: 2 n - 1 nodes contain those of n."""
    for coarse, fine in zip(generate(17), generate(33)):
        # Each volume is scaled by its own maximum.
        ratio = fine.values[::2, ::2, ::2].sum() / coarse.values.sum()
        near = fine.values[::2, ::2, ::2]
        np.testing.assert_allclose(near, ratio * coarse.values, atol=0.01, rtol=1e-3)


def test_neuron():
    """Checks that dendrites are thin, and reach far without touching the border."""
    values = neuron(60).values
    assert values.shape == (60,) * 3 and values.max() == 255
    branches = values > 30
    assert 0.002 < branches.mean() < 0.02 and (values < 1).mean() > 0.9
    for axis in range(3):
        extent = np.flatnonzero(branches.any(axis=tuple({0, 1, 2} - {axis})))
        assert extent[0] > 0 and extent[-1] < 59 and len(extent) > 25


def test_hydrogen():
    """Checks the total of one electron, and its mean distance (3 n^2 - l (l + 1)) / 2."""
    values = np.float64(hydrogen(81).values)
    assert values.max() == pytest.approx(1, abs=0.01) and values.min() >= 0
    x = np.linspace(-HYDROGEN_REACH, HYDROGEN_REACH, 81)
    z, y, x = np.meshgrid(x, x, x, indexing="ij")
    r = np.sqrt(x**2 + y**2 + z**2)
    # The maximum density, times the volume of a voxel in Bohr radii.
    highest = (2 * 36 * np.exp(-2) / 81) ** 2 / (6 * np.pi)
    electrons = values * highest * (HYDROGEN_REACH / 40) ** 3
    # Compute the share within the ball inscribed in the box: integrals of r^6 exp(-2 r / 3).
    x = 2 * HYDROGEN_REACH / 3
    within = 1 - np.exp(-x) * sum(x**k / factorial(k) for k in range(7))
    assert electrons[r < HYDROGEN_REACH].sum() == pytest.approx(within, abs=1e-3)
    assert (electrons * r).sum() / electrons.sum() == pytest.approx(10.5, rel=0.02)
    # The density is 0 on the cone between lobes and ring, and the ring has a quarter of the lobes'
    # maximum.
    assert values[np.abs(3 * z**2 - r**2) < 1e-9].max() == 0
    assert values[40].max() == pytest.approx(0.25, abs=0.005)
    assert max(values.take(0, axis=axis).max() for axis in range(3)) < 0.02


def test_same_every_time():
    np.testing.assert_array_equal(lapr(9)[1].values, lapr(9)[1].values)


def test_names():
    particles = {"nucleons:0", "nucleons:1", "lapr:0", "lapr:1", "neuron", "hydrogen"}
    assert set(GENERATED) == {"bump_box", *particles}
    for name in GENERATED:
        volume = open_volume(name, dims=[8])
        assert volume.source == name and volume.values.shape == (8, 8, 8)
    assert not is_generated("nucleons")


@pytest.mark.parametrize("name", GENERATED)
def test_bad_options(name):
    refused(f"{name[:4]}.*: .* nodes per side", open_volume, name, dims=[1])
    for size in ([8, 8, 8], [2.5]):
        refused(f"{name}: the size is not one whole number", open_volume, name, dims=size)
    refused(f"{name}: the option frame does not apply", open_volume, name, frame=1)
