# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that the window does not freeze when the isovalue moves into noise, which has many more
triangles, and while walls get their light after a bake is read.
"""

import pytest

pytestmark = pytest.mark.slow

# Limit of triangles while the isovalue moves (show/surface_object.py).
MOVING_TRIANGLES = 150_000


@pytest.fixture(scope="module")
def found(blender, tmp_path_factory):
    return blender.in_window("stands.py", tmp_path_factory.mktemp("stands"), size=(900, 640))


def test_the_window_does_not_wait_for_the_light_of_walls(found):
    """Checks a clip box, the size of a page, pictures of walls, Live and Show Lit Walls. Only
    pictures wait for the light of walls.
    """
    row = found["beside walls"]["found"]
    assert row["waited"] == ["dark picture"] and row["box"] and row["live"]
    assert row["size"][0] == "Estimating its size" and row["size"][1].endswith(" MB")
    first, rendered, last = row["walls"]
    assert first == 0 and 0 < rendered == last


def test_the_status_bar_shows_how_far_the_light_of_walls_is(found):
    first, last = found["beside walls"]["found"]["status"]
    assert first[0].endswith(" % Lighting walls") and last == [None]


def test_lit_walls_go_with_their_volume_and_come_with_undo(found):
    deleted, undone, redone, again = found["deleted"]["found"]
    assert deleted == redone == [0, 0, 0]
    assert undone == again and undone[0] == 1 and undone[1] == undone[2] > 0


def test_a_bake_without_lit_walls_needs_no_thread(found):
    assert not found["without walls"]["found"]


def test_noise_is_coarse_at_first(found):
    assert found["among noise"]["found"] <= MOVING_TRIANGLES
