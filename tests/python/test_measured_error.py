# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the estimated error of a bake against the true one, on each isosurface of its range."""

import leaflight
import numpy as np
import pytest
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.sides import IsosurfaceSide
from leaflight.measure.truth import errors_of, without

ISOVALUES = (30.0, 70.0)


@pytest.fixture(scope="module")
def box(bump_scene):
    """Returns a coarse volume whose texels miss much detail."""
    return leaflight.bake(leaflight.bump_box(16), bump_scene, isovalues=ISOVALUES)


def found_percent(baked, isovalue):
    """Returns the RMS error of colors against path tracing, without the noise of the paths."""
    side = IsosurfaceSide(baked, isovalue)
    truth = side.path_traced(400, 512, 1, 0, None)
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
    """Checks the ends of the range. Shadows there are interpolated with values outside the
    range.
    """
    assert found_percent(box, isovalue) < 1.6 * found_percent(box, 50.0)


@pytest.mark.slow
def test_corners_are_smooth():
    """Checks that corners have no noise. Half of the rays there hit the adjacent wall, and must not
    all use one of its patches.
    """
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
