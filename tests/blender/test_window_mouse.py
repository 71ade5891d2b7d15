# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the mouse and keys in a window: Shift+D of a volume with an added isosurface, dragging a
lamp with Live, and dragging the isovalue in the histogram over the viewport.
"""

import pytest

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def duplicated(blender, ball):
    return blender.in_window("duplicate.py", ball)


def test_the_duplicate_has_an_isosurface_of_its_own(duplicated):
    assert duplicated["moved"] and duplicated["duplicated"] == [[[70.0, 0.5]], [[70.0, 0.5]]]
    assert sorted(duplicated["edited"]) == [[[70.0, 0.5]], [[80.0, 0.5]]]


def test_undo_and_redo_bring_it_along(duplicated):
    assert duplicated["undone"] == duplicated["redone"] == duplicated["duplicated"]
    assert duplicated["undone twice"] == [[[70.0, 0.5]]]


@pytest.fixture(scope="module")
def live(blender, ball, tmp_path_factory):
    return blender.in_window("drag_lamp.py", ball, tmp_path_factory.mktemp("live"))


def test_direct_light_follows_the_hand(live):
    assert live["drag"]["moved"] > 0.5
    assert live["drag"]["direct"] >= 2
    assert live["drag"]["triangles"] < live["triangles"]


def test_esc_ends_it_and_it_stays(live):
    assert live["stopped"]["stays"]
    if live["stopped"]["was at work"]:
        assert "earlier position" in live["stopped"]["sentence"]


def test_it_is_final_again_without_a_click(live):
    assert live["final"]
    assert live["seconds"]["direct"] < live["seconds"]["final"]
    assert live["final triangles"] > live["drag"]["triangles"]


@pytest.fixture(scope="module")
def picked(blender, ball):
    return blender.in_window("pick_isovalue.py", ball)


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
