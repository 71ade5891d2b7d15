# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the display of volumes and bakes in a shell and in a notebook."""

import importlib.util
import sys
from html.parser import HTMLParser
from pathlib import Path

import leaflight
import numpy as np
import pytest
from leaflight import Volume
from leaflight.export.page_size import TEMPLATE
from leaflight.stills.photograph import metered_stops, tone_mapped
from outcomes import refused
from waiting import run_python


class Elements(HTMLParser):
    """The texts of some HTML, and its attributes by the name of their element."""

    def __init__(self, text):
        super().__init__()
        self.texts, self.attributes = [], {}
        self.feed(text)

    def handle_data(self, data):
        self.texts.append(data)

    def handle_starttag(self, tag, attributes):
        self.attributes[tag] = dict(attributes)


def test_short_representations(box_bake):
    volume = Volume(np.zeros((4, 5, 6), np.uint8), spacing=(1, 2, 0.5), name="<i>", unit="mm")
    assert repr(volume) == "<Volume: name <i>, voxels 6 x 5 x 4, of 1 x 2 x 0.5 mm, type uint8>"
    assert Elements(volume._repr_html_()).texts[-1] == "uint8"
    assert "<i>" in Elements(volume._repr_html_()).texts
    assert repr(box_bake).startswith("<Bake: of bump_box, in bump box, isovalues 30..70, texels")
    assert "20 x 20 x 20" in Elements(box_bake._repr_html_()).texts
    surface = box_bake.surface(47.0)
    words = f"{len(surface.vertices)} vertices, {len(surface.triangles)} triangles"
    assert repr(surface) == f"<Surface: {words}>"


def test_a_bake_makes_a_picture(box_bake):
    image = box_bake.still(47.0, size=(64, 48), samples=1)
    linear = leaflight.still(box_bake, 47.0, size=(64, 48), samples=1)
    pixels = np.asarray(image)
    assert image.mode == "RGBA" and pixels.shape == (48, 64, 4)
    np.testing.assert_array_equal(pixels[..., 3], np.rint(255 * linear[..., 3]))
    exposure = box_bake.scene.exposure * 2.0 ** metered_stops(box_bake, 47.0)
    exposed = tone_mapped(linear[..., :3] * exposure) ** (1 / 2.2)
    assert np.abs(pixels[..., :3] / 255 - exposed)[pixels[..., 3] == 255].max() < 0.04
    # A still without an isovalue shows the default one.
    assert np.asarray(box_bake.still(size=(16, 9), samples=1)).max() > 50


def test_still_is_one_thing():
    """Checks that still is a function, which hides no module."""
    assert callable(leaflight.still) and importlib.util.find_spec("leaflight.still") is None


# Program that replaces the browser and writes the address that it is given.
BROWSER = """#!/bin/sh
echo "$1" > "$ADDRESS"
"""
SHOW = """
import sys
import leaflight
page = leaflight.load_bake(sys.argv[1]).show(47.0, height=300, coarser=1)
print(page.path)
open(sys.argv[2], "w").write(page._repr_html_())
"""


def test_a_bake_is_shown_as_its_page(box_file, tmp_path):
    if not TEMPLATE.exists():
        pytest.skip("this installation was built without Node")
    browser, address, cell = (tmp_path / name for name in ("browser", "address", "cell.html"))
    browser.write_text(BROWSER)
    browser.chmod(0o755)
    variables = {"BROWSER": str(browser), "ADDRESS": str(address), "TMPDIR": str(tmp_path)}
    done = run_python("-c", SHOW, box_file, cell, variables=variables, check=True)
    page = Path(done.stdout.strip())
    assert address.read_text().strip() == page.as_uri()
    frame = Elements(cell.read_text()).attributes["iframe"]
    assert frame["srcdoc"] == page.read_text() and frame["height"] == "300"


def test_a_widget_needs_anywidget(box_bake, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    assert "pip install anywidget" in refused("needs the Python package", box_bake.widget)
