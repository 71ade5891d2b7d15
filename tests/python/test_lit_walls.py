# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls lit by passes, where they meet."""

import leaflight
import numpy as np
import pytest
from leaflight.io.scene_file import packaged_scene


@pytest.mark.slow
def test_corners_are_smooth():
    """Half of the rays from there hit a wall next to them, and must not all show its one patch."""
    box = leaflight.bump_box(24)
    bake = leaflight.bake(
        box, packaged_scene("open_floor.json"), isovalues=(30, 70), error=3.0, walls=True
    )
    vertices, _ = bake.walls.mesh(1)
    radiance = bake.walls.radiance(1, 47.0).mean(axis=1)
    corner = vertices[:, 2] < vertices[:, 2].min() + 1e-4
    along = radiance[corner][np.argsort(vertices[corner, 0])]
    assert len(along) > 30
    # Light changes slowly along the corner, so what a line through the neighbors leaves is noise.
    steps = along[1:-1] - 0.5 * (along[:-2] + along[2:])
    share = np.abs(steps) / along[1:-1]
    assert np.sqrt(np.mean(share**2)) < 0.02 and share.max() < 0.06
