# SPDX-License-Identifier: GPL-3.0-or-later
"""A real window: an isovalue goes among noise, which has many times the triangles; a clip box cuts
when a file has just been opened.

Runs where there is a Blender with a window and xvfb-run, which gives it a screen.
"""

from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parent / "window" / "stands.py"

pytestmark = pytest.mark.slow

# While an isovalue moves (show/surface_object.py).
MOVING_TRIANGLES = 150_000


@pytest.fixture(scope="module")
def found(blender, tmp_path_factory):
    return blender.in_window(SCRIPT, tmp_path_factory.mktemp("stands"), size=(900, 640))


def test_the_window_does_not_wait_for_the_light_of_walls(found):
    assert found["beside walls"] and found["walls"]


def test_noise_is_coarse_at_first(found):
    assert found["among noise"]["at first"] <= MOVING_TRIANGLES
