# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the data in a web page. tests/web opens pages in a browser."""

import base64
import json
import re
import zlib
from dataclasses import replace
from itertools import product

import leaflight
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from leaflight.export import page, page_size, page_volume
from leaflight.export.light_bricks import light_bricks
from leaflight.export.shared_exponent import LEAST, packed
from leaflight.export.visibility_levels import DARK, HIDDEN, LIT, levels
from outcomes import refused


@pytest.fixture(autouse=True)
def template(tmp_path, monkeypatch):
    """Replaces the page that Node builds from web/ by its placeholders."""
    path = tmp_path / "template.html"
    path.write_text("<title></title>leaflight-connect-src<!--leaflight:data-->")
    monkeypatch.setattr(page_size, "TEMPLATE", path)
    return path


def body_of(text):
    """Returns the bytes of all data elements, in order."""
    parts = re.findall('<script type="text/plain">(.*?)</script>', text, re.DOTALL)
    return b"".join(map(base64.b64decode, parts))


def script(text, name):
    return re.search(f'<script id="{name}"[^>]*>(.*?)</script>', text, re.DOTALL)[1]


def block(header, body, number, dtype):
    first, length, whole = header["blocks"][number]
    planes = np.frombuffer(zlib.decompress(body[first : first + length]), np.uint8)
    assert len(planes) == whole
    return np.ascontiguousarray(planes.reshape(np.dtype(dtype).itemsize, -1).T).view(dtype).ravel()


def unpacked(words):
    scale = 2.0 ** ((words >> 27).astype(int) - 24)
    return np.stack([(words >> shift & 511) * scale for shift in (0, 9, 18)], axis=-1)


def colors(header, body, number):
    """Returns the colors of a block, decoded as in web/src/colors.ts."""
    green, red, blue, high = block(header, body, number, np.uint8).astype(np.uint32).reshape(4, -1)
    red, blue = red + green & 255, blue + green & 255
    red, green, blue = (low | (high >> k & 1) << 8 for k, low in enumerate((red, green, blue)))
    return unpacked(high >> 3 << 27 | blue << 18 | green << 9 | red)


def active_texels(header, body, texture):
    """Returns a mask, bool [z, y, x], of the texels that the blocks of a texture hold."""
    bits = np.unpackbits(block(header, body, texture["active"], np.uint8), bitorder="little")
    texels = texture["texels"]
    return bits[: np.prod(texels)].reshape(texels[::-1]) == 1


def test_the_page_holds_the_bake(lapr_bake, tmp_path):
    out = tmp_path / "two.html"
    assert lapr_bake.export_page(out, isovalue=0.25) == out
    text = out.read_text()
    header = json.loads(script(text, "leaflight-header"))
    body = body_of(text)
    assert header["isovalue"] == 0.25 and header["isovalueRange"] == [0, 1] and "'none'" in text
    for number, volume in enumerate(header["volumes"]):
        values = lapr_bake.volumes[number].values
        codes = block(header, body, volume["values"], f"u{volume['bits'] // 8}")
        nx, ny, nz = volume["dims"]
        got = volume["offset"] + volume["scale"] * codes.reshape(nz, ny, nx)
        np.testing.assert_allclose(got, values, atol=1e-5 * np.ptp(values))
        grid = lapr_bake.grids[number]
        light = volume["light"]
        active = active_texels(header, body, light)
        # Backs of two volumes contain all light.
        assert volume["direct"]["front"] and volume["direct"]["back"] is None
        for side, name in (("front", "radiance_indirect"), ("back", "radiance_back")):
            dense = grid.dense(name) * lapr_bake.scene.exposure
            assert (dense[~active] < LEAST).all()
            got, expected = colors(header, body, light[side]), dense[active]
            assert (abs(got - expected).max(1) <= LEAST + expected.max(1) / 500).all()
    walls, lit = header["walls"], lapr_bake.walls
    assert len(walls["meshes"]) == len(lapr_bake.scene.meshes)
    shadows = [
        check_wall(header, body, wall["light"], lit, number, lapr_bake)
        for number, wall in enumerate(walls["meshes"])
    ]
    assert sum(shadows) > 100


def check_wall(header, body, wall, lit, number, bake):
    """Checks a wall; returns the number of its shadow rays that only isosurfaces block."""
    sets, least, greatest, shares, *unshadowed = lit.direct_ways(number)
    assert (least is None) == (wall["least"] is None)
    exposed = list(zip(wall["unshadowed"], unshadowed))
    exposed.append((wall["indirect"], [lit.indirect(number, back) for back in (False, True)]))
    for blocks, sides in exposed:
        for of_side, light in zip(blocks, sides):
            expected = light.reshape(-1, 3) * bake.scene.exposure
            got = 0 * expected if of_side is None else colors(header, body, of_side)
            assert (abs(got - expected).max(1) <= LEAST + expected.max(1) / 500).all()
    np.testing.assert_array_equal(block(header, body, wall["sets"], np.uint8), sets)
    code = block(header, body, wall["greatest"], np.uint8).reshape(greatest.T.shape).T
    low, high = bake.isovalues
    inside = (greatest > low) & (greatest < high)
    expected = 1 + 252 * (greatest[inside] - low) / (high - low)
    assert abs(code[inside] + 0.5 - expected).max(initial=0) <= 0.501
    assert (code[greatest < low] == 0).all() and (code[np.isinf(greatest)] == 255).all()
    weight = block(header, body, wall["weights"], np.int8).reshape(shares.T.shape).T
    lights = shares * lit.point_amounts.max(axis=-1)[sets]
    front = lights / np.maximum(lights.max(axis=1, keepdims=True), 1e-30)
    assert abs(weight / 127 - front)[lights > 0].max(initial=0) <= 0.51 / 127
    assert (weight[lights <= 0] <= 0).all()
    return inside.sum()


@given(st.lists(st.floats(0, 60000, width=32), min_size=3, max_size=3))
def test_colors_with_a_shared_exponent(color):
    got = unpacked(packed(np.array([color], np.float32)))[0]
    assert np.abs(got - color).max() <= max(max(color) / 511, LEAST)


def test_dark_and_overbright_colors():
    words = packed(np.array([[0, 0, 0], [-1, 0, 0], [1e9, 1, 0]], np.float32))
    assert words[0] == 0 and words[1] == 0
    np.testing.assert_allclose(unpacked(words)[2], [65408, 0, 0], atol=128)


def test_the_page_holds_maps_of_direct_light(bump_scene, small, tmp_path):
    """Checks that each code of a map lies in the part of the local range that its level gives."""
    finer = {**small, "resolution": 24}
    bake = leaflight.bake(leaflight.bump_box(24), bump_scene, both_sides=True, **finer)
    bake.export_page(tmp_path / "box.html")
    text = (tmp_path / "box.html").read_text()
    header = json.loads(script(text, "leaflight-header"))
    body = body_of(text)
    grid, volume = bake.grids[0], header["volumes"][0]
    direct, data = grid.direct, volume["direct"]
    active = active_texels(header, body, data)
    np.testing.assert_array_equal(active, direct.mask())
    np.testing.assert_array_equal(np.ravel(direct.light_points), np.ravel(data["points"]))
    low, high = direct.code_range
    about = [1 + 252 * (value - low) / (high - low) for value in of_27(bake.volume.data())]
    for is_back, side in ((False, "front"), (True, "back")):
        assert len(data[side]) == -(-len(data["points"]) // 2)
        least, most = (254 - each for each in about[::-1]) if is_back else about
        least, most = (np.clip(each[active], 0, 254) for each in (least, most))
        for point in range(len(data["points"])):
            pair = block(header, body, data[side][point // 2], np.uint8)
            level = (pair >> 4 * (point % 2) & 15).astype(int)
            code = direct.codes(point, is_back)
            part = (np.clip(code, least, most) - least) / np.maximum(most - least, 1e-9)
            sharp = most - least > 60
            off = abs(part - part_of(level, point))[sharp & (level < DARK)]
            assert len(off) > 1000 and off.max() < 0.5 / 12 + 2 / 60
            np.testing.assert_array_equal(level == DARK, code == 255)
    # Other texels have indirect light.
    lit = active_texels(header, body, volume["light"])
    expected = grid.dense("radiance_indirect")[lit] * bake.scene.exposure
    got = colors(header, body, volume["light"]["front"])
    assert (abs(got - expected).max(1) <= LEAST + expected.max(1) / 500).all()


def part_of(level, point):
    """Returns the part 0..1 of the range of codes, decoded as in web/src/shaders/direct.glsl."""
    shift = point * 0.6180339887 % 1.0
    return np.clip((level - 1.5 + shift) / 12, 0, 1)


def of_27(values):
    """Returns minimum and maximum of the 27 voxels around each voxel."""
    padded = np.pad(values, 1, "edge")
    nz, ny, nx = values.shape
    shifted = [
        padded[z : z + nz, y : y + ny, x : x + nx] for z, y, x in product(range(3), repeat=3)
    ]
    return np.min(shifted, axis=0), np.max(shifted, axis=0)


@pytest.mark.parametrize("share, layers", [(0.0, 1), (0.002, 1), (0.9, 1), (0.9, 5)])
def test_bricks_hold_all_texels_with_light(share, layers):
    lit = np.zeros((23, 40, 31), bool)
    lit[5:, 7:30, :20] = np.random.default_rng(1).random((18, 23, 20)) < share
    bricks = light_bricks(lit, layers)
    brick, counts = np.array(bricks.brick), np.array(bricks.table.shape[2::-1])
    # Each lookup as in the page, in any cell of texels, must find its eight texels.
    for cell in np.argwhere(lit[:-1, :-1, :-1]):
        within = np.minimum(cell[::-1] // (brick - 1), counts - 1)
        first = cell[::-1] - within * (brick - 1)
        assert bricks.table[tuple(within[::-1])][3] == 1
        assert (first >= 0).all() and (first + 1 < np.maximum(brick, 2)).all()
    # Each brick has a separate place within the texture.
    places = bricks.table[bricks.table[..., 3] == 1][:, :3]
    assert len(np.unique(places, axis=0)) == len(places)
    assert (places < bricks.shape).all()
    assert np.prod(brick * bricks.shape) <= max(lit.size, 8**3)


@pytest.mark.parametrize("of", [2000, 60_000])
def test_many_layers_make_no_long_texture(of):
    lit = np.random.default_rng(1).random((80, 80, 80)) < of / 80**3
    bricks = light_bricks(lit, 40)
    x, y, z = np.array(bricks.brick) * bricks.shape
    assert max(x, y, 40 * z) <= 2048


@pytest.mark.parametrize(
    "dtype, low, high", [(np.uint8, 0, 255), (np.int16, -300, 50), (np.uint16, 5, 60000)]
)
def test_integers_stay_what_they_are(dtype, low, high):
    values = np.linspace(low, high, 60).astype(dtype).reshape(3, 4, 5)
    codes, offset, scale = page_volume.coded(values)
    np.testing.assert_array_equal(offset + scale * codes, values)


def test_floats_and_holes():
    values = np.linspace(-1, 3, 60, dtype=np.float32).reshape(3, 4, 5)
    values[1, 2, 3] = np.nan
    codes, offset, scale = page_volume.coded(values)
    hole = np.isnan(values)
    assert (codes[hole] == page_volume.NO_DATA).all() and codes[~hole].max() < page_volume.NO_DATA
    np.testing.assert_allclose(offset + scale * codes[~hole], values[~hole], atol=4 / 65534)


def test_a_coarser_page(box_bake, tmp_path):
    whole, coarse = tmp_path / "whole.html", tmp_path / "coarse.html"
    leaflight.export(box_bake, whole)
    leaflight.export(box_bake, coarse, [50.0], coarser=1)
    header = json.loads(script(coarse.read_text(), "leaflight-header"))
    volume = header["volumes"][0]
    assert volume["dims"] == volume["light"]["texels"] == volume["direct"]["texels"] == [11, 11, 11]
    assert coarse.stat().st_size < whole.stat().st_size / 2 and header["isovalue"] == 50
    assert ["Shown here", "every 2nd voxel along each axis"] in header["about"]


@pytest.mark.parametrize("walls", [False, True])
def test_the_size_of_a_page_is_known_before(walls, tmp_path):
    values = np.random.default_rng(0).normal(leaflight.bump_box(24).values, 3.0)
    bake = leaflight.bake(values, leaflight.cornell_box(), error=20.0, walls=walls, progress=False)
    path = tmp_path / "page.html"
    leaflight.export(bake, path)
    assert page_size.estimated_bytes(bake) == pytest.approx(path.stat().st_size, rel=0.2)


def test_a_folder_to_embed(cli, box_file, tmp_path):
    out = tmp_path / "box.html"
    for _ in range(2):  # can be written again
        done = cli.json("export", box_file, "--out", out, "--embed")
    folder = tmp_path / "box"
    assert {path.name for path in folder.iterdir()} == {"index.html", "bake.bin"}
    assert "'self'" in (folder / "index.html").read_text() and not out.exists()
    assert done["bytes"] > 10_000
    (folder / "letter.txt").write_text("dear")
    cli.refuses("holds other files", "export", box_file, "--out", out, "--embed")
    assert (folder / "letter.txt").exists()


def test_sentences(box_bake, tmp_path, template, monkeypatch):
    out = tmp_path / "x.html"

    def fails(words, bake=box_bake, **options):
        refused(re.escape(words), leaflight.export, bake, out, **options)

    fails("outside the baked range", isovalues=[400.0])
    fails("all isosurfaces", back=True)
    fails("choose 0 to 3", coarser=4)
    mirror = replace(box_bake.scene.isosurfaces[0], scattering="mirror")
    fails("mirror or glass", replace(box_bake, scene=replace(box_bake.scene, isosurfaces=[mirror])))
    monkeypatch.setattr(page, "LARGEST_BYTES", 1.1 * page_size.estimated_bytes(box_bake, 1))
    fails("with coarser=1, every 2nd voxel")
    monkeypatch.setattr(page, "LARGEST_BYTES", 10)
    fails("crop the volume or downsample it")
    monkeypatch.undo()
    monkeypatch.setattr(page_size, "TEMPLATE", tmp_path / "absent.html")
    fails("built without Node")
    refused("only to a web page", leaflight.export, box_bake, tmp_path / "x.ply", coarser=1)
    assert not out.exists()


def test_titles_are_no_markup(box_bake, tmp_path):
    named = replace(box_bake.volume, name="</script><b>x")
    bake = replace(box_bake, volumes=[named])
    bake.export_page(tmp_path / "x.html")
    text = (tmp_path / "x.html").read_text()
    assert text.count("</script>") == 2 and "<b>" not in text.partition("<script")[0]
    assert json.loads(script(text, "leaflight-header"))["title"] == "</script><b>x"


def test_levels_of_light_points_round_unlike_each_other():
    """Checks that the rounding errors of different light points average out."""
    points, least, greatest = 36, 20, 140
    codes = np.arange(256, dtype=np.uint8)
    about = np.full_like(codes, least), np.full_like(codes, greatest)
    given = np.stack([levels(codes, *about, point) for point in range(points)])
    assert (given[:, : least + 1] == LIT).all() and (given[:, 255] == DARK).all()
    assert (given[:, greatest:255] == HIDDEN).all()
    shown = np.stack([part_of(level, point) for point, level in enumerate(given)])
    off = (shown - (codes - float(least)) / (greatest - least))[:, least + 10 : greatest - 9]
    assert np.abs(off).max() > 0.4 / 12 and np.abs(off.mean(axis=0)).max() < 0.1 / 12
