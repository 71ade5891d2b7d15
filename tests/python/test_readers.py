# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that all formats return the values, the shape and the position that were written."""

import gzip

import nibabel
import numpy as np
import pytest
import tifffile
from leaflight import Cancelled, Progress, read_volume
from leaflight.io import reader_process
from leaflight.io.images import read_pixels
from leaflight.io.readers import probe, watched
from outcomes import reads, refused
from PIL import Image, ImageSequence

AFFINE = np.array([[-2.0, 0, 0, 90], [0, 2.5, 0, -126], [0, 0.5, 3.0, -72], [0, 0, 0, 1]])


def diagonal(volume):
    return np.diag(volume.index_to_world)[:3]


@pytest.mark.parametrize("suffix", [".nii", ".nii.gz"])
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.float32, np.float64])
def test_nifti(tmp_path, values, suffix, dtype):
    path = tmp_path / f"scan{suffix}"
    nibabel.save(nibabel.Nifti1Image(values.T.astype(dtype), AFFINE), path)
    volume = reads(values, path)
    np.testing.assert_allclose(volume.index_to_world, AFFINE)
    assert volume.values.dtype == (np.float32 if dtype is np.float64 else dtype)
    assert volume.values.flags.c_contiguous
    assert volume.name == "scan" and volume.source == str(path)


def test_nifti_2_and_scaled_values(tmp_path, values):
    path = tmp_path / "scan.nii"
    image = nibabel.Nifti2Image(values.T.astype(np.int16), AFFINE)
    image.header.set_slope_inter(0.5, -10)
    nibabel.save(image, path)
    volume = reads(0.5 * values - 10, path)
    assert volume.values.dtype == np.float32


def test_nifti_single_frame_is_3d(tmp_path, values):
    path = tmp_path / "series.nii"
    nibabel.save(nibabel.Nifti1Image(values.T[..., None], AFFINE), path)
    reads(values, path)


def test_colin27(colin27):
    volume = read_volume(colin27)
    assert volume.values.shape == (181, 217, 181)
    assert volume.values.dtype == np.uint8 and volume.field().range == (0.0, 254.0)
    np.testing.assert_array_equal(volume.index_to_world[:3, 3], [-90, -125, -71])


@pytest.mark.parametrize("options", [{}, {"compression": "zlib"}, {"imagej": True}, {"ome": True}])
def test_tiff_stack(tmp_path, values, options):
    path = tmp_path / ("stack.ome.tif" if "ome" in options else "stack.tif")
    options = {"photometric": "minisblack", "metadata": {"axes": "ZYX"}, **options}
    tifffile.imwrite(path, values.astype(np.uint16), **options)
    volume = read_volume(path)
    assert volume.values.dtype == np.uint16
    np.testing.assert_array_equal(volume.values, values)
    np.testing.assert_array_equal(diagonal(volume), [1, 1, 1])
    np.testing.assert_array_equal(diagonal(read_volume(path, spacing=(1, 2, 3))), [1, 2, 3])


@pytest.mark.parametrize("compression", ["tiff_lzw", "zstd", "jpeg", "packbits"])
def test_tiff_as_microscopes_compress_it(tmp_path, values, compression):
    """Checks Pillow's compressed files, for most of which tifffile needs imagecodecs."""
    if not reader_process.has_package("imagecodecs"):
        pytest.skip("imagecodecs is not installed")
    path = tmp_path / "stack.tif"
    pages = [Image.fromarray(page) for page in values.astype(np.uint8)]
    pages[0].save(path, save_all=True, append_images=pages[1:], compression=compression)
    if compression == "jpeg":
        # JPEG is lossy, so compare with Pillow's decoder.
        with Image.open(path) as file:
            values = np.stack([np.asarray(page) for page in ImageSequence.Iterator(file)])
    found = read_volume(path).values.astype(float)
    np.testing.assert_allclose(found, values, rtol=0, atol=1 if compression == "jpeg" else 0)
    assert read_pixels(path).shape == (5, 6)


def test_a_compression_that_cannot_be_decoded(tmp_path, values, monkeypatch):
    monkeypatch.setattr(reader_process, "PACKAGES", [])
    (tmp_path / "imagecodecs.py").write_text("raise ModuleNotFoundError(name='imagecodecs')")
    monkeypatch.syspath_prepend(tmp_path)
    path = tmp_path / "stack.tif"
    pages = [Image.fromarray(page) for page in values.astype(np.uint8)]
    pages[0].save(path, save_all=True, append_images=pages[1:], compression="tiff_lzw")
    assert probe(path).dims == (6, 5, 4)
    refused("stack.tif: .*imagecodecs", read_volume, path)
    refused("stack.tif: .* package imagecodecs, .*; save the", read_pixels, path)


def test_tiff_channel_is_a_frame(tmp_path, values):
    path = tmp_path / "stack.tif"
    channels = np.stack([values, values + 1], axis=1)
    tifffile.imwrite(path, channels, imagej=True, metadata={"axes": "ZCYX"})
    reads(values + 1, path, frame=1)


NRRD_HEADER = """NRRD0004
type: uint16
dimension: 3
sizes: 6 5 4
encoding: {encoding}
endian: big
space: left-posterior-superior
space directions: (0.5,0,0) (0,2,0) (0,0,3)
space origin: (10,20,30)
"""


@pytest.mark.parametrize("encoding", ["raw", "gzip"])
@pytest.mark.parametrize("suffix", [".nrrd", ".nhdr"])
def test_nrrd(tmp_path, values, encoding, suffix):
    data = values.astype(">u2").tobytes()
    data = gzip.compress(data) if encoding == "gzip" else data
    path = tmp_path / f"scan{suffix}"
    header = NRRD_HEADER.format(encoding=encoding)
    if suffix == ".nrrd":
        path.write_bytes(header.encode() + b"\n" + data)
    else:
        path.write_text(header + "data file: scan.bin\n")
        (tmp_path / "scan.bin").write_bytes(data)
    volume = read_volume(path)
    assert volume.values.dtype == np.uint16
    np.testing.assert_array_equal(volume.values, values)
    # For any orientation, lengths and the determinant's magnitude are those of the file.
    lengths = np.linalg.norm(volume.index_to_world[:3, :3], axis=0)
    np.testing.assert_allclose(lengths, [0.5, 2, 3])
    np.testing.assert_allclose(np.abs(volume.index_to_world[:3, 3]), [10, 20, 30])


def test_vdb(box_bake, box_file):
    volume = reads(box_bake.volume.values, box_file)
    np.testing.assert_allclose(volume.index_to_world, box_bake.volume.index_to_world)


def test_missing_data_are_masked(tmp_path, values):
    path = tmp_path / "scan.nii"
    values[1, 2, 3] = np.nan
    nibabel.save(nibabel.Nifti1Image(values.T, AFFINE), path)
    volume = read_volume(path)
    assert volume.field().masked
    np.testing.assert_array_equal(volume.values, values)


def test_a_reading_is_cancelled_halfway(tmp_path, monkeypatch):
    image = nibabel.Nifti1Image(np.zeros((200, 200, 200), np.uint8), np.eye(4))
    nibabel.save(image, tmp_path / "x.nii.gz")
    progress, read, shares = Progress(), watched._Watched.readinto, []

    def cancels(file, buffer):
        shares.append(progress.fraction)
        if progress.fraction > 0.05:
            progress.cancel()
        return read(file, buffer)

    monkeypatch.setattr(watched, "_MOST", 1 << 8)
    monkeypatch.setattr(watched._Watched, "readinto", cancels)
    with pytest.raises(Cancelled):
        read_volume(tmp_path / "x.nii.gz", progress=progress)
    assert 0 < shares[-1] < 0.5
