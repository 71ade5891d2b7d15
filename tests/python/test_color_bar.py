# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests color bars: their numbers, captions, and their picture in stills."""

import leaflight
import numpy as np
import pytest
from leaflight import Volume, texture_of
from leaflight.io.images import display_colors
from leaflight.io.scene_file import cornell_box
from leaflight.scene.color_bar import caption_of, color_bar_of, rounded
from leaflight.scene.volume_texture import color_map, label_texture, sign_texture
from PIL import Image

RAMP = Volume(np.linspace(-1.0, 3.0, 64, dtype=np.float32).reshape(4, 4, 4), name="potential")
SIZE = (320, 240)


def test_the_numbers_are_those_of_the_range():
    bar = color_bar_of(texture_of(RAMP, "VIK", (0.1, 0.4)))
    assert bar.title == "potential" and bar.ticks == ((0.0, "0.1"), (0.5, "0.25"), (1.0, "0.4"))
    assert bar.stops[0] == (0.0, color_map("VIK")[0][1]) and bar.stops[-1][0] == 1.0
    assert bar.caption == "potential, 0.1 to 0.4"


@pytest.mark.parametrize(
    "values, texts",
    [
        ((0.0, 127.5, 255.0), ["0", "127.5", "255"]),
        ((-0.00012345, 0.0, 0.00012345), ["-0.00012345", "0", "0.00012345"]),
        ((12345.678, 99999.9), ["12346", "100000"]),
        ((1e6, 1e6 + 1.0), ["1000000", "1000001"]),
        ((-1e-9, 3.0), ["0", "3"]),
    ],
)
def test_numbers_are_rounded_to_a_thousandth_of_their_span(values, texts):
    found = rounded(values)
    span = max(values) - min(values)
    assert all(abs(float(text) - value) <= 1e-3 * span for text, value in zip(found, values))
    assert "-0" not in found and max(map(len, found)) <= max(map(len, texts))


def test_captions_say_what_colors():
    signs = color_bar_of(sign_texture(RAMP))
    assert signs.caption == "potential, negative to positive"
    # Other ranges that are narrow beside the values near nuclei have numbers.
    narrow = 1.5e-3 * RAMP.values.max()
    bar = color_bar_of(texture_of(RAMP, "CET_D1", (-narrow, narrow)))
    assert float(bar.ticks[-1][1]) == pytest.approx(narrow, rel=1e-3)
    labels = Volume(np.arange(8, dtype=np.uint8).reshape(2, 2, 2), name="regions")
    assert color_bar_of(label_texture(labels)) is None and color_bar_of(None) is None
    assert caption_of(label_texture(labels)) == "regions, by label"
    channels = texture_of([RAMP, labels, RAMP])
    assert color_bar_of(channels) is None
    assert caption_of(channels) == "red: potential, green: regions, blue: potential"
    height = leaflight.height_of(Volume(RAMP.values, spacing=2.0, unit="mm"))
    assert caption_of(texture_of(height)) == "height in mm, 0 to 6"


@pytest.fixture(scope="module")
def colored(tmp_path_factory):
    volume = leaflight.bump_box(16)
    scene = cornell_box().colored_by(texture_of(leaflight.height_of(volume), "CET_R2", steps=4))
    bake = leaflight.bake(volume, scene, isovalues=(60, 80), error=20.0, resolution=12)
    path = tmp_path_factory.mktemp("bake") / "colored.vdb"
    bake.save(path)
    return bake, path


def test_a_still_shows_the_color_bar(colored):
    bake, _ = colored
    plain, barred = (
        np.asarray(bake.still(70.0, size=SIZE, samples=1, color_bar=bar)) for bar in (False, True)
    )
    changed = (plain != barred).any(axis=2)
    rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
    assert columns.min() > SIZE[0] / 2 and columns.max() < SIZE[0] and rows.min() > 0
    # All four colors stand above each other, the highest value on top.
    stops = bake.scene.isosurfaces[0].texture.colors
    expected = [tuple(display_colors(color, 1.0)) for _, color in stops[::2][::-1]]
    column = [tuple(pixel) for pixel in barred[:, columns.max() - 12, :3].tolist()]
    places = [np.mean([y for y, pixel in enumerate(column) if pixel == one]) for one in expected]
    assert places == sorted(places) and len(set(expected)) == 4


def test_the_command_draws_it_and_says_the_caption(cli, colored, box_file, tmp_path):
    _, path = colored
    out = tmp_path / "still.png"
    still = ["still", path, "--isovalue", "70", "--size", *map(str, SIZE), "--samples", "1"]
    assert "color: height, 0 to 1" in cli.runs(*still, "--out", out, "--color-bar")
    assert Image.open(out).size == SIZE
    cli.refuses("write a .png", *still, "--out", tmp_path / "still.exr", "--color-bar")
    cli.refuses("no color bar", "still", box_file, "--out", out, "--color-bar")
