# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that the error bars of texels are right: 95 % intervals contain the truth that often."""

import leaflight
import numpy as np
import pytest
from leaflight.volume.particles import neuron, nucleons

SEEDS = 3
# Number of standard errors that contain 95 % of a normal distribution.
QUANTILE = 1.959963984540054
# Allowed deviation of a count of independent texels, in standard errors.
ALLOWANCE = 4.0


@pytest.fixture
def volumes(bump_scene):
    return {
        "bump box": (leaflight.bump_box(20), bump_scene, None),
        "neuron": (neuron(28), None, (20.0, 200.0)),
        "nucleons": (nucleons(24)[0], None, (20.0, 170.0)),
    }


def deviations_over_errors(volume, scene, **settings):
    """Returns the deviation of each seed and lit texel from the mean of the others, over the
    reported error of the texel.
    """
    values, errors = [], []
    for seed in range(1000, 1000 + SEEDS):
        grid = leaflight.thesis.bake(volume, scene, seed=seed, **settings).grid
        active = grid.mask().astype(bool)
        values.append(grid.dense("radiance")[active].mean(axis=-1, dtype=np.float64))
        errors.append(np.float64(grid.dense("radiance_error")[active]))
    # Texels that are dark with all seeds have no error and no interval.
    lit = np.any(values, axis=0)
    values, errors = np.array(values)[:, lit], np.array(errors)[:, lit]
    # The mean of the others has the error of a bake over sqrt(SEEDS - 1).
    deviations = (values - values.mean(axis=0)) * np.sqrt(SEEDS / (SEEDS - 1))
    z = np.divide(deviations, errors, out=np.full_like(errors, np.inf), where=errors > 0)
    z[deviations == 0] = 0
    return np.abs(z)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, estimator",
    [
        ("bump box", "gather"),
        ("neuron", "gather"),
        ("nucleons", "gather"),
        ("nucleons", "volumetric"),
        ("nucleons", "path"),
    ],
)
def test_intervals_hold(volumes, name, estimator):
    volume, scene, isovalues = volumes[name]
    settings = {"estimator": estimator, "photons": 100_000, "isovalues": isovalues}
    z = deviations_over_errors(volume, scene, **settings)
    assert z.size > 3000
    allowance = ALLOWANCE * np.sqrt(0.05 * 0.95 / z.size)
    assert 0.93 - allowance <= (z <= QUANTILE).mean() <= 0.97 + allowance
    # The intervals must not be too wide: half of them contain 67 % of a normal distribution.
    assert 0.6 < (z <= QUANTILE / 2).mean() < 0.8


def test_no_texel_is_sure_to_be_dark(volumes):
    """Checks the last texels of an isovalue range, which have few samples, if any. They take light
    of their neighbors.
    """
    volume, scene, isovalues = volumes["nucleons"]
    grid = leaflight.thesis.bake(volume, scene, isovalues=isovalues, photons=10_000, samples=8).grid
    active = grid.mask().astype(bool)
    assert (grid.dense("radiance_error")[active] == 0).mean() < 0.001


def test_estimated_error_of_the_bake(bump_scene):
    """Checks that it falls with samples as expected, and equals the difference between two
    seeds.
    """
    few, more = (
        leaflight.thesis.bake(leaflight.bump_box(20), bump_scene, photons=100_000, samples=samples)
        for samples in (8, 128)
    )
    estimated = few.statistics.estimated_rms_percent
    assert 0 < more.statistics.estimated_rms_percent < estimated / 3
    active = few.grid.mask().astype(bool)
    colors = [
        np.clip(one.grid.dense("radiance")[active] * bump_scene.exposure, 0, 1)
        for one in (few, more)
    ]
    true = 100 * np.sqrt(np.square(colors[0] - colors[1]).mean())
    assert true / 2 < estimated < 2 * true
