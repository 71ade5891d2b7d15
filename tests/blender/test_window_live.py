# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests Live in a window: a lamp is dragged with the mouse, and the light follows.

Needs a Blender with a window and xvfb-run, which provides a screen.
"""

from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parent / "window" / "drag_lamp.py"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found(blender, ball, tmp_path_factory):
    return blender.in_window(SCRIPT, ball, tmp_path_factory.mktemp("live"))


def test_direct_light_follows_the_hand(found):
    assert found["drag"]["moved"] > 0.5
    assert found["drag"]["direct"] >= 2
    assert found["drag"]["triangles"] < found["triangles"]


def test_esc_ends_it_and_it_stays(found):
    assert found["stopped"]["stays"]
    if found["stopped"]["was at work"]:
        assert "earlier position" in found["stopped"]["sentence"]


def test_it_is_final_again_without_a_click(found):
    assert found["final"]
    assert found["seconds"]["direct"] < found["seconds"]["final"]
    assert found["final triangles"] > found["drag"]["triangles"]
