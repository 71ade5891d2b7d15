# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests how DICOM files store and compress pixels."""

import zlib

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import MissingPackage, probe
from outcomes import reads, refused, written

pydicom = pytest.importorskip("pydicom")
from dicom_files import bare, edit, jpeg_2000, write_series, write_slice  # noqa: E402
from pydicom import uid  # noqa: E402
from pydicom.encaps import encapsulate  # noqa: E402


@pytest.fixture
def signed():
    return np.random.default_rng(2).integers(-2048, 2048, (4, 5, 6))


def test_signs_of_twelve_bits(tmp_path, signed):
    tags = {"BitsStored": 12, "HighBit": 11, "PixelRepresentation": 1}
    volume = reads(signed, write_series(tmp_path / "scan", signed & 0xFFF, **tags))
    assert volume.values.dtype == np.int16


def test_overlays_above_the_bits_that_count(tmp_path, signed):
    overlay = (signed % 3 == 0) * 0x5000
    folder = write_series(tmp_path / "scan", (signed + 2048) | overlay, BitsStored=12, HighBit=11)
    reads(signed + 2048, folder)


@pytest.mark.parametrize("representation", [0, 1])
def test_bits_that_end_at_the_highest(tmp_path, signed, representation):
    expected = signed if representation else signed + 2048
    words = (expected << 4 | (signed & 3)) & 0xFFFF
    tags = {"BitsStored": 12, "HighBit": 15, "PixelRepresentation": representation}
    reads(expected, write_series(tmp_path / "scan", words, **tags))
    # Some writers keep High Bit but store the numbers as usual.
    reads(expected, write_series(tmp_path / "other", expected & 0xFFFF, **tags))


def test_pixels_without_data(tmp_path, values):
    words = values.copy()
    words[:, 0] = 63536
    tags = {"PixelRepresentation": 1, "PixelPaddingValue": -2000, "RescaleIntercept": -1024}
    volume = read_volume(write_series(tmp_path / "scan", words, **tags))
    expected = np.where(words < 63536, values - 1024, np.nan)
    np.testing.assert_array_equal(volume.values, expected)
    assert "of the voxels are -3024" in volume.notes[0]


def test_numbers_of_32_bits(tmp_path, values):
    numbers = values.astype(np.int64) * 30_000_001
    folder = write_series(tmp_path / "scan", values, BitsAllocated=32, BitsStored=32, HighBit=31)
    for k, plane in enumerate(numbers):
        edit(folder / f"IM{k:04}", PixelData=plane.astype("<u4").tobytes())
    np.testing.assert_allclose(read_volume(folder).values, numbers, rtol=1e-7)


@pytest.mark.parametrize("name, kind", [("FloatPixelData", "<f4"), ("DoubleFloatPixelData", "<f8")])
def test_real_numbers(tmp_path, values, name, kind):
    folder = write_series(tmp_path / "scan", values)
    real = (values / 7).astype(kind)
    for k, plane in enumerate(real):
        tags = {name: plane.tobytes(), "BitsAllocated": 8 * real.itemsize}
        # Some writers keep the other tags.
        without = ["PixelData", "BitsStored", "HighBit", "PixelRepresentation"][: 1 + 3 * (k % 2)]
        edit(folder / f"IM{k:04}", without=without, **tags)
    volume = read_volume(folder)
    np.testing.assert_allclose(volume.values, real, rtol=1e-7)
    assert volume.values.dtype == np.float32


@pytest.mark.parametrize("syntax", [uid.ImplicitVRLittleEndian, uid.ExplicitVRLittleEndian])
def test_files_without_a_preamble(tmp_path, values, syntax):
    folder = write_series(tmp_path / "scan", values)
    for path in folder.iterdir():
        edit(path, syntax=syntax)
        path.write_bytes(bare(path.read_bytes()))
    reads(values, folder)
    reads(values, folder / "IM0002")


def test_files_that_only_look_so(tmp_path):
    path = tmp_path / "x.dcm"
    ascii = b"\x08\x00\x05\x00CS\x0a\0ISO_IR 100"
    for text in (b"", ascii[:4], ascii, b"#!/bin/sh\n" * 9):
        refused("x.dcm", read_volume, written(path, text))


def test_a_deflated_series(tmp_path, values):
    folder = write_series(tmp_path / "scan", values)
    for path in folder.iterdir():
        edit(path, syntax=uid.DeflatedExplicitVRLittleEndian)
    reads(values, folder)


def test_deflated_data_that_never_end(tmp_path, values, monkeypatch):
    from leaflight.io.readers.dicom import header

    monkeypatch.setattr(header, "_MOST_UNPACKED", 1 << 20)
    path = tmp_path / "x.dcm"
    write_slice(path, values[0], 0)
    edit(path, syntax=uid.DeflatedExplicitVRLittleEndian)
    data = path.read_bytes()
    start = 144 + int.from_bytes(data[140:144], "little")
    packer = zlib.compressobj(wbits=-zlib.MAX_WBITS)
    bomb = packer.compress(bytes(1 << 23)) + packer.flush()
    refused("1048576 bytes", read_volume, written(path, data[:start] + bomb))


def test_jpeg_2000_with_blank_slices(tmp_path):
    values = np.zeros((4, 256, 256), np.uint16)
    values[1:3] = np.random.default_rng(1).integers(0, 4096, (2, 256, 256))
    folder = write_series(tmp_path / "scan", values)
    for path, plane in zip(sorted(folder.iterdir()), values):
        edit(path, PixelData=encapsulate([jpeg_2000(plane)]), syntax=uid.JPEG2000Lossless)
    assert (folder / "IM0000").stat().st_size < 2 * 256**2 / 100
    reads(values, folder)


def test_pages_of_one_file_in_jpeg_2000(tmp_path):
    values = np.random.default_rng(1).integers(0, 4096, (5, 16, 20))
    values[3] = 0
    path = tmp_path / "x.dcm"
    write_slice(path, values, 0, NumberOfFrames=5, RescaleSlope=1, RescaleIntercept=-1024)
    pages = encapsulate([jpeg_2000(plane) for plane in values])
    edit(path, PixelData=pages, syntax=uid.JPEG2000Lossless)
    reads(values - 1024, path)


def test_a_compressed_picture_of_another_size(tmp_path, values):
    """Checks a compressed picture of another size than in the header, which a decoder trusts."""
    folder = write_series(tmp_path / "scan", values)
    large = encapsulate([jpeg_2000(np.zeros((500, 600)))])
    edit(folder / "IM0001", PixelData=large, syntax=uid.JPEG2000Lossless)
    refused("600 x 500.* 6 x 5", read_volume, folder)


def test_what_a_compressed_file_may_claim(tmp_path, values):
    path = tmp_path / "x.dcm"
    write_slice(path, values, 0, NumberOfFrames=4)
    pages = encapsulate([jpeg_2000(plane) for plane in values])
    edit(path, PixelData=pages, syntax=uid.JPEG2000Lossless)
    edit(path, Rows=60000, Columns=60000)
    refused("4 x 60000 x 60000", probe, path)
    edit(path, Rows=5, Columns=6, NumberOfFrames=10**8)
    refused("header claims 100000000 values", probe, path)
    edit(path, NumberOfFrames=6)
    refused("6 pages, but there are 4|cannot be decoded", read_volume, path)


def test_runs_of_bytes(tmp_path, values):
    """Checks run-length encoding by pydicom."""
    folder = write_series(tmp_path / "scan", values)
    for path in folder.iterdir():
        data = pydicom.dcmread(path)
        data.compress(uid.RLELossless)
        data.save_as(path)
    reads(values, folder)


@pytest.mark.parametrize(
    "name", ["MR_small_jp2klossless", "MR_small_jpeg_ls_lossless", "MR_small_RLE", "MR_small_expb"]
)
def test_real_compressed_files(tmp_path, name):
    """Checks pydicom's sample slices: all compressions have the pixels of the uncompressed one."""
    from pydicom.data import get_testdata_file

    packed, plain = (get_testdata_file(f"{one}.dcm", download=False) for one in (name, "MR_small"))
    if not packed or not plain:
        pytest.skip("pydicom's files are not here")
    for k in range(3):
        data = pydicom.dcmread(packed)
        data.ImagePositionPatient, data.InstanceNumber = [0, 0, k], k
        data.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
        data.save_as(tmp_path / f"{k}.dcm")
    expected = pydicom.dcmread(plain).pixel_array
    try:
        volume = read_volume(tmp_path)
    except MissingPackage as missing:
        pytest.skip(str(missing))
    np.testing.assert_array_equal(volume.values, [expected] * 3)


def test_a_compression_without_a_decoder(tmp_path, values):
    folder = write_series(tmp_path / "scan", values)
    edit(folder / "IM0001", PixelData=encapsulate([b"\0\0\1\xb3" * 9]), syntax=uid.MPEG2MPML)
    refused("IM0001: its compression .*MPEG2.* is not supported", read_volume, folder)


def test_pixels_that_are_damaged(tmp_path, values):
    folder = write_series(tmp_path / "scan", values)
    path = folder / "IM0001"
    whole = path.read_bytes()
    path.write_bytes(whole[:-20])
    refused("IM0001: the header claims .* truncated", probe, folder)
    path.write_bytes(whole)
    edit(path, BitsAllocated=12, BitsStored=12)
    refused("IM0001: 12 bits per pixel", read_volume, folder)
