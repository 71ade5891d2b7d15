# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests FLIP of two pictures, by NVIDIA's library."""

import numpy as np
import pytest
from leaflight.measure.flip import flip


@pytest.fixture
def picture():
    """Returns a smooth linear picture from dark to white."""
    y, x = np.mgrid[0:48, 0:64] / 64.0
    return np.stack([x, y, 0.5 * (x + y)], axis=-1).astype(np.float32)


def test_equal_pictures_do_not_differ(picture):
    found = flip(picture, picture)
    assert found.map.shape == (48, 64) and found.mean == 0.0 == found.percentile_95


def test_black_and_white_differ_most(picture):
    found = flip(np.zeros_like(picture), np.ones_like(picture))
    assert found.mean > 0.9


def test_only_what_is_displayed_counts(picture):
    brighter = np.where(picture > 0.5, 4.0, picture)
    assert flip(2.0 * brighter, 2.0 * picture).mean == 0.0
    assert flip(brighter, picture, exposure=2.0).mean == 0.0
    assert 0.0 < flip(brighter, picture).mean < 1.0


def test_a_patch_is_found_where_it_is(picture):
    other = picture.copy()
    other[20:28, 30:40] += 0.2
    found = flip(other, picture)
    assert found.map[22:26, 32:38].min() > 5 * found.map[:8].max() > -1
    assert found.mean < found.percentile_95
