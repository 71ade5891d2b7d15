# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the light of walls near corners."""

import leaflight
import numpy as np
import pytest
from leaflight.io.scene_file import packaged_scene


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
