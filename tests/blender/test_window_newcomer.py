# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests a newcomer's steps in a window: from the factory scene to a lit isosurface in four clicks,
and beyond.
"""

from pathlib import Path

import leaflight
import nibabel
import numpy as np
import pytest
from leaflight.volume.particles import neuron
from PIL import Image

# The expected viewport after the bake of the brain in Blender 3.4, reduced to a tenth.
REFERENCE = Path(__file__).resolve().parent / "window" / "newcomer.png"
BRAIN = Path("/usr/share/mricron/templates/ch2bet.nii.gz")

# 8-bit levels: white, and too dark to look lit.
WHITE, BLACK = 250, 8

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def volume(tmp_path_factory):
    """Returns a NIfTI file: Colin27's brain at a third of its resolution, or a generated neuron."""
    path = tmp_path_factory.mktemp("volume") / "brain.nii.gz"
    if BRAIN.exists():
        values = leaflight.read_volume(str(BRAIN)).values[:180, :216, :180].astype(np.float32)
        values = values.reshape(60, 3, 72, 3, 60, 3).mean(axis=(1, 3, 5))
    else:
        values = neuron(64).values
        values = 255 * values / values.max()
    nibabel.save(nibabel.Nifti1Image(values.T.astype(np.uint8), np.diag([3, 3, 3, 1])), path)
    return path


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    return tmp_path_factory.mktemp("pictures")


@pytest.fixture(scope="module")
def found(blender, volume, pictures):
    return blender.in_window("newcomer.py", volume, pictures, size=(1600, 900))


def test_four_clicks_and_one_file(found):
    assert found["objects"] == ["Camera", "Cube", "Light"]
    assert found["bake"]["clicks"] == 4
    assert found["bake"]["lit"] and not found["bake"]["failure"]


def test_the_stage_is_seen_lit_and_nothing_is_in_its_way(found):
    staged = found["staged"]
    assert {"Cube", "Light"} <= set(staged["hidden"])
    assert staged["camera"] == "Stage Camera"
    assert staged["perspective"] == "CAMERA" and staged["shading"] == "MATERIAL"
    assert not staged["overlays"]


def test_the_picture_improves_while_it_bakes(found):
    assert found["bake"]["passes"] > 0


@pytest.fixture(scope="module")
def shown(found, pictures):
    """Returns (picture, mask of the volume in it)."""
    whole, empty = (
        np.asarray(Image.open(pictures / name).convert("RGB"), np.int64)
        for name in ("with.png", "without.png")
    )
    mask = np.abs(whole - empty).max(axis=2) > 6
    assert 0.05 < mask.mean() < 0.6
    return whole, mask


def test_the_viewport_shows_what_it_did(shown, pictures):
    """Compares with the expected picture, so that changes of light, color, stage or camera show."""
    if not BRAIN.exists():
        pytest.skip("There is no Colin27: install the Debian package mricron-data.")
    reference = Image.open(REFERENCE).convert("RGB")
    small = Image.open(pictures / "with.png").convert("RGB").resize(reference.size, Image.BOX)
    off = np.abs(np.asarray(small, np.int64) - np.asarray(reference, np.int64))
    assert off.mean() < 1.5 and off.max() < 12, (off.mean(), off.max())


def test_nothing_is_burnt_out(shown):
    picture, mask = shown
    assert picture[mask].min(axis=1).max() < WHITE
    assert picture[~mask].min(axis=1).max() < WHITE
    # It must not be dim, either.
    assert 90 < picture[mask].mean() < 220


def test_no_black_hole_around_the_volume(shown):
    picture, mask = shown
    brightness = picture.max(axis=2)
    # Look outside the volume's own edge.
    grown = mask.copy()
    for _ in range(3):
        grown[1:] |= grown[:-1]
        grown[:-1] |= grown[1:]
        grown[:, 1:] |= grown[:, :-1]
        grown[:, :-1] |= grown[:, 1:]
    assert (brightness[~grown] < BLACK).mean() < 1e-3


def test_the_isosurface_fills_more_than_half_of_the_height(shown):
    rows = np.flatnonzero(shown[1].any(axis=1))
    assert 0.5 < np.ptp(rows) / len(shown[1]) < 0.75


def test_the_backdrop_has_no_edge_and_is_brightest_where_the_volume_stands(shown):
    picture, mask = shown
    left = slice(0, mask.shape[1] // 20)
    assert not mask[:, left].any()
    rows = picture[:, left].mean(axis=(1, 2))
    assert np.abs(np.diff(rows)).max() < 4
    height = len(rows)
    assert rows[: height // 10].mean() < 0.8 * rows[height // 2 :].mean()


def test_escape_offers_what_there_is_and_it_is_kept(found):
    stopped = found["stopped"]
    assert stopped["offered"] and stopped["bake"]
    assert found["second"] != found["first"]


@pytest.mark.machine
def test_escape_ends_the_bake_soon(found):
    assert found["stopped"]["seconds"] < 20


def test_undo_and_redo_change_the_bake(found):
    assert found["undone"] == found["first"] and found["redone"] == found["second"]


def test_a_saved_file_is_lit_when_it_is_opened(found):
    loaded = found["loaded"]
    assert loaded["bake"] == found["second"] and loaded["path"].startswith("//leaflight")
    assert loaded["brightest"] > 0.05 and not loaded["problem"]


def test_a_copy_shows_its_own_isovalue_and_goes_alone(found):
    assert all(found["copied"].values()) and found["deleted"]


def test_an_animation_plays_with_the_light_of_each_isovalue(found):
    played = found["played"]
    assert played["frames"] > 5 and played["off"] < 1e-5 and played["lit"]
