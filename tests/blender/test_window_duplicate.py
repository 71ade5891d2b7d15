# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests Shift+D in a window, on a volume with an added isosurface.

Needs a Blender with a window and xvfb-run, which provides a screen.
"""

from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parent / "window" / "duplicate.py"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found(blender, ball):
    return blender.in_window(SCRIPT, ball)


def test_the_duplicate_has_an_isosurface_of_its_own(found):
    assert found["moved"] and found["duplicated"] == [[[70.0, 0.5]], [[70.0, 0.5]]]
    assert sorted(found["edited"]) == [[[70.0, 0.5]], [[80.0, 0.5]]]


def test_undo_and_redo_bring_it_along(found):
    assert found["undone"] == found["redone"] == found["duplicated"]
    assert found["undone twice"] == [[[70.0, 0.5]]]
