# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests HDF5 of vigra, ilastik, BigDataViewer, Imaris, NeXus and netCDF-4, written by h5py."""

import json
from importlib.util import find_spec

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import hdf5, probe
from outcomes import reads, refused, written

h5py = pytest.importorskip("h5py")
LZO, BITSHUFFLE = 305, 32008


class Within:
    """A ReaderProcess that calls the function in this process, which is ten times faster."""

    def __init__(self, path, _kind, _module, function, *options):
        from leaflight.io.readers import hdf5_process

        options = json.loads(json.dumps(options))
        self._answer, self._pieces = getattr(hdf5_process, function)(path, *options)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def answer(self):
        return json.loads(json.dumps(self._answer))

    def fill(self, values, _progress):
        read = b"".join(piece.data for piece in self._pieces)
        values.view(np.uint8).reshape(-1)[:] = np.frombuffer(read, np.uint8)


@pytest.fixture
def within(monkeypatch):
    monkeypatch.setattr(hdf5, "ReaderProcess", Within)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "x.h5"


quick = pytest.mark.usefixtures("within")


def test_hdf5(path, values):
    with h5py.File(path, "w") as file:
        file["a/h"] = values[None]
        file["a/h"].attrs["element_size_um"] = (3.0, 2.0, 1.0)
        file["times"] = np.arange(3)
    stored = probe(path)
    assert (stored.dims, stored.voxel_size, stored.unit) == ((6, 5, 4), (1, 2, 3), "µm")
    reads(values, path)
    with h5py.File(path, "a") as file:
        packed = np.stack([values, values + 1])
        file.create_dataset("g", data=packed, chunks=True, compression="gzip")
    assert probe(path).datasets == ("a/h", "g")
    reads(values + 1, path, dataset="g", frame=1)
    half = read_volume(path, dataset="g", frame=1, downsample=2)
    np.testing.assert_allclose(half.values[0, 0, 0], values[:2, :2, :2].mean() + 1, rtol=1e-6)
    refused("2 volumes.* a/h, g", read_volume, path)
    path.write_bytes(path.read_bytes()[:-100])
    refused("x.h5: .*damaged", read_volume, path, dataset="g", frame=1)
    with h5py.File(path, "w") as file:
        file["times"] = np.arange(3)
    refused("real numbers", read_volume, path)


def tags(keys, **resolutions):
    axes = [
        {"key": key, "typeFlags": 1 if key == "c" else 2, "resolution": resolutions.get(key, 0)}
        for key in keys
    ]
    return json.dumps({"axes": axes})


@pytest.mark.parametrize("keys", ["zyxc", "xyzc", "tzyxc", "cxyz"])
@quick
def test_axistags_of_vigra_and_ilastik(path, values, keys):
    both = np.stack([values, values + 1])[None]
    order = ["tczyx".index(key) for key in keys]
    data = both.transpose([*order, *(place for place in range(5) if place not in order)])
    with h5py.File(path, "w") as file:
        file["exported_data"] = data.squeeze()[None] if keys[0] == "t" else data.squeeze()
        about = file["exported_data"].attrs
        about["axistags"] = tags(keys, z=2.5, y=0.9, x=1.2)
        about["axis_units"] = json.dumps({"z": "nm", "y": "nm", "x": "nm"})
    stored = probe(path)
    assert (stored.dims, stored.channels, stored.frames) == ((6, 5, 4), 2, 1)
    assert (stored.voxel_size, stored.unit) == ((1.2, 0.9, 2.5), "nm")
    reads(values + 1, path, channel=1)


@quick
def test_which_axes_hold_a_volume(path):
    """Checks how axes are found: by tags, by labels, or by order."""
    cases = {
        # shape, tags, labels: frames, channels, dims as z, y, x
        "film": ((7, 5, 6), "tyx", None, (1, 1, [7, 5, 6])),
        "color": ((5, 6, 3), "yxc", None, None),
        "flat": ((1, 5, 6, 1), "zyxc", None, None),
        "labels": ((6, 5, 4, 2), None, ("x", "y", "z", "channel"), (1, 2, [4, 5, 6])),
        "plain": ((3, 1, 4, 5, 6), None, None, (3, 1, [4, 5, 6])),
        "last": ((7, 5, 6, 3), None, None, (1, 3, [7, 5, 6])),
        "five": ((3, 2, 4, 5, 6), None, None, (3, 2, [4, 5, 6])),
        "six": ((3, 2, 2, 4, 5, 6), None, None, None),
        "wrong": ((4, 5, 6), "zyxc", None, (1, 1, [4, 5, 6])),
        "twice": ((4, 5, 6), None, ("x", "x", "x"), (1, 1, [4, 5, 6])),
        "miller": ((4, 5, 6), None, ("h", "k", "l"), (1, 1, [6, 5, 4])),
    }
    with h5py.File(path, "w") as file:
        for name, (shape, keys, labels, _) in cases.items():
            data = file.create_dataset(name, shape, "i2")
            if keys:
                data.attrs["axistags"] = tags(keys)
            for place, label in enumerate(labels or ()):
                data.dims[place].label = label
    from leaflight.io.readers.hdf5_process import list_images

    found = list_images(path, None)[0]["images"]
    for name, (*_, expected) in cases.items():
        image = found.get(name)
        assert (image is not None) == (expected is not None), name
        if image:
            assert (image["frames"], image["channels"], image["levels"][0]["dims"]) == expected
            assert bool(image["notes"]) == (name in ("film", "last", "five")), name


@quick
def test_sizes_of_other_programs(path, values):
    with h5py.File(path, "w") as file:
        file["raw"] = values
        file["raw"].attrs["resolution"] = (40.0, 4.0, 4.0)
    volume = read_volume(path)
    assert volume.spacing == (4, 4, 40) and volume.unit == ""
    assert "attribute resolution, in the order z, y, x" in volume.notes[0]


def big_data_viewer(path, values, xml=True):
    """Writes two setups at two times, each at two levels."""
    with h5py.File(path, "w") as file:
        for setup in range(2):
            file[f"s{setup:02}/resolutions"] = np.array([[1, 1, 1], [2, 2, 1]], np.float64)
            file[f"s{setup:02}/subdivisions"] = np.full((2, 3), 16, np.int32)
            for time in range(2):
                for level, data in enumerate((values, values[:, ::2, ::2])):
                    data = (data + time + 10 * setup).astype(np.uint16)
                    file[f"t{time:05}/s{setup:02}/{level}/cells"] = data.view(np.int16)
    setups = "".join(
        f"<ViewSetup><id>{setup}</id><size>6 4 4</size><voxelSize><unit>micrometer</unit>"
        f"<size>0.5 0.5 {setup + 2}</size></voxelSize></ViewSetup>"
        for setup in range(2)
    )
    if xml:
        text = f"<SpimData><SequenceDescription><ViewSetups>{setups}</ViewSetups>"
        path.with_suffix(".xml").write_text(f"{text}</SequenceDescription></SpimData>")


@quick
def test_big_data_viewer(path, values):
    values = values[:, :4].astype(np.uint16) + 50_000
    big_data_viewer(path, values)
    refused("2 volumes.* s00, s01", read_volume, path)
    stored = probe(path, dataset="s01")
    assert (stored.frames, stored.levels) == (2, ((6, 4, 4), (3, 2, 4)))
    assert (stored.voxel_size, stored.unit) == ((0.5, 0.5, 3), "µm")
    volume = reads(values + 11, path, dataset="s01", frame=1)
    assert volume.values.dtype == np.uint16
    coarse = reads(values[:, ::2, ::2] + 11, path, dataset="s01", frame=1, level=1)
    matrix = np.c_[np.diag([1, 1, 3]), [0.25, 0.25, 0]]
    np.testing.assert_allclose(coarse.index_to_world[:3], matrix)
    refused("level 2.* 0..1", read_volume, path, dataset="s01", frame=1, level=2)


@quick
def test_an_array_of_big_data_viewer_by_its_path(path, values):
    values = values[:, :4].astype(np.uint16) + 50_000
    big_data_viewer(path, values, xml=False)
    volume = reads(values[:, ::2, ::2] + 1, path, dataset="/t00001/s00/1/cells")
    assert volume.spacing == (2, 2, 1) and volume.unit == ""


@quick
def test_signed_numbers_of_other_programs_stay_so(path, values):
    with h5py.File(path, "w") as file:
        file["t00000/s00/cells"] = values.astype(np.int16) - 300
    assert read_volume(path).values.min() == values.min() - 300


def imaris(path, values):
    """Writes two times and channels at two levels; chunks, and so arrays, exceed the image."""
    with h5py.File(path, "w") as file:

        def write(item, **texts):
            for name, text in texts.items():
                item.attrs[name] = np.frombuffer(str(text).encode(), "S1")

        nz, ny, nx = values.shape
        write(file, DataSetDirectoryName="DataSet", DataSetInfoDirectoryName="DataSetInfo")
        info = file.create_group("DataSetInfo/Image")
        write(info, X=nx, Y=ny, Z=nz, Unit="um", ExtMin0=10, ExtMin1=0, ExtMin2="-5.000")
        write(info, ExtMax0=10 + 0.5 * nx, ExtMax1=ny, ExtMax2=-5 + 2 * nz)
        for level, time, channel in np.ndindex(2, 2, 2):
            name = f"DataSet/ResolutionLevel {level}/TimePoint {time}/Channel {channel}"
            part = values[:, :: level + 1, :: level + 1] + 10 * time + channel
            group = file.create_group(name)
            write(group, **dict(zip(("ImageSizeZ", "ImageSizeY", "ImageSizeX"), part.shape)))
            data = group.create_dataset("Data", (8, 8, 8), "u2", chunks=(8, 8, 8), fillvalue=999)
            data[tuple(slice(n) for n in part.shape)] = part
        file["Thumbnail/Data"] = np.zeros((8, 8), np.uint8)


@quick
def test_imaris(tmp_path, values):
    values = values[:, :4].astype(np.uint16)
    path = tmp_path / "x.ims"
    imaris(path, values)
    stored = probe(path)
    assert (stored.dims, stored.frames, stored.channels) == ((6, 4, 4), 2, 2)
    assert (stored.voxel_size, stored.unit) == ((0.5, 1, 2), "µm")
    volume = reads(values + 11, path, frame=1, channel=1)
    np.testing.assert_allclose(volume.index_to_world[:3, 3], [10, 0, -5])
    coarse = reads(values[:, ::2, ::2] + 10, path, frame=1, channel=0, level=1)
    assert coarse.spacing == (1, 2, 2)
    # A coarse voxel is at the center of those that it averages.
    np.testing.assert_allclose(coarse.index_to_world[:3, 3], [10.25, 0.5, -5])


def nexus(path, values, style="default"):
    """Writes counts [x, y, z] with positions, beside a raw array."""
    with h5py.File(path, "w") as file:
        data = file.create_group("entry/plot")
        data.attrs["NX_class"] = "NXdata"
        nz, ny, nx = values.shape
        data["x"], data["y"] = 3 + 1.5 * np.arange(nx), np.arange(ny) * 0.5
        # Write the edges between slices.
        data["z"] = 2000.0 * np.arange(nz + 1)
        for name, unit in zip("xyz", ("um", b"micron", "nm")):
            data[name].attrs["units"] = unit
        file["entry/instrument/raw"] = values[:3]
        file["entry/instrument/counts"] = values.T
        data["counts"] = h5py.SoftLink("/entry/instrument/counts")
        if style == "default":
            file.attrs["default"], file["entry"].attrs["default"] = "entry", "plot"
        if style == "old":
            data["counts"].attrs["signal"], data["counts"].attrs["axes"] = 1, "x:y:z"
        else:
            data.attrs["signal"], data.attrs["axes"] = "counts", ["x", "y", "z"]


@pytest.mark.parametrize("style", ["default", "old", "single"])
@quick
def test_nexus(tmp_path, values, style):
    path = tmp_path / "x.nxs"
    nexus(path, values, style)
    volume = reads(values, path)
    assert volume.unit == "µm"
    # The file stores edges along z; voxels lie at their midpoints.
    matrix = [[1.5, 0, 0, 3], [0, 0.5, 0, 0], [0, 0, 2, 1]]
    np.testing.assert_allclose(volume.index_to_world[:3], matrix)
    assert volume.notes == ("This is entry/plot/counts, the default of the 2 volumes in the file.",)
    reads(values[:3], path, dataset="entry/instrument/raw")
    assert probe(path).datasets == ("entry/instrument/raw", "entry/plot/counts")


def scaled(path, values, names="zyx", **units):
    """Returns an array with dimension scales, as netCDF-4 has them."""
    steps = {"z": 2.5, "y": 0.9, "x": 1.2}
    with h5py.File(path, "w") as file:
        data = file.create_dataset("temperature", data=values)
        for place, name in enumerate(names):
            file[name] = 10 + steps.get(name, 1.0) * np.arange(values.shape[place])
            file[name].make_scale(name)
            file[name].attrs["units"] = units.get(name, "um")
            data.dims[place].attach_scale(file[name])
    return path


@quick
def test_dimension_scales(path, values):
    volume = reads(values, scaled(path, values))
    assert volume.unit == "µm" and volume.notes == ()
    matrix = np.c_[np.diag([1.2, 0.9, 2.5]), [10, 10, 10]]
    np.testing.assert_allclose(volume.index_to_world[:3], matrix)
    scaled(path, values.transpose(2, 0, 1), "xzy", z="nm", x="mm")
    with h5py.File(path, "a") as file:
        file["y"][:] = 20 - file["y"][:]
        file["z"][1] -= 1.5
    volume = reads(values, path)
    assert volume.unit == "mm"
    np.testing.assert_allclose(np.diag(volume.index_to_world)[:3], [1.2, -9e-4, 2.5e-6])
    assert len(volume.notes) == 1 and "along z are unevenly spaced" in volume.notes[0]
    assert read_volume(path, spacing=3).spacing == (3, 3, 3)


@quick
def test_missing_data(path, values):
    """Fill values are missing data, and packed values are unpacked."""
    holes = values.astype(np.float32)
    holes[1, 2, 3:5] = -9999
    scaled(path, holes)
    with h5py.File(path, "a") as file:
        file["temperature"].attrs["_FillValue"] = -9999.0
    volume = reads(np.where(holes < 0, np.nan, holes), path)
    assert volume.notes == ("2 of the voxels are missing data, which the file marks by -9999.",)
    scaled(path, values.astype(np.int16))
    with h5py.File(path, "a") as file:
        about = file["temperature"].attrs
        about["scale_factor"], about["add_offset"] = np.float32(0.5), 100.0
        about["missing_value"] = np.int16(values[0, 0, 0])
    volume = read_volume(path)
    assert volume.values.dtype == np.float32 == probe(path).dtype
    expected = np.where(values == values[0, 0, 0], np.nan, values * 0.5 + 100)
    np.testing.assert_allclose(volume.values, expected)


@quick
def test_absent_chunks_hold_no_chance_values(path):
    """Checks that absent chunks of a file without a fill value are 0."""
    with h5py.File(path, "w") as file:
        how = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        how.set_chunk((2, 16, 16))
        how.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
        space = h5py.h5s.create_simple((64, 16, 16))
        data = h5py.Dataset(h5py.h5d.create(file.id, b"h", h5py.h5t.NATIVE_FLOAT, space, how))
        data[:2] = 5.0
    values = read_volume(path).values
    assert (values[:2] == 5).all() and (values[2:] == 0).all()


def packed(path, code, values):
    """Writes an array with an optional filter, whose chunks are stored without it."""
    with h5py.File(path, "w") as file:
        how = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        how.set_chunk(values.shape)
        how.set_filter(code, h5py.h5z.FLAG_OPTIONAL, ())
        space = h5py.h5s.create_simple(values.shape)
        data = h5py.h5d.create(file.id, b"h", h5py.h5t.STD_I16LE, space, how)
        data.write_direct_chunk((0, 0, 0), values.astype("<i2").tobytes())


def test_filters_that_are_not_at_hand(path, values):
    packed(path, LZO, values)
    assert probe(path).dims == (6, 5, 4)
    refused(r"by the HDF5 filter LZO \(305\), .*h5repack", read_volume, path)
    packed(path, BITSHUFFLE, values)
    if find_spec("hdf5plugin") is None:
        refused(r"filter bitshuffle \(32008\).* needs the .*package hdf5plugin", read_volume, path)


def test_filters_of_hdf5plugin(path, values):
    hdf5plugin = pytest.importorskip("hdf5plugin")
    for kind in (hdf5plugin.Bitshuffle, hdf5plugin.Blosc, hdf5plugin.LZ4, hdf5plugin.Zstd):
        with h5py.File(path, "w") as file:
            file.create_dataset("h", data=values, chunks=(2, 5, 6), **kind())
        reads(values, path)


@quick
def test_values_in_other_files(tmp_path, path, values):
    other = tmp_path / "part.h5"
    with h5py.File(other, "w") as file:
        file["h"] = values
    layout = h5py.VirtualLayout((4, 5, 6), values.dtype)
    layout[:] = h5py.VirtualSource("part.h5", "h", (4, 5, 6))
    with h5py.File(path, "w") as file:
        file.create_virtual_dataset("whole", layout)
        file["link"] = h5py.ExternalLink("part.h5", "h")
    reads(values, path, dataset="whole")
    reads(values, path, dataset="link")
    other.unlink()
    # HDF5 itself would read zeros.
    refused("'part.h5'", read_volume, path)
    with h5py.File(tmp_path / "linked.h5", "w") as file:
        file["link"] = h5py.ExternalLink("part.h5", "h")
    refused("'part.h5'", read_volume, tmp_path / "linked.h5")
    (tmp_path / "folder").mkdir()
    with h5py.File(tmp_path / "folder" / "x.h5", "w") as file:
        file["link"] = h5py.ExternalLink("../x.h5", "h")
    refused("outside .* folder", read_volume, tmp_path / "folder" / "x.h5")


def test_hdf4_is_no_hdf5(tmp_path):
    path = written(tmp_path / "x.hdf", b"\x0e\x03\x13\x01" + bytes(100))
    refused("HDF4", read_volume, path)
