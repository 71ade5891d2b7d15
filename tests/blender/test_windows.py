# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests windows: the mouse and keys, a comparison while the isovalue moves, former bugs, isovalues
in noise, and files that take long to read.

While a file is read, the window keeps working. It shows everything once the file is read.
"""

import json

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
def cut(blender, ball, tmp_path_factory):
    return blender.in_window("drag_cut_box.py", ball, tmp_path_factory.mktemp("cut"))


def test_a_cut_follows_its_box_with_an_estimate_of_the_light(cut):
    assert cut["without live"]["length"] > 0.1 and cut["without live"]["cuts"] >= 2
    assert cut["without live"]["moved"] == 0 and cut["change"]
    assert cut["darkest"] > 0


def test_undo_takes_the_cut_along(cut):
    assert cut["undone"]


def test_live_follows_a_dragged_cut(cut):
    assert cut["with live"]["cuts"] >= 1 and cut["final"]
    assert cut["seconds"]["cut"] <= cut["seconds"]["direct"] < cut["seconds"]["final"]


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


@pytest.fixture(scope="module")
def compared(blender, tmp_path_factory):
    return blender.in_window("compare.py", tmp_path_factory.mktemp("window"))


@pytest.mark.machine
def test_the_window_stays_free_while_it_compares(compared):
    """Checks that the isovalue can be moved during a comparison; one render alone takes seconds."""
    compare = compared["compare"]
    assert compare["seconds"] > 2.0 and compare["gap"] < 0.3 * compare["seconds"]
    # Allow for other work on the machine.
    assert compare["begun"] < 5.0 and compare["gap"] < 5.0


def test_it_compares_what_was_shown_when_it_began(compared):
    compare = compared["compare"]
    said = " ".join(compare["statuses"])
    assert "Baked" in said and "Cycles" in said and "%" in said
    assert compare["sentence"].startswith("Isovalue ")
    assert len(compare["files"]) == 11
    assert all(name.startswith("bumps_47_") for name in compare["files"])


@pytest.fixture(scope="module")
def mishaps(blender, tmp_path_factory):
    """Returns (results, output of Blender)."""
    status, said = blender.show("mishaps.py", tmp_path_factory.mktemp("mishaps"), size=(960, 600))
    line = next((line for line in said.splitlines() if line.startswith("WINDOW ")), "")
    assert status == 0 and line, said
    return json.loads(line.removeprefix("WINDOW ")), said


@pytest.fixture(scope="module")
def mended(mishaps):
    return mishaps[0]


def test_bake_before_stage_shows_a_lit_stage_without_the_first_cube(mended):
    row = mended["bake before stage"]
    assert row["before"] == "SOLID" and row["shading"] == "MATERIAL"
    assert row["cube"] and row["camera"] == "Stage Camera" and row["lit"]


@pytest.mark.parametrize("name", ["up", "front"])
def test_the_camera_is_followed_when_the_volume_turns(mended, name):
    row = mended[f"turned {name}"]
    assert row["perspective"] == "CAMERA" and row["camera"] == "Stage Camera"
    # Height or width fills its share of the frame (stage/camera.py).
    assert 0.3 < row["height"] < 0.63


def test_a_kept_bake_has_the_light_of_walls_or_says_so(mended):
    assert mended["kept"]["walls"]


def test_a_bake_ends_with_its_volume_and_its_sentence_with_undo(mended):
    row = mended["deleted"]
    assert "was deleted" in row["sentence"]
    assert not row["offered"] and row["undone"]


def test_an_unreadable_file_is_one_sentence(mishaps):
    mended, said = mishaps
    assert mended["no volume"]["free"]
    assert "text.nrrd: " in said and "Traceback" not in said


def test_the_clip_box_is_seen_without_overlays(mended):
    row = mended["clip box"]
    assert not row["overlays"] and row["pixels"] > 100


# Limit of triangles while the isovalue moves (show/surface_object.py).
MOVING_TRIANGLES = 150_000


@pytest.fixture(scope="module")
def stood(blender, tmp_path_factory):
    return blender.in_window("stands.py", tmp_path_factory.mktemp("stands"), size=(900, 640))


def test_the_window_does_not_wait_for_the_light_of_walls(stood):
    """Checks a clip box, the size of a page, pictures of walls, Live and Show Lit Walls. Only
    pictures wait for the light of walls.
    """
    row = stood["beside walls"]["found"]
    assert row["waited"] == ["dark picture"] and row["box"] and row["live"]
    assert row["size"][0] == "Estimating its size" and row["size"][1].endswith(" MB")
    first, rendered, last = row["walls"]
    assert first == 0 and 0 < rendered == last


def test_the_status_bar_shows_how_far_the_light_of_walls_is(stood):
    first, last = stood["beside walls"]["found"]["status"]
    assert first[0].endswith(" % Lighting walls") and last == [None]


def test_lit_walls_go_with_their_volume_and_come_with_undo(stood):
    deleted, undone, redone, again = stood["deleted"]["found"]
    assert deleted == redone == [0, 0, 0]
    assert undone == again and undone[0] == 1 and undone[1] == undone[2] > 0


def test_a_bake_without_lit_walls_needs_no_thread(stood):
    assert not stood["without walls"]["found"]


def test_noise_is_coarse_at_first(stood):
    assert stood["among noise"]["found"] <= MOVING_TRIANGLES


# Isovalues in the saved file, and after a drag while the file is read (window/reads.py).
SAVED, DRAGGED = 50.0, 60.0
LIT = {"isovalue": DRAGGED, "lit": True, "problems": []}


@pytest.fixture(scope="module")
def read(blender, tmp_path_factory):
    return blender.in_window("reads.py", tmp_path_factory.mktemp("reads"), size=(900, 640))


def _part(row, keys):
    return {key: row[key] for key in keys}


def test_the_isovalue_moves_before_its_light_is_read(read):
    """Checks that isosurface, walls and histogram follow the isovalue before the light is read."""
    row = read["dragged"]
    held = row["held"]
    assert held["reads"] == ["thread"] and held["sidebar"]
    assert held["asked"] == DRAGGED and held["isovalue"] == SAVED and not held["problems"]
    assert not held["distribution"] and held["walls"][1] == 0 < held["walls"][0]
    assert held["status"][0].endswith(" % Reading the bake") and row["status"] == [None]
    assert _part(row, LIT) == LIT and row["walls"][1] == row["walls"][0] == held["walls"][0]


def test_a_volume_before_its_bake_is_read_in_a_thread(read):
    row = read["unlit"]
    assert row["held"]["reads"] == ["thread"] and row["held"]["isovalue"] == SAVED
    assert row["held"]["status"][0].endswith(" % Reading the volume") and row["status"] == [None]
    assert row["isovalue"] == DRAGGED and not row["lit"] and not row["problems"]


@pytest.mark.parametrize("button", ["add", "box", "bake", "continue"])
def test_a_button_says_that_a_file_is_still_read(read, button):
    row = read["pressed"]
    answer = row["answers"][button]
    assert "is still being read: wait" in answer and answer.count("\n") <= 1
    assert row["held"]["isovalue"] == SAVED and not row["held"]["problems"]


def test_an_export_and_a_script_wait(read):
    row = read["pressed"]
    assert row["held"]["at work"] and not row["held"]["exported"]
    assert row["exported"] and row["added"] == 1


def test_live_begins_once_the_bake_is_read(read):
    row = read["live"]
    assert row["held"] == {"live": False, "sentence": ""}
    assert row["begun"] == {"live": True, "sentence": ""}


def test_a_picture_waits_and_has_all_light(read):
    row = read["rendered"]
    assert not row["held"]
    (picture,) = row["pictures"]
    assert _part(picture, LIT) == LIT and not picture["coarse"]
    assert picture["walls"][1] == picture["walls"][0] > 0
    assert _part(row, LIT) == LIT


def test_a_volume_that_was_deleted_meanwhile_comes_back_lit(read):
    row = read["deleted"]
    assert row["volumes"] == [0, 0, 1] and _part(row, LIT) == LIT


def test_opening_another_file_ends_the_reading(read):
    row = read["left"]
    assert not row["opened"] and row["status"] == [None] and not row["problems"]


def test_what_cannot_be_read_is_read_but_once(read):
    """Checks a bake that cannot be read, and then a volume, whose isosurface is shown unlit."""
    for row, why in zip(read["damaged"], ("The file is damaged.", "a bug in Leaflight ended")):
        (problem,) = row["problems"]
        assert why in problem and row["reads"] == ["thread", "thread"]
        assert row["isovalue"] == DRAGGED and not row["lit"]
