# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests NumPy's arrays and OME-TIFF."""

import numpy as np
import pytest
import tifffile
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written
from scipy.ndimage import gaussian_filter


@pytest.mark.parametrize("dtype", ["u1", ">i2", "<f8", "?"])
@pytest.mark.parametrize("order", "CF")
@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_npy(tmp_path, values, dtype, order, version):
    array = (values > 60 if dtype == "?" else values).astype(dtype, order=order)
    path = tmp_path / "x.npy"
    with open(path, "wb") as file:
        np.lib.format.write_array(file, array, version)
    stored = probe(path, spacing=(1, 2, 3))
    assert (stored.dims, stored.voxel_size) == ((6, 5, 4), (1, 2, 3))
    volume = reads(array, path, spacing=2)
    assert np.diag(volume.index_to_world).tolist() == [2, 2, 2, 1]
    assert stored.bytes() == volume.values.nbytes


def test_what_was_read_does_not_follow_its_file(tmp_path, values):
    path = tmp_path / "x.npy"
    np.save(path, values)
    volume = read_volume(path)
    np.save(path, values + 1)
    np.testing.assert_array_equal(volume.values, values)


def test_npz(tmp_path, values):
    path = tmp_path / "x.npz"
    np.savez(path, times=np.arange(3), h=values)
    reads(values, path)
    np.savez_compressed(path, g=values + 1, h=np.stack([values, values + 2]), name="text")
    assert set(probe(path).datasets) == {"g", "h"}
    refused("2 volumes.* g, h", read_volume, path)
    reads(values + 1, path, dataset="g")
    reads(values + 2, path, dataset="h", frame=1)


def test_damaged_npy(tmp_path, values):
    path = tmp_path / "x.npy"
    np.save(path, values)
    whole = path.read_bytes()
    for broken, sentence in (
        (whole[:-1], "claims"),
        (whole.replace(b"(4, 5, 6)", b"(9,99,99)"), "claims"),
        (b"text", "readable NumPy file"),
    ):
        refused(sentence, read_volume, written(path, broken))
    np.save(path, np.array([{}], dtype=object))
    refused("Python objects", read_volume, path)
    np.save(path, values[:0])
    refused("empty", read_volume, path)
    np.save(path, values[0])
    refused("three dimensions", read_volume, path)


def test_ome_tiff_of_five_dimensions(tmp_path, values):
    """Checks that times and channels are distinguished, and that only chosen pages are read."""
    path = tmp_path / "x.ome.tif"
    whole = np.stack([np.stack([values + 10 * t + c for c in range(2)]) for t in range(3)])
    metadata = {"axes": "TCZYX", "PhysicalSizeX": 0.5, "PhysicalSizeY": 1, "PhysicalSizeZ": 2}
    tifffile.imwrite(path, whole, ome=True, metadata=metadata, compression="zlib")
    stored = probe(path)
    assert (stored.dims, stored.frames, stored.channels) == ((6, 5, 4), 3, 2)
    assert (stored.voxel_size, stored.unit) == ((0.5, 1, 2), "µm")
    reads(values + 21, path, frame=2, channel=1)
    refused("3 frames.* 0..2", read_volume, path)
    refused("2 channels.* 0..1", read_volume, path, frame=1)


def test_tiff_of_times_and_channels_without_a_depth(tmp_path, values):
    """Checks that time becomes the depth, as in a film."""
    path = tmp_path / "x.ome.tif"
    both = np.stack([values, values + 1], axis=1)
    tifffile.imwrite(path, both, ome=True, metadata={"axes": "TCYX"})
    reads(values + 1, path, channel=1)


def test_smoothing(tmp_path):
    """Checks against SciPy. Voxels without data get no weight."""
    values = np.random.default_rng(5).integers(0, 255, (9, 8, 12)).astype(np.uint8)
    path = tmp_path / "x.npy"
    np.save(path, values)
    smooth = read_volume(path, smooth=1.2)
    options = {"sigma": 1.2, "mode": "nearest", "truncate": 3.0}
    expected = gaussian_filter(values.astype(np.float64), **options)
    np.testing.assert_allclose(smooth.values, expected, atol=1e-3)
    assert smooth.source == f"{path}, smoothed by 1.2 voxels"
    holes = np.where(np.random.default_rng(6).random(values.shape) < 0.2, np.nan, values)
    np.save(path, holes)
    known = np.isfinite(holes)
    weight = gaussian_filter(known.astype(np.float64), **options)
    expected = np.where(known, gaussian_filter(np.nan_to_num(holes), **options) / weight, np.nan)
    np.testing.assert_allclose(read_volume(path, smooth=1.2).values, expected, atol=1e-3)
    refused("not -1", read_volume, path, smooth=-1.0)


def test_downsampling(tmp_path):
    """Checks means of eight voxels, rounded for integers; incomplete blocks are dropped."""
    values = np.random.default_rng(3).integers(0, 255, (9, 8, 12)).astype(np.uint8)
    path = tmp_path / "x.npy"
    np.save(path, values)
    half = read_volume(path, downsample=2, spacing=(1, 2, 3))
    assert half.values.dtype == np.uint8 and probe(path).bytes(2) == half.values.nbytes
    exact = values[:8].reshape(4, 2, 4, 2, 6, 2).mean((1, 3, 5))
    np.testing.assert_array_equal(half.values, np.rint(exact))
    # A voxel is at the center of those that it averages.
    np.testing.assert_array_equal(half.index_to_world @ [0, 0, 0, 1], [0.5, 1.0, 1.5, 1])
    np.testing.assert_array_equal(half.index_to_world @ [1, 1, 1, 1], [2.5, 5, 7.5, 1])
    np.save(path, values.astype(np.float32))
    np.testing.assert_allclose(read_volume(path, downsample=2).values, exact, rtol=1e-6)
    refused("average 8", read_volume, path, downsample=8)
    refused("one of 1, 2, 4, 8", read_volume, path, downsample=3)
