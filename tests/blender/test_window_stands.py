# SPDX-License-Identifier: GPL-3.0-or-later
"""A real window: an isovalue goes among noise, which has many times the triangles.

Runs where there is a Blender with a window and xvfb-run, which gives it a screen.
"""

from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parent / "window" / "stands.py"

pytestmark = pytest.mark.slow

# While an isovalue moves (show/surface_object.py).
MOVING_TRIANGLES = 150_000


def test_noise_is_coarse_at_first(blender, tmp_path):
    found = blender.in_window(SCRIPT, tmp_path, size=(900, 640))
    assert found["among noise"]["at first"] <= MOVING_TRIANGLES
