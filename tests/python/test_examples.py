# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the examples: volumes with isosurfaces, and a picture of each in the add-on."""

from pathlib import Path

import leaflight
import numpy as np
import pytest
from leaflight.volume.examples import EXAMPLES
from outcomes import refused
from PIL import Image

PICTURES = Path(__file__).resolve().parents[2] / "addon/leaflight/importing/pictures"


@pytest.mark.parametrize("name", EXAMPLES)
def test_it_has_an_isosurface_within(name):
    volume = leaflight.examples.load(name, 24)
    assert volume.values.shape == (24, 24, 24)
    isovalue = leaflight.default_isovalue(volume)
    inside = np.mean(volume.values > isovalue)
    assert 0.001 < inside < 0.8


def test_an_unknown_name_is_refused():
    said = refused('no example "brain"', leaflight.examples.load, "brain")
    assert all(name in said for name in EXAMPLES)


def test_each_has_a_small_picture():
    assert {path.stem for path in PICTURES.iterdir()} == set(EXAMPLES)
    for path in PICTURES.iterdir():
        pixels = np.asarray(Image.open(path).convert("L"), np.float32)
        assert pixels.shape == (128, 128) and path.stat().st_size < 40_000
        # The object in the middle is brighter than the wall behind it, and shaded.
        middle = pixels[32:96, 32:96]
        assert np.quantile(middle, 0.95) > 1.2 * np.median(pixels[:16]) and middle.std() > 12
