# SPDX-License-Identifier: GPL-3.0-or-later
"""What is written into a web page; tests/web has it in a browser."""

import base64
import json
import re
import zlib
from dataclasses import replace

import leaflight
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from leaflight import LeaflightError
from leaflight.export import page, page_data
from leaflight.export.light_bricks import light_bricks
from leaflight.export.shared_exponent import packed


@pytest.fixture(autouse=True)
def template(tmp_path, monkeypatch):
    """What Node makes of web/, as far as the page is filled."""
    path = tmp_path / "template.html"
    path.write_text("<title></title>leaflight-connect-src<!--leaflight:data-->")
    monkeypatch.setattr(page, "TEMPLATE", path)
    return path


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


def test_the_page_holds_the_bake(lapr_bake, tmp_path):
    out = tmp_path / "two.html"
    assert lapr_bake.export_page(out, isovalue=0.25) == out
    text = out.read_text()
    header = json.loads(script(text, "leaflight-header"))
    body = base64.b64decode(script(text, "leaflight-body"))
    assert header["isovalue"] == 0.25 and header["window"] == [0, 1] and "'none'" in text
    for number, volume in enumerate(header["volumes"]):
        values = lapr_bake.volumes[number].values
        codes = block(header, body, volume["values"], f"u{volume['bits'] // 8}")
        nx, ny, nz = volume["dims"]
        got = volume["offset"] + volume["scale"] * codes.reshape(nz, ny, nx)
        np.testing.assert_allclose(got, values, atol=1e-5 * np.ptp(values))
        grid = lapr_bake.grids[number]
        table = block(header, body, volume["table"], np.uint8)
        table = table.reshape(*volume["bricks"][::-1], 4)
        for side, name in (("outer", "radiance"), ("inner", "radiance_back")):
            texture = unpacked(block(header, body, volume[side], np.uint32))
            brick = np.array(volume["brick"])
            shape = brick * volume["textureBricks"]
            texture = texture.reshape(*shape[::-1], 3)
            dense = grid.dense(name) * lapr_bake.scene.exposure
            for place in np.argwhere(dense.any(axis=-1))[::97]:
                at = np.minimum(place[::-1] // (brick - 1), np.array(volume["bricks"]) - 1)
                entry = table[tuple(at[::-1])]
                assert entry[3] == 1
                x, y, z = entry[:3] * brick + place[::-1] - at * (brick - 1)
                expected = dense[tuple(place)]
                assert abs(texture[z, y, x] - expected).max() <= expected.max() / 500
    assert len(header["walls"]) == len(lapr_bake.scene.meshes)
    wall = header["walls"][0]
    light = unpacked(block(header, body, wall["outer"], np.uint32)).reshape(33, -1, 3)
    middle = lapr_bake.surroundings.radiance(0, wall["nodes"][16]) * lapr_bake.scene.exposure
    np.testing.assert_allclose(light[16], middle, atol=middle.max() / 200)


@given(st.lists(st.floats(0, 60000, width=32), min_size=3, max_size=3))
def test_colors_with_a_shared_exponent(color):
    got = unpacked(packed(np.array([color], np.float32)))[0]
    assert np.abs(got - color).max() <= max(max(color) / 511, 2.0**-24)


def test_dark_and_overbright_colors():
    words = packed(np.array([[0, 0, 0], [-1, 0, 0], [1e9, 1, 0]], np.float32))
    assert words[0] == 0 and words[1] == 0
    np.testing.assert_allclose(unpacked(words)[2], [65408, 0, 0], atol=128)


@pytest.mark.parametrize("share", [0.0, 0.002, 0.9])
def test_bricks_hold_all_texels_with_light(share):
    generator = np.random.default_rng(1)
    texels = np.zeros((23, 40, 31), np.uint32)
    texels[5:, 7:30, :20] = generator.random((18, 23, 20)) < share
    texels *= generator.integers(1, 1 << 30, texels.shape, np.uint32)
    bricks = light_bricks(texels != 0)
    texture = bricks.gather(texels)
    brick, counts = np.array(bricks.brick), np.array(bricks.table.shape[2::-1])
    # A lookup in each cell of texels, as the page does it, finds its eight.
    for cell in np.argwhere(texels[:-1, :-1, :-1])[:200]:
        within = np.minimum(cell[::-1] // (brick - 1), counts - 1)
        entry = bricks.table[tuple(within[::-1])]
        assert entry[3] == 1
        x, y, z = entry[:3] * brick + cell[::-1] - within * (brick - 1)
        k, j, i = cell
        np.testing.assert_array_equal(
            texture[z : z + 2, y : y + 2, x : x + 2], texels[k : k + 2, j : j + 2, i : i + 2]
        )
    assert texture.size <= max(texels.size, 8**3)


@pytest.mark.parametrize(
    "dtype, low, high", [(np.uint8, 0, 255), (np.int16, -300, 50), (np.uint16, 5, 60000)]
)
def test_integers_stay_what_they_are(dtype, low, high):
    values = np.linspace(low, high, 60).astype(dtype).reshape(3, 4, 5)
    codes, offset, scale = page_data.coded(values)
    np.testing.assert_array_equal(offset + scale * codes, values)


def test_floats_and_holes():
    values = np.linspace(-1, 3, 60, dtype=np.float32).reshape(3, 4, 5)
    values[1, 2, 3] = np.nan
    codes, offset, scale = page_data.coded(values)
    hole = np.isnan(values)
    assert (codes[hole] == page_data.NO_DATA).all() and codes[~hole].max() < page_data.NO_DATA
    np.testing.assert_allclose(offset + scale * codes[~hole], values[~hole], atol=4 / 65534)


def test_a_coarser_page(box_bake, tmp_path):
    whole, coarse = tmp_path / "whole.html", tmp_path / "coarse.html"
    leaflight.export(box_bake, whole)
    leaflight.export(box_bake, coarse, [50.0], coarser=1)
    header = json.loads(script(coarse.read_text(), "leaflight-header"))
    assert header["volumes"][0]["dims"] == header["volumes"][0]["texels"] == [10, 10, 10]
    assert coarse.stat().st_size < whole.stat().st_size / 2 and header["isovalue"] == 50
    assert ["Shown here", "every 2nd voxel along each axis"] in header["about"]


def test_finer_texels_where_they_are_not_too_many(bump_scene, fixed_work, tmp_path, monkeypatch):
    fine = leaflight.bake(leaflight.bump_box(12), bump_scene, refine=1, **fixed_work)
    assert page_data.texels_of(fine, 0, 0) == (23, 23, 23)
    fine.export_page(tmp_path / "fine.html")
    monkeypatch.setattr(page_data, "MOST_FINER_TEXELS", 1000)
    assert page_data.texels_of(fine, 0, 0) == (12, 12, 12)


def test_a_folder_to_embed(cli, box_file, tmp_path):
    out = tmp_path / "box.html"
    for _ in range(2):  # it may be written again
        done = cli("export", box_file, "--out", out, "--embed", "--json")
        assert done.status == 0, done.err
    folder = tmp_path / "box"
    assert {path.name for path in folder.iterdir()} == {"index.html", "bake.bin"}
    assert "'self'" in (folder / "index.html").read_text() and not out.exists()
    assert json.loads(done.out.splitlines()[-1])["bytes"] > 10_000
    (folder / "letter.txt").write_text("dear")
    refused = cli("export", box_file, "--out", out, "--embed")
    assert refused.status == 2 and "holds something else" in refused.err
    assert (folder / "letter.txt").exists()


def test_sentences(box_bake, tmp_path, template, monkeypatch):
    out = tmp_path / "x.html"

    def refused(words, bake=box_bake, **options):
        with pytest.raises(LeaflightError, match=re.escape(words)):
            leaflight.export(bake, out, **options)

    refused("outside the baked window", isovalues=[400.0])
    refused("all isosurfaces", back=True)
    refused("choose 0 to 3", coarser=4)
    mirror = replace(box_bake.scene.leaves[0], scattering="mirror")
    refused("mirror or glass", replace(box_bake, scene=replace(box_bake.scene, leaves=[mirror])))
    monkeypatch.setattr(page, "LARGEST_BYTES", 20_000)
    refused("with coarser=1, every 2nd voxel")
    monkeypatch.setattr(page, "LARGEST_BYTES", 10)
    refused("crop the volume or downsample it")
    monkeypatch.undo()
    monkeypatch.setattr(page, "TEMPLATE", tmp_path / "absent.html")
    refused("built without Node")
    with pytest.raises(LeaflightError, match="only a web page"):
        leaflight.export(box_bake, tmp_path / "x.ply", coarser=1)
    assert not out.exists()


def test_titles_are_no_markup(box_bake, tmp_path):
    named = replace(box_bake.volume, name="</script><b>x")
    bake = replace(box_bake, volumes=[named])
    bake.export_page(tmp_path / "x.html")
    text = (tmp_path / "x.html").read_text()
    assert text.count("</script>") == 2 and "<b>" not in text.partition("<script")[0]
    assert json.loads(script(text, "leaflight-header"))["title"] == "</script><b>x"
