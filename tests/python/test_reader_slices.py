# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests folders with one picture per slice, and other files among the slices."""

import struct
import zlib

import numpy as np
import pytest
import tifffile
from dicom_files import write_series
from leaflight import read_volume
from leaflight.io.readers import format_of, probe
from outcomes import reads, refused
from PIL import Image

GRAY = np.random.default_rng(1).integers(0, 255, (4, 5, 6)).astype(np.uint8)


def save(path, pixels):
    path.parent.mkdir(exist_ok=True)
    if path.suffix == ".tif":
        tifffile.imwrite(path, pixels, photometric="minisblack")
    else:
        Image.fromarray(pixels).save(path)


def save_all(folder, pattern="slice_{}.png", values=GRAY, numbers=(7, 8, 9, 10)):
    for number, plane in zip(numbers, values):
        save(folder / pattern.format(number), plane)
    return folder


@pytest.mark.parametrize("suffix", ["png", "bmp", "PNG", "tif"])
def test_slices_in_natural_order(tmp_path, suffix):
    volume = reads(GRAY, save_all(tmp_path / "scan", f"slice_{{}}.{suffix}"), spacing=(1, 2, 3))
    assert np.diag(volume.index_to_world)[:3].tolist() == [1, 2, 3]
    assert volume.name == "scan" and volume.notes == ()


def test_jpeg_slices(tmp_path):
    smooth = np.add.outer(np.arange(4) * 20, np.add.outer(np.arange(16), np.arange(16)))
    folder = save_all(tmp_path / "scan", "slice_{}.jpg", smooth.astype(np.uint8))
    np.testing.assert_allclose(read_volume(folder).values, smooth, atol=2)


def test_slices_of_16_bits(tmp_path):
    values = GRAY.astype(np.uint16) * 257 + 3
    volume = reads(values, save_all(tmp_path / "scan", values=values))
    assert volume.values.dtype == np.uint16


@pytest.mark.parametrize("suffix", ["png", "bmp"])
def test_slices_in_color(tmp_path, suffix):
    """Checks colors: gray pictures have one value per voxel, others three channels."""
    folder = tmp_path / "scan"
    save_all(folder, f"s{{}}.{suffix}", np.stack([GRAY] * 3, axis=-1))
    reads(GRAY, folder)
    colored = np.stack([GRAY, 255 - GRAY, GRAY // 2], axis=-1)
    save_all(folder, f"s{{}}.{suffix}", colored)
    assert probe(folder).channels == 3
    reads(255 - GRAY, folder, channel=1)
    save(folder / f"s9.{suffix}", GRAY[0])
    refused(f"s9.{suffix}: the slice is 6 x 5, but .* in color", read_volume, folder, channel=0)


def test_colors_of_16_bits_are_read_by_8(tmp_path):
    """Checks 16-bit colors, which Pillow reads with 8 bits; the volume notes it."""

    def chunk(kind, data):
        checked = kind + data
        return struct.pack(">I", len(data)) + checked + struct.pack(">I", zlib.crc32(checked))

    for k, plane in enumerate(GRAY):
        rows = b"".join(b"\0" + np.repeat(row, 6).tobytes() for row in plane)
        header = chunk(b"IHDR", struct.pack(">IIBBBBB", 6, 5, 16, 2, 0, 0, 0))
        data = header + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
        (tmp_path / f"{k}.png").write_bytes(b"\x89PNG\r\n\x1a\n" + data)
    volume = reads(GRAY, tmp_path)
    assert volume.notes == ("Only the upper 8 of the 16 bits of each color are read.",)


def test_alpha_is_left_out(tmp_path):
    opaque = np.full_like(GRAY, 200)
    folder = save_all(tmp_path / "scan", values=np.stack([GRAY, GRAY, GRAY, opaque], axis=-1))
    reads(GRAY, folder)
    folder = save_all(tmp_path / "other", values=np.stack([GRAY, opaque], axis=-1))
    reads(GRAY, folder)


def test_slices_with_a_palette(tmp_path):
    """Checks palettes: a gray one gives gray values; other indices are labels."""
    folder = tmp_path / "scan"
    folder.mkdir()
    for palette, right, notes in (
        ([255 - k // 3 for k in range(768)], 255 - GRAY, 0),
        ([(7 * k) % 256 for k in range(768)], GRAY, 1),
    ):
        for k, plane in enumerate(GRAY):
            image = Image.fromarray(plane).convert("P")
            image.putdata(plane.ravel())
            image.putpalette(palette)
            image.save(folder / f"{k}.png")
        volume = reads(right, folder)
        assert len(volume.notes) == notes
    image.putpalette([(5 * k) % 256 for k in range(768)])
    image.save(folder / "3.png")
    refused("3.png: .*palette", read_volume, folder)


@pytest.mark.parametrize("suffix", ["png", "tif"])
def test_what_systems_hide_beside_slices_is_no_slice(tmp_path, suffix):
    folder = save_all(tmp_path / "scan", f"slice_{{}}.{suffix}")
    for number in range(7, 11):
        (folder / f"._slice_{number}.{suffix}").write_bytes(b"\0\5\x16\7\0\2\0\0Mac OS X")
    (folder / f".hidden.{suffix}").write_bytes(b"?")
    for name in ("Thumbs.db", "desktop.ini", ".DS_Store"):
        (folder / name).write_bytes(b"?")
    volume = reads(GRAY, folder)
    assert volume.notes == ()


@pytest.mark.parametrize("suffix", ["png", "tif"])
@pytest.mark.parametrize("name", ["preview", "slice_7_small", "a", "zz 1"])
def test_a_preview_beside_slices_is_left_out(tmp_path, suffix, name):
    folder = save_all(tmp_path / "scan", f"slice_{{}}.{suffix}")
    save(folder / f"{name}.{suffix}", GRAY[0, :2, :3])
    volume = reads(GRAY, folder)
    assert f"left out: {name}.{suffix}." in volume.notes[0]


def test_a_picture_of_another_kind_beside_slices_is_left_out(tmp_path):
    folder = save_all(tmp_path / "scan")
    save(folder / "preview.tif", GRAY[0, :2, :3])
    volume = reads(GRAY, folder)
    assert volume.notes == ("Files of other kinds in the folder are left out: preview.tif.",)


@pytest.mark.parametrize(
    "numbers, note",
    [
        ((7, 8, 10, 11), "Slice 9 of slice_#.png is missing"),
        ((2, 4, 8, 10), "Slice 6 of slice_#.png is missing"),
        ((1, 3, 4, 6), "Slices 2, 5 of slice_#.png are missing"),
        ((0, 2, 4, 6), None),
        ((1, 100, 2000, 2001), None),
    ],
)
def test_missing_numbers_are_reported(tmp_path, numbers, note):
    volume = reads(GRAY, save_all(tmp_path / "scan", numbers=numbers))
    assert [text.partition(";")[0] for text in volume.notes] == ([note] if note else [])


@pytest.mark.parametrize(
    "pattern", ["x_t{t:03}_z{z}_c{c}.tif", "Series1_ch{c:02}_z{z:02}_t{t}.tif", "t{t}ch{c}z{z}.tif"]
)
def test_frames_and_channels_in_the_names(tmp_path, pattern):
    """Checks frames and channels in names by Fiji, Leica and others."""
    for t in range(2):
        for c in range(3):
            for z in range(4):
                name = pattern.format(t=t, c=c, z=z + 1)
                save(tmp_path / name, GRAY[z] // 2 + 10 * t + c)
    stored = probe(tmp_path)
    assert (stored.dims, stored.frames, stored.channels) == ((6, 5, 4), 2, 3)
    values = read_volume(tmp_path, frame=1, channel=2).values
    np.testing.assert_array_equal(values, GRAY // 2 + 12)
    (tmp_path / pattern.format(t=1, c=0, z=3)).unlink()
    refused("23; .*T 1, C 0, Z 3 .*missing", read_volume, tmp_path, frame=0, channel=0)


def test_several_sequences_are_chosen_by_their_names(tmp_path):
    save_all(tmp_path, "ct_{}.png")
    save_all(tmp_path, "mask_{}.png", GRAY // 128, (1, 2, 3, 4))
    assert probe(tmp_path).datasets == ("ct_#.png", "mask_#.png")
    reads(GRAY // 128, tmp_path, dataset="mask_#.png")
    refused("ct_#.png, mask_#.png", read_volume, tmp_path)


def test_numbers_without_a_meaning_tell_volumes_apart(tmp_path):
    for part in (3, 5):
        save_all(tmp_path, f"scan{part}_{{}}.png", GRAY // part)
    assert probe(tmp_path).datasets == ("scan3_#.png", "scan5_#.png")
    reads(GRAY // 5, tmp_path, dataset="scan5_#.png")


def test_a_time_beside_the_number_of_a_slice(tmp_path):
    for k, plane in enumerate(GRAY):
        save(tmp_path / f"slice{k + 8}_{20240105 - 977 * k}.png", plane)
    reads(GRAY, tmp_path)


def test_slices_without_numbers(tmp_path):
    for name, plane in zip("abcd", GRAY):
        save(tmp_path / f"{name}.png", plane)
    reads(GRAY, tmp_path)


def test_the_same_number_twice_is_refused(tmp_path):
    save_all(tmp_path)
    save(tmp_path / "slice_08.png", GRAY[0])
    refused("two files have the same numbers as slice_", read_volume, tmp_path)


def test_one_picture_is_no_volume(tmp_path):
    save(tmp_path / "x.png", GRAY[0])
    refused("6 x 5 pixels.*folder", read_volume, tmp_path / "x.png")
    refused("x.png: .*only this slice", read_volume, tmp_path)


def test_a_folder_of_one_stack_is_that_stack(tmp_path):
    save(tmp_path / "x.tif", GRAY)
    reads(GRAY, tmp_path)


@pytest.mark.parametrize("damage", [lambda data: data[:60], lambda data: b"x" * len(data)])
def test_a_damaged_picture_is_refused_by_its_name(tmp_path, damage):
    save_all(tmp_path)
    path = tmp_path / "slice_9.png"
    path.write_bytes(damage(path.read_bytes()))
    refused("slice_9.png: .*readable picture", read_volume, tmp_path)


def dicom(path):
    """Returns the start of a DICOM file, which identifies its format."""
    path.write_bytes(bytes(128) + b"DICM")


@pytest.mark.parametrize(
    "names, kind",
    [
        ([f"{k}.dcm" for k in range(10)] + ["preview.tif"], "dicom"),
        ([f"IM{k}" for k in range(10)] + ["preview.jpg", "x.png"], "dicom"),
        ([f"IM{k}" for k in range(3)] + ["a.png", "b.png", "c.png"], "dicom"),
        ([f"{k}.tif" for k in range(9)] + ["IM1"], "tiff"),
        ([f"{k}.tif" for k in range(9)] + ["a.png", "notes.txt"], "tiff"),
        ([f"{k}.jpg" for k in range(9)] + ["a.tif", "scan.nii"], "pictures"),
        (["a.tif", "b.tif", "c.tif", *(f".{k}.png" for k in range(9))], "tiff"),
        (["DICOMDIR", *(f"icon{k}.png" for k in range(9))], "dicom"),
        (["logo.jpg", "disc/1", "disc/2"], "dicom"),
    ],
)
def test_the_kind_of_a_folder_is_that_of_most_of_its_files(tmp_path, names, kind):
    (tmp_path / "disc").mkdir()
    for name in names:
        dicom(tmp_path / name)
    assert format_of(tmp_path).module == kind


def test_a_folder_of_two_kinds_is_refused(tmp_path):
    for k in range(4):
        dicom(tmp_path / f"{k}.dcm")
        (tmp_path / f"{k}.png").write_bytes(b"?")
        (tmp_path / f"a{k}.png").write_bytes(b"?")
    refused("holds 8 PNG, JPEG or BMP files and 4 DICOM files", read_volume, tmp_path)


def test_dicom_slices_and_a_preview(tmp_path):
    """Checks that the volume consists of the DICOM slices."""
    write_series(tmp_path, GRAY)
    save(tmp_path / "preview.tif", GRAY[0, :2, :3])
    volume = reads(GRAY, tmp_path)
    assert volume.notes == ("Files of other kinds in the folder are left out: preview.tif.",)
