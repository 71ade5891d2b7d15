# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests dragging the isovalue in the histogram over the viewport.

Needs a Blender with a window and xvfb-run, which provides a screen.
"""

from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parent / "window" / "pick_isovalue.py"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def picked(blender, ball):
    return blender.in_window(SCRIPT, ball)


def test_a_drag_moves_the_isovalue_and_enter_keeps_it(picked):
    assert picked["imported"] != picked["dragged, kept"] == picked["kept"]
    # It must be right of the middle of the range, 13.4 to 100, and within it.
    assert 56.7 < picked["kept"] < 100
    assert picked["dragged, taken back"] < 56.7


def test_esc_brings_back_the_isovalue_before(picked):
    assert picked["taken back"] == pytest.approx(picked["kept"])


def test_the_histogram_is_drawn_and_goes(picked):
    assert picked["drawn"] > 200 and picked["gone"] < 20
    assert picked["left over, kept"] == picked["left over, taken back"] == 0
