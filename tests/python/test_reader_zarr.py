# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests OME-Zarr and plain Zarr, written by zarr 2 or 3, whichever is installed."""

import json

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused

zarr = pytest.importorskip("zarr")
_ZARR = int(zarr.__version__.partition(".")[0])
ZARR_2 = {"zarr_format": 2} if _ZARR > 2 else {}


def ome_zarr(path, values):
    """Writes two channels at two levels, in OME-NGFF 0.4; the second level is half as fine."""
    group = zarr.open_group(str(path), mode="w", **ZARR_2)
    levels = [np.stack([values, values + 1])]
    levels.append(levels[0].reshape(2, 2, 2, 2, 2, 3, 2).mean((2, 4, 6)).astype(values.dtype))
    datasets = []
    for number, level in enumerate(levels):
        group.create_dataset(str(number), data=level, shape=level.shape, chunks=(1, 2, 4, 4))
        scale = {"type": "scale", "scale": [1.0] + [size * 2**number for size in (4, 2, 1)]}
        place = {"type": "translation", "translation": [0.0] + [0.5 * number] * 3}
        datasets.append({"path": str(number), "coordinateTransformations": [scale, place]})
    axes = [{"name": "c", "type": "channel"}]
    axes += [{"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"]
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": datasets}]
    return path


def test_ome_zarr(tmp_path, values):
    values = values[:, :4].copy()
    path = ome_zarr(tmp_path / "x.ome.zarr", values)
    stored = probe(path)
    assert (stored.dims, stored.channels, stored.unit) == ((6, 4, 4), 2, "µm")
    assert stored.levels == ((6, 4, 4), (3, 2, 2)) and stored.voxel_size == (1, 2, 4)
    volume = reads(values + 1, path, channel=1)
    assert volume.name == "x"
    coarse = read_volume(path, channel=0, level=1)
    assert coarse.values.shape == (2, 2, 3) and probe(path, level=1).dims == (3, 2, 2)
    np.testing.assert_array_equal(np.diag(coarse.index_to_world), [2, 4, 8, 1])
    np.testing.assert_array_equal(coarse.index_to_world[:3, 3], [0.5] * 3)
    refused("level 2.* 0..1", read_volume, path, level=2, channel=0)
    refused("2 channels.* 0..1", read_volume, path)
    # Without its suffix, its contents identify it.
    path.rename(tmp_path / "plain")
    reads(values, tmp_path / "plain", channel=0)
    (tmp_path / "plain" / ".zattrs").write_text("{}")
    refused("no multiscale OME-Zarr image", read_volume, tmp_path / "plain")
    reads(values + 1, tmp_path / "plain" / "0", frame=1)


def image(path, values, axes, scale, name="", **extra):
    """Writes one level of Zarr 2 in OME-NGFF 0.4; axes: of its metadata."""
    group = zarr.open_group(str(path / name) if name else str(path), mode="w", **ZARR_2)
    group.create_dataset("0", data=values, shape=values.shape, chunks=(2,) * values.ndim)
    step = {"type": "scale", "scale": scale}
    datasets = [{"path": "0", "coordinateTransformations": [step]}]
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": datasets, **extra}]
    return path


def space(**units):
    return [{"name": name, "type": "space", "unit": unit} for name, unit in units.items()]


@pytest.mark.parametrize(
    "units, unit, sizes",
    [
        # Units and sizes are in the order of the file: z, y, x.
        (("nanometer", "micrometer", "micrometer"), "µm", (1.2, 0.9, 2.5e-3)),
        (("micrometer", "nanometer", "nanometer"), "nm", (1.2, 0.9, 2500)),
        (("um", "\u03bcm", "micron"), "µm", (1.2, 0.9, 2.5)),
        (("", "millimetre", ""), "mm", (1.2, 0.9, 2.5)),
        (("decimeter", "centimeter", "inch"), "cm", (1.2 * 2.54, 0.9, 25)),
        (("picometer",) * 3, "Å", (0.012, 0.009, 0.025)),
        (("pixel",) * 3, "", (1.2, 0.9, 2.5)),
        # These have no common unit.
        (("second", "micrometer", "micrometer"), "", (1, 1, 1)),
    ],
)
def test_each_axis_has_its_unit(tmp_path, values, units, unit, sizes):
    axes = space(**dict(zip("zyx", units)))
    path = image(tmp_path / "x.zarr", values, axes, [2.5, 0.9, 1.2])
    stored = probe(path)
    assert stored.unit == unit
    np.testing.assert_allclose(stored.voxel_size, sizes, rtol=1e-12)
    assert bool(stored.notes) == (units in (("", "millimetre", ""), ("second",) + units[1:]))


def test_a_translation_is_in_the_unit_of_its_axis(tmp_path, values):
    place = {"type": "translation", "translation": [3000, 2, 1]}
    shear = {"type": "affine", "affine": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]}
    axes = space(z="nanometer", y="micrometer", x="micrometer")
    changes = {"coordinateTransformations": [place, shear]}
    path = image(tmp_path / "x.zarr", values, axes, [500, 1, 1], **changes)
    volume = read_volume(path)
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [1, 2, 3])
    np.testing.assert_allclose(volume.spacing, [1, 1, 0.5])
    assert volume.notes == ("The transformation 'affine' is ignored.",)


def test_axes_in_any_order(tmp_path, values):
    whole = np.stack([values.T, values.T + 1], axis=1)
    axes = [*space(X="micrometer"), {"name": "marker", "type": "channel"}]
    axes += space(Y="micrometer", Z="micrometer")
    path = image(tmp_path / "x.zarr", whole, axes, [1, 1, 2, 3])
    reads(values + 1, path, channel=1)
    assert probe(path).voxel_size == (1, 2, 3)
    axes = space(t="", c="", z="", y="", x="")
    path = image(tmp_path / "y.zarr", values[None, None], axes, [1] * 5)
    reads(values, path)
    path = image(tmp_path / "z.zarr", values[:1], space(z="", y="", x=""), [1] * 3)
    refused("z 1, y 5, x 6", read_volume, path)


def test_a_codec_that_is_not_at_hand(tmp_path, values):
    path = image(tmp_path / "x.zarr", values, space(z="", y="", x=""), [1, 1, 1])
    metadata = json.loads((path / "0" / ".zarray").read_text())
    metadata["compressor"] = {"id": "packed_by_nobody"}
    (path / "0" / ".zarray").write_text(json.dumps(metadata))
    refused("compressed by the codec packed_by_nobody, which", read_volume, path)


@pytest.mark.parametrize("fill", [None, 0, 7])
def test_absent_chunks_are_the_fill_value(tmp_path, fill):
    """Checks absent chunks with and without a fill value; without one they are 0."""
    path = tmp_path / "x.zarr"
    options = {"mode": "w", "chunks": (2, 4, 4), "dtype": "f4", "fill_value": fill, **ZARR_2}
    array = zarr.open(str(path), shape=(64, 8, 8), **options)
    array[:2] = 5.0
    expected = np.full((64, 8, 8), fill or 0, np.float32)
    expected[:2] = 5
    for _ in range(8):
        np.full(expected.shape, 777.0, np.float32)
        reads(expected, path)


def test_a_folder_of_images(tmp_path, values):
    """Checks a folder that bioformats2raw writes."""
    path = tmp_path / "x.zarr"
    root = zarr.open_group(str(path), mode="w", **ZARR_2)
    root.attrs["bioformats2raw.layout"] = 3
    axes = space(z="", y="", x="")
    image(path, values, axes, [1, 1, 1], "0")
    reads(values, path)
    image(path, values + 1, axes, [1, 1, 2], "1")
    assert probe(path).datasets == ("0", "1")
    refused("2 volumes.* 0, 1", read_volume, path)
    reads(values + 1, path, dataset="1")


def test_names_of_a_plain_array(tmp_path, values):
    """Checks the names that xarray writes."""
    path = tmp_path / "x.zarr"
    array = zarr.open(str(path), mode="w", shape=values.T.shape, dtype=values.dtype, **ZARR_2)
    array[:] = values.T
    array.attrs["_ARRAY_DIMENSIONS"] = ["x", "y", "z"]
    reads(values, path)


@pytest.mark.skipif(_ZARR < 3, reason="zarr 2 does not write Zarr 3")
def test_shards(tmp_path, values):
    """Checks shards of which some are absent, and some lack chunks."""
    path = tmp_path / "x.zarr"
    group = zarr.open_group(str(path), mode="w", zarr_format=3)
    about = {"shape": (16, 8, 8), "chunks": (2, 4, 4), "shards": (4, 8, 8), "dtype": "i2"}
    array = group.create_array("s0", fill_value=-3, **about)
    expected = np.full((16, 8, 8), -3, np.int16)
    expected[5, :, 6] = np.arange(8)
    array[5, :, 6] = np.arange(8)
    axes = space(z="nanometer", y="micrometer", x="micrometer")
    scale = {"type": "scale", "scale": [9, 1, 2]}
    datasets = [{"path": "s0", "coordinateTransformations": [scale]}]
    group.attrs["ome"] = {"version": "0.5", "multiscales": [{"axes": axes, "datasets": datasets}]}
    volume = reads(expected, path)
    np.testing.assert_allclose(volume.spacing, [2, 1, 0.009])
    metadata = json.loads((path / "zarr.json").read_text())
    metadata["attributes"]["ome"]["multiscales"][0]["axes"].pop()
    (path / "zarr.json").write_text(json.dumps(metadata))
    refused("2 axes, .* 3", read_volume, path)


def test_an_array_of_xarray_is_unpacked(tmp_path):
    xarray = pytest.importorskip("xarray")
    values = np.random.default_rng(2).integers(0, 900, (4, 5, 6)) * 0.5 + 100
    values[0, :2] = np.nan
    packed = {"dtype": "i2", "scale_factor": 0.5, "add_offset": 100.0, "_FillValue": -9}
    data = xarray.Dataset({"p": (("z", "y", "x"), values)})
    data.to_zarr(tmp_path / "x.zarr", encoding={"p": packed})
    reads(values, tmp_path / "x.zarr" / "p")
