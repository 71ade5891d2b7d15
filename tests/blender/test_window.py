# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the isovalue slider in a window: it is dragged with the mouse, and pictures are counted."""

import json

import leaflight
import numpy as np
import pytest
from volume_recipes import COLIN27

# The number of pictures during a drag depends on the machine, too.
pytestmark = [pytest.mark.slow, pytest.mark.machine]


@pytest.fixture(scope="module")
def volume(tmp_path_factory):
    """Returns (path, lowest, highest isovalue) of Colin27, or of a volume of similar size."""
    path = tmp_path_factory.mktemp("volume") / "volume.npy"
    if COLIN27.exists():
        np.save(path, leaflight.read_volume(str(COLIN27)).values.astype(np.uint8))
        return path, 140.5, 160.5
    noise = np.random.default_rng(0).normal(0, 6, (200, 200, 200)).astype(np.float32)
    np.save(path, leaflight.bump_box(200).values + noise)
    return path, 40.0, 60.0


@pytest.fixture(scope="module")
def drags(blender, volume):
    found = blender.in_window("drag_isovalue.py", *volume)
    assert "baking" in found, found
    print(json.dumps(found))
    return found


def _gap(drag):
    return float(np.median(drag["gaps"]))


def test_the_slider_was_dragged(drags):
    for name in ("whole", "coarse", "baking"):
        assert drags[name]["isovalues"] > 10
        assert len(drags[name]["gaps"]) > 5
    assert drags["baking"]["bakes"]


def test_pictures_follow_the_hand(drags):
    """Compares drags with coarse surfaces and with full detail, which alternate."""
    coarse, whole = (
        [_gap(drags[name + again]) for again in ("", " again")] for name in ("coarse", "whole")
    )
    assert min(coarse) < 0.5 * min(whole)
    # The limit holds for a busy machine without a graphics card.
    assert min(coarse) < 1.0
    for again in ("", " again"):
        assert drags["coarse" + again]["coarse"] > 0.7
        assert drags["whole" + again]["triangles"] > 4 * drags["coarse" + again]["triangles"]


def test_the_whole_detail_comes_at_rest(drags):
    for name in ("coarse", "coarse again", "baking"):
        assert drags[name]["whole_triangles"] > 4 * drags[name]["triangles"]
        assert drags[name]["whole_after"] < 5.0


def test_a_bake_leaves_the_viewport_alone(drags):
    """Checks that a bake updates its progress and passes with few pictures."""
    alone = drags["bake alone"]
    assert alone["statuses"] > 3
    assert alone["pictures"] <= 2 * alone["passes"] + 2


def test_pictures_follow_the_hand_beside_a_bake(drags):
    assert _gap(drags["baking"]) < 3.0 * min(_gap(drags[n]) for n in ("coarse", "coarse again"))
    assert _gap(drags["baking"]) < 2.0
