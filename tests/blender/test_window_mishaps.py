# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests former bugs in a window, with the same clicks and keys."""

import json

import pytest

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def shown(blender, tmp_path_factory):
    """Returns (results, output of Blender)."""
    status, said = blender.show("mishaps.py", tmp_path_factory.mktemp("mishaps"), size=(960, 600))
    line = next((line for line in said.splitlines() if line.startswith("WINDOW ")), "")
    assert status == 0 and line, said
    return json.loads(line.removeprefix("WINDOW ")), said


@pytest.fixture(scope="module")
def found(shown):
    return shown[0]


def test_bake_before_stage_shows_a_lit_stage_without_the_first_cube(found):
    row = found["bake before stage"]
    assert row["before"] == "SOLID" and row["shading"] == "MATERIAL"
    assert row["cube"] and row["camera"] == "Stage Camera" and row["lit"]


@pytest.mark.parametrize("name", ["up", "front"])
def test_the_camera_is_followed_when_the_volume_turns(found, name):
    row = found[f"turned {name}"]
    assert row["perspective"] == "CAMERA" and row["camera"] == "Stage Camera"
    # Height or width fills its share of the frame (stage/camera.py).
    assert 0.3 < row["height"] < 0.63


def test_a_kept_bake_has_the_light_of_walls_or_says_so(found):
    assert found["kept"]["walls"]


def test_a_bake_ends_with_its_volume_and_its_sentence_with_undo(found):
    row = found["deleted"]
    assert "was deleted" in row["sentence"]
    assert not row["offered"] and row["undone"]


def test_an_unreadable_file_is_one_sentence(shown):
    found, said = shown
    assert found["no volume"]["free"]
    assert "text.nrrd: " in said and "Traceback" not in said


def test_the_clip_box_is_seen_without_overlays(found):
    row = found["clip box"]
    assert not row["overlays"] and row["pixels"] > 100
