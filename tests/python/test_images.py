# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that images of all formats and depths become arrays."""

import numpy as np
import pytest
import tifffile
from leaflight import LeaflightError, _core
from leaflight.io.images import luminance, read_pixels, read_texture
from outcomes import refused
from PIL import Image

GRAY = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20
COLOR = np.stack([GRAY, GRAY // 2, 255 - GRAY], axis=2)


@pytest.mark.parametrize("name", ["x.png", "x.tif", "X.TIFF"])
@pytest.mark.parametrize("pixels", [GRAY, COLOR, GRAY.astype(np.uint16) * 257])
def test_stored_numbers(tmp_path, name, pixels):
    path = tmp_path / name
    if name == "x.png":
        Image.fromarray(pixels).save(path)
    else:
        tifffile.imwrite(path, pixels)
    read = read_pixels(path)
    assert read.dtype == pixels.dtype
    np.testing.assert_array_equal(read, pixels)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_other_kinds_of_tiff(tmp_path, kind):
    """Checks colors that are stored one after the other, WhiteIsZero, and a palette."""
    path = tmp_path / "x.tif"
    color, gray = COLOR.astype(kind), GRAY.astype(kind)
    planes = np.moveaxis(color, 2, 0)
    tifffile.imwrite(path, planes, photometric="rgb", planarconfig="separate")
    np.testing.assert_array_equal(read_pixels(path), color)
    tifffile.imwrite(path, gray, photometric="miniswhite")
    read = read_pixels(path)
    assert read.dtype == kind
    np.testing.assert_array_equal(read, np.iinfo(kind).max - gray)
    colors = np.random.default_rng(1).integers(0, 1 << 16, (3, 1 << 8 * gray.itemsize), np.uint16)
    tifffile.imwrite(path, gray, photometric="palette", colormap=colors)
    np.testing.assert_array_equal(read_pixels(path), colors.T[gray])


@pytest.mark.parametrize("mode", ["RGBA", "P", "LA", "1"])
def test_other_kinds_of_png(tmp_path, mode):
    path = tmp_path / "x.png"
    image = Image.fromarray(COLOR).convert(mode)
    image.save(path)
    expected = np.asarray(image.convert("L" if mode in ("LA", "1") else "RGB"))
    np.testing.assert_array_equal(read_pixels(path), expected)


def test_jpeg(tmp_path):
    path = tmp_path / "x.jpg"
    Image.fromarray(np.full((8, 8, 3), 100, dtype=np.uint8)).save(path)
    np.testing.assert_allclose(read_pixels(path), 100, atol=2)


@pytest.mark.parametrize("channels", [3, 4])
def test_floating_point_is_linear_already(tmp_path, channels):
    path = tmp_path / "x.exr"
    pixels = np.random.default_rng(1).random((3, 5, channels), dtype=np.float32) * 7
    _core.write_exr(str(path), pixels)
    np.testing.assert_array_equal(read_texture(path), pixels[::-1, :, :3])


def test_integers_are_srgb(tmp_path):
    path = tmp_path / "x.png"
    Image.fromarray(np.array([[0, 10, 188, 255]], dtype=np.uint8)).save(path)
    texture = read_texture(path)
    assert texture.shape == (1, 4, 3) and texture.dtype == np.float32
    np.testing.assert_allclose(texture[0, :, 1], [0, 0.003035, 0.5029, 1], atol=1e-4)


def test_luminance():
    np.testing.assert_array_equal(luminance(GRAY), GRAY)
    weights = luminance(np.eye(3)[None] * 10000)
    np.testing.assert_allclose(weights, [[2126, 7152, 722]], rtol=1e-6)


@pytest.mark.parametrize("name", ["x.png", "x.jpg", "x.tif", "x.exr", "x.gif", "none.png"])
def test_what_is_no_image(tmp_path, name, capfd):
    path = tmp_path / name
    if name != "none.png":
        path.write_bytes(b"This is not an image. " * 20)
    said = refused(name, read_pixels, path)
    assert said.endswith(".") and "\n" not in said


@pytest.mark.parametrize("name", ["x.png", "x.jpg", "x.tif"])
def test_changed_and_cut_bytes(tmp_path, capfd, name):
    path = tmp_path / name
    Image.fromarray(np.tile(COLOR, (4, 4, 1))).save(path)
    good = path.read_bytes()
    rng = np.random.default_rng(9)
    for attempt in range(150):
        bad = bytearray(good)
        for place in rng.integers(0, len(bad), rng.integers(1, 6)):
            bad[place] = rng.choice([0, 1, 127, 128, 255])
        if attempt % 5 == 0:
            bad = bad[: rng.integers(0, len(bad))]
        path.write_bytes(bad)
        try:
            read_pixels(path)
        except LeaflightError as error:
            assert name in str(error) and "\n" not in str(error)
    assert capfd.readouterr() == ("", "")


def test_comments_of_an_exr_are_read_from_its_header(tmp_path):
    path, pixels = tmp_path / "x.exr", np.zeros((8, 8, 3), np.float32)
    _core.write_exr(str(path), pixels, "of one thing")
    assert _core.read_exr_comments(str(path)) == "of one thing"
    _core.write_exr(str(path), pixels)
    assert _core.read_exr_comments(str(path)) == ""
    path.write_bytes(b"This is not an image. " * 20)
    refused("not a readable EXR", _core.read_exr_comments, str(path))


def test_an_attribute_of_an_exr_claims_no_more_than_the_file_has(tmp_path):
    """Checks that no memory is allocated for the claimed size of an attribute, two gigabytes."""
    path = tmp_path / "x.exr"
    _core.write_exr(str(path), np.zeros((8, 8, 3), np.float32), "of one thing")
    whole = path.read_bytes()
    place = whole.index(b"comments\0string\0") + len(b"comments\0string\0")
    path.write_bytes(whole[:place] + (2_000_000_000).to_bytes(4, "little") + whole[place + 4 :])
    refused("its header ends early", _core.read_exr, str(path))
