# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests color maps by name: their tables, reversed, in steps, and over a symmetric range."""

import leaflight
import numpy as np
import pytest
from leaflight import Volume, texture_of
from leaflight.color_maps import CATEGORICAL, MAPS, colors_of
from leaflight.io.scene_file import cornell_box, scene_from_json, scene_to_json
from leaflight.scene.volume_texture import color_map
from leaflight.srgb import linear_from_srgb
from outcomes import refused

RAMP = Volume(np.linspace(-1.0, 3.0, 64, dtype=np.float32).reshape(4, 4, 4), name="ramp")
BAKE = ["--isovalues", "60", "80", "--error", "20", "--resolution", "12", "--dims", "12"]


def at(texture, values):
    places = [place for place, _ in texture.colors]
    return np.transpose(
        [np.interp(values, places, c) for c in np.transpose([c for _, c in texture.colors])]
    )


@pytest.mark.parametrize("key", ["VIRIDIS", "MAGMA", "INFERNO", "PLASMA", "CIVIDIS", "TWILIGHT"])
def test_the_colors_are_those_of_matplotlib(key):
    table = pytest.importorskip("matplotlib").colormaps[key.lower()]
    expected = linear_from_srgb(table(np.arange(table.N))[:, :3])
    found = at(texture_of(RAMP, key, (0.0, 1.0)), np.linspace(0.0, 1.0, table.N))
    np.testing.assert_allclose(found, expected, atol=0.025)


def test_every_map_has_a_table():
    for key, (name, text, colors) in {**MAPS, **CATEGORICAL}.items():
        assert name and text and not text.endswith(".")
        assert len(colors_of(key)) == (33 if key in MAPS else len(colors))
    assert all(len(colors) == 9 for _, _, colors in MAPS.values())


def test_a_reversed_map_has_its_ends_exchanged():
    plain, turned = (color_map("BATLOW", reverse) for reverse in (False, True))
    assert [color for _, color in turned] == [color for _, color in plain[::-1]]
    assert [place for place, _ in turned] == [place for place, _ in plain]


def test_a_symmetric_range_has_zero_in_the_middle():
    texture = texture_of(RAMP, "VIK", symmetric=True)
    assert (texture.colors[0][0], texture.colors[-1][0]) == (-3.0, 3.0)
    negative = texture_of(RAMP, "VIK", (-5.0, 2.0), symmetric=True)
    assert (negative.colors[0][0], negative.colors[-1][0]) == (-5.0, 5.0)
    whitest = color_map("VIK")[16][1]
    np.testing.assert_allclose(at(texture, [0.0]), [whitest])


def test_steps_are_separate_colors_of_equal_width():
    texture = texture_of(RAMP, "VIRIDIS", (0.0, 4.0), steps=4)
    found = at(texture, np.repeat(np.arange(4.0), 3) + np.tile([0.01, 0.5, 0.99], 4))
    assert len(np.unique(found, axis=0)) == 4
    np.testing.assert_array_equal(found[::3], found[2::3])
    smooth = texture_of(RAMP, "VIRIDIS", (0.0, 3.0))
    np.testing.assert_allclose(found[::3], at(smooth, np.arange(4.0)))
    # The core accepts its stops and shows the same colors.
    nodes = texture_of(Volume(RAMP.values, spacing=1.0), "VIRIDIS", (-1.0, 3.0), steps=2)
    assert len(np.unique(nodes.colors_of_nodes().reshape(-1, 3).round(5), axis=0)) == 2


def test_steps_of_a_cyclic_map_are_all_different():
    colors = np.array([color for _, color in color_map("CET_C6", steps=6)])[::2]
    assert min(np.abs(a - b).max() for i, a in enumerate(colors) for b in colors[:i]) > 0.1


def test_categorical_maps_have_no_colors_between():
    colors = {color for _, color in color_map("TAB10")}
    assert len(colors) == 10
    first = [color for _, color in color_map("TAB10", steps=3)]
    assert len(set(first)) == 3 and first[0] == color_map("TAB10")[0][1]


def test_unusable_steps_are_refused():
    refused("choose 0 to 256", texture_of, RAMP, "VIK", steps=-1)
    refused("no color map", texture_of, RAMP, "vik")


def test_a_scene_file_names_them_too(tmp_path):
    np.save(tmp_path / "values.npy", RAMP.values)
    text = scene_to_json(cornell_box())
    texture = (
        '"texture": {"channels": [{"name": "v", "source": "values.npy"}], "map": "ROMA",'
        ' "range": [-1, 5], "reverse": true, "symmetric": true, "steps": 3}, "albedo"'
    )
    head, volumes = text.split('"volumes"')
    named = head + '"volumes"' + volumes.replace('"albedo"', texture, 1)
    found = scene_from_json(named, folder=tmp_path).isosurfaces[0].texture
    expected = texture_of(RAMP, "ROMA", (-5.0, 5.0), reverse=True, steps=3)
    assert found.colors == expected.colors


def _texture_of_bake(cli, path, *options):
    cli.runs("bake", "bump_box", "--out", path, *BAKE, *options)
    return leaflight.load_bake(path).scene.isosurfaces[0]


def test_a_command_colors_by_gradient_and_height(cli, tmp_path):
    path = tmp_path / "box.vdb"
    found = _texture_of_bake(cli, path, "--color-by", "gradient", "--color-map", "magma")
    expected = leaflight.gradient_of(leaflight.bump_box(12)).values
    np.testing.assert_array_equal(found.texture.channels[0].values, expected)
    assert found.albedo == (1.0, 1.0, 1.0)
    options = ("--color-by", "height", "--color-range", "0", "0.5", "--color-steps", "5")
    height = _texture_of_bake(cli, path, *options)
    assert height.texture.colors == texture_of(RAMP, "VIRIDIS", (0.0, 0.5), steps=5).colors


def test_a_command_shows_slices_on_cuts(cli, tmp_path):
    path = tmp_path / "box.vdb"
    plane = ("--cut-plane", *"0.5 0.5 0.5 0 0 1".split())
    found = _texture_of_bake(cli, path, "--color-by", "slices", *plane)
    values = found.texture.channels[0].values
    assert np.isfinite(values).any() and np.isnan(values).any()
    np.testing.assert_array_equal(found.texture.colors[0][1], (0, 0, 0))
    command = ("bake", "bump_box", "--out", path, *BAKE, "--color-by", "slices")
    cli.refuses("no capped cut shows a slice", *command)


def test_a_command_colors_by_a_volume(cli, tmp_path):
    path = tmp_path / "box.vdb"
    labels = tmp_path / "labels.npy"
    np.save(labels, np.arange(8, dtype=np.uint8).reshape(2, 2, 2))
    found = _texture_of_bake(cli, path, "--color-by", labels, "--color-map", "labels")
    assert found.texture.nearest
    cli.refuses("give --color-by", "bake", "bump_box", "--out", path, *BAKE, "--color-map", "vik")
