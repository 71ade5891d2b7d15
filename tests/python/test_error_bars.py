# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that error bars contain the truth as often as they claim, and the errors of bakes."""

import leaflight
import numpy as np
import pytest
from leaflight.bake import color_error
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.sampling import Sampling
from leaflight.measure.sides import IsosurfaceSide
from leaflight.measure.truth import errors_of, without
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


def deviations_over_errors(bake, volume, scene, **settings):
    """Returns how far each seed and lit texel is from the mean of the others, over its error."""
    values, errors = [], []
    for seed in range(1000, 1000 + SEEDS):
        grid = bake(volume, scene, seed=seed, **settings).grid
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
def test_intervals_hold(thesis, volumes, name, estimator):
    volume, scene, isovalues = volumes[name]
    settings = {"estimator": estimator, "photons": 100_000, "isovalues": isovalues}
    z = deviations_over_errors(thesis.bake, volume, scene, **settings)
    assert z.size > 3000
    allowance = ALLOWANCE * np.sqrt(0.05 * 0.95 / z.size)
    assert 0.93 - allowance <= (z <= QUANTILE).mean() <= 0.97 + allowance
    # The intervals must not be too wide: half of them contain 67 % of a normal distribution.
    assert 0.6 < (z <= QUANTILE / 2).mean() < 0.8


def test_no_texel_is_sure_to_be_dark(thesis, volumes):
    """Checks the last texels of an isovalue range, which take light of their neighbors."""
    volume, scene, isovalues = volumes["nucleons"]
    grid = thesis.bake(volume, scene, isovalues=isovalues, photons=10_000, samples=8).grid
    active = grid.mask().astype(bool)
    assert (grid.dense("radiance_error")[active] == 0).mean() < 0.001


def test_estimated_error_of_the_bake(thesis, bump_scene):
    """Checks that it falls with samples, and equals the difference between two seeds."""
    few, more = (
        thesis.bake(leaflight.bump_box(20), bump_scene, photons=100_000, samples=samples)
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


def test_noise_of_some_texels_stands_for_all(bump_scene, monkeypatch):
    grid = leaflight.bake(leaflight.bump_box(20), bump_scene).grid
    active = grid.mask().astype(bool)
    radiance, error = grid.dense("radiance")[active], grid.dense("radiance_error")[active]
    every, fifth = grid.some_texels(grid.texels), grid.some_texels(grid.texels // 5)
    np.testing.assert_array_equal(every[0], radiance)
    np.testing.assert_array_equal(every[1], error)
    chosen = np.arange(grid.texels // 5) * grid.texels // (grid.texels // 5)
    np.testing.assert_array_equal(fifth[0], radiance[chosen])
    all_texels = color_error.estimated_rms_percent([grid], 1.0)
    monkeypatch.setattr(color_error, "_MOST_TEXELS", grid.texels // 5)
    assert color_error.estimated_rms_percent([grid], 1.0) == pytest.approx(all_texels, rel=0.03)


ISOVALUES = (30.0, 70.0)


@pytest.fixture(scope="module")
def box(bump_scene):
    """Returns a coarse volume whose texels miss much detail."""
    return leaflight.bake(leaflight.bump_box(16), bump_scene, isovalues=ISOVALUES)


def found_percent(baked, isovalue):
    """Returns the RMS error of colors against path tracing, without the noise of the paths."""
    side = IsosurfaceSide(baked, isovalue)
    truth = side.path_traced(Sampling(400, 512, 1), None)
    errors = errors_of(side.baked(truth.points), truth, baked.scene.exposure)
    return without(errors["rms_percent"], errors["reference_noise_percent"])


def test_a_bake_errs_as_much_as_it_says(box):
    low, high = ISOVALUES
    isovalues = low + (high - low) * (np.arange(16) + 0.5) / 16
    areas = [IsosurfaceSide(box, c).triangles for c in isovalues]
    squares = [found_percent(box, c) ** 2 for c in isovalues]
    found = np.sqrt(np.average(squares, weights=areas))
    assert found / 1.6 < box.statistics.estimated_error_percent < 1.6 * found


@pytest.mark.parametrize("isovalue", [30.02, 69.98])
def test_isosurfaces_at_the_ends_of_the_range_are_lit_like_others(box, isovalue):
    """Checks the ends of the range, where shadows are interpolated with values outside it."""
    assert found_percent(box, isovalue) < 1.6 * found_percent(box, 50.0)


@pytest.mark.slow
def test_corners_are_smooth():
    """Checks that corners have no noise, although half of the rays hit the adjacent wall."""
    box = leaflight.bump_box(24)
    bake = leaflight.bake(
        box, packaged_scene("open_floor.json"), isovalues=(30, 70), error=3.0, walls=True
    )
    vertices, _ = bake.walls.mesh(1)
    radiance = bake.walls.radiance(1, 47.0).mean(axis=1)
    corner = vertices[:, 2] < vertices[:, 2].min() + 1e-4
    along = radiance[corner][np.argsort(vertices[corner, 0])]
    assert len(along) > 30
    # Light changes slowly along a corner, so deviations from a line through the neighbors are
    # noise.
    steps = along[1:-1] - 0.5 * (along[:-2] + along[2:])
    share = np.abs(steps) / along[1:-1]
    assert np.sqrt(np.mean(share**2)) < 0.02 and share.max() < 0.06
