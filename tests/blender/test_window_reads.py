# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests a .blend in a window, whose bake or volume takes long to read.

The window keeps working, and shows everything once the file is read.
"""

import pytest

pytestmark = pytest.mark.slow

# Isovalues in the saved file, and after a drag while the file is read (window/reads.py).
SAVED, DRAGGED = 50.0, 60.0
LIT = {"isovalue": DRAGGED, "lit": True, "problems": []}


@pytest.fixture(scope="module")
def found(blender, tmp_path_factory):
    return blender.in_window("reads.py", tmp_path_factory.mktemp("reads"), size=(900, 640))


def _part(row, keys):
    return {key: row[key] for key in keys}


def test_the_isovalue_moves_before_its_light_is_read(found):
    """Checks that isosurface, walls and histogram follow the isovalue before the light is read."""
    row = found["dragged"]
    held = row["held"]
    assert held["reads"] == ["thread"] and held["sidebar"]
    assert held["asked"] == DRAGGED and held["isovalue"] == SAVED and not held["problems"]
    assert not held["distribution"] and held["walls"][1] == 0 < held["walls"][0]
    assert held["status"][0].endswith(" % Reading the bake") and row["status"] == [None]
    assert _part(row, LIT) == LIT and row["walls"][1] == row["walls"][0] == held["walls"][0]


def test_a_volume_before_its_bake_is_read_in_a_thread(found):
    row = found["unlit"]
    assert row["held"]["reads"] == ["thread"] and row["held"]["isovalue"] == SAVED
    assert row["held"]["status"][0].endswith(" % Reading the volume") and row["status"] == [None]
    assert row["isovalue"] == DRAGGED and not row["lit"] and not row["problems"]


@pytest.mark.parametrize("button", ["add", "box", "bake", "continue"])
def test_a_button_says_that_a_file_is_still_read(found, button):
    row = found["pressed"]
    answer = row["answers"][button]
    assert "is still being read: wait" in answer and answer.count("\n") <= 1
    assert row["held"]["isovalue"] == SAVED and not row["held"]["problems"]


def test_an_export_and_a_script_wait(found):
    row = found["pressed"]
    assert row["held"]["at work"] and not row["held"]["exported"]
    assert row["exported"] and row["added"] == 1


def test_live_begins_once_the_bake_is_read(found):
    row = found["live"]
    assert row["held"] == {"live": False, "sentence": ""}
    assert row["begun"] == {"live": True, "sentence": ""}


def test_a_picture_waits_and_has_all_light(found):
    row = found["rendered"]
    assert not row["held"]
    (picture,) = row["pictures"]
    assert _part(picture, LIT) == LIT and not picture["coarse"]
    assert picture["walls"][1] == picture["walls"][0] > 0
    assert _part(row, LIT) == LIT


def test_a_volume_that_was_deleted_meanwhile_comes_back_lit(found):
    row = found["deleted"]
    assert row["volumes"] == [0, 0, 1] and _part(row, LIT) == LIT


def test_opening_another_file_ends_the_reading(found):
    row = found["left"]
    assert not row["opened"] and row["status"] == [None] and not row["problems"]


def test_what_cannot_be_read_is_read_but_once(found):
    """Checks a bake that cannot be read, and then a volume, whose isosurface is shown unlit."""
    for row, why in zip(found["damaged"], ("The file is damaged.", "a bug in Leaflight ended")):
        (problem,) = row["problems"]
        assert why in problem and row["reads"] == ["thread", "thread"]
        assert row["isovalue"] == DRAGGED and not row["lit"]
