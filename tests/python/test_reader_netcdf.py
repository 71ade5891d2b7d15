# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests netCDF: the classic format written by SciPy, and version 4 by h5py."""

import numpy as np
import pytest
from leaflight import read_volume
from leaflight.io.readers import probe
from outcomes import reads, refused, written
from scipy.io import netcdf_file


def classic(path, values, dimensions, version=1, **attributes):
    """Writes a variable "h" with coordinates: {name: (coordinates or None, attributes)}."""
    with netcdf_file(str(path), "w", version=version) as file:
        for (name, (places, about)), size in zip(dimensions.items(), values.shape):
            file.createDimension(name, None if name == "time" else size)
            if places is not None:
                one = file.createVariable(name, np.asarray(places).dtype, (name,))
                one[:] = places
                for key, text in about.items():
                    setattr(one, key, text)
        data = file.createVariable("h", values.dtype, tuple(dimensions))
        data[:] = values
        for key, value in attributes.items():
            setattr(data, key, value)
    return path


def even(step, size, first=0.0):
    return first + step * np.arange(size, dtype=np.float32)


@pytest.mark.parametrize("version", [1, 2])
def test_a_classic_file(tmp_path, values, version):
    """Checks a classic file with times as frames and a depth that increases downwards."""
    dimensions = {
        "time": (np.arange(2, dtype=np.int32), {"units": "days since 1900-01-01"}),
        "depth": (even(10, 4), {"units": "m", "positive": "down"}),
        "y": (even(0.5, 5), {"units": "km", "standard_name": "projection_y_coordinate"}),
        "x": (even(0.25, 6, 100), {"units": "km"}),
    }
    path = classic(tmp_path / "x.nc", np.stack([values, values + 1]), dimensions, version)
    stored = probe(path)
    assert (stored.dims, stored.frames, stored.unit) == ((6, 5, 4), 2, "m")
    volume = reads(values + 1, path, frame=1)
    matrix = [[250, 0, 0, 1e5], [0, 500, 0, 0], [0, 0, -10, 0]]
    np.testing.assert_allclose(volume.index_to_world[:3], matrix)
    assert volume.notes == ()


def test_degrees_are_no_lengths(tmp_path, values):
    dimensions = {
        "plev": (even(-100, 4, 1000), {"units": "hPa"}),
        "lat": (even(-2, 5, 90), {"units": "degrees_north"}),
        "lon": (even(2, 6), {"units": "degrees_east"}),
    }
    path = classic(tmp_path / "x.nc", values, dimensions)
    volume = read_volume(path)
    # Pressure decreases upwards, and the first latitude is the northernmost.
    assert np.diag(volume.index_to_world).tolist() == [1, -1, 1, 1] and volume.unit == ""
    assert "degrees, degrees, hPa, cannot be compared" in volume.notes[0]
    assert read_volume(path, spacing=(3, 2, 1)).spacing == (3, 2, 1)


def test_several_variables_and_axes_without_places(tmp_path, values):
    path = classic(tmp_path / "x.nc", values, {"a": (None, {}), "b": (None, {}), "c3": (None, {})})
    reads(values, path)
    with netcdf_file(str(path), "a") as file:
        file.createVariable("g", "f4", ("a", "b", "c3"))[:] = values + 1
    refused("2 volumes.* g, h", read_volume, path)
    reads(values + 1, path, dataset="g")


def test_packed_and_missing_values(tmp_path, values):
    stored = values.astype(np.int16)
    stored[1, 1, 1] = -99
    dimensions = {name: (even(1, n), {"units": "um"}) for name, n in zip("zyx", stored.shape)}
    about = {"scale_factor": 0.5, "add_offset": 100.0, "_FillValue": np.int16(-99)}
    path = classic(tmp_path / "x.nc", stored, dimensions, **about)
    assert probe(path).dtype == np.float32
    volume = read_volume(path)
    np.testing.assert_allclose(volume.values, np.where(stored == -99, np.nan, 0.5 * stored + 100.0))
    assert volume.notes == ("1 of the voxels are missing data, which the file marks by -99.",)
    path = classic(tmp_path / "x.nc", (values + 100).astype(np.int8), dimensions, _Unsigned="true")
    reads(values + 100, path)


def test_packed_places(tmp_path, values):
    """Checks coordinates that are packed as in files of GOES-R, in both formats."""
    h5py = pytest.importorskip("h5py")
    about = {"units": "mm", "scale_factor": 0.25, "add_offset": -7.5}
    # The bytes of y are unsigned, and cross 128.
    dimensions = {
        "z": (np.arange(4, dtype=np.int16), about),
        "y": (np.arange(126, 131, dtype=np.uint8).view(np.int8), {**about, "_Unsigned": "true"}),
        "x": (np.arange(9, 3, -1, dtype=np.int16), about),
    }
    expected = [[-0.25, 0, 0, -5.25], [0, 0.25, 0, 24], [0, 0, 0.25, -7.5]]
    volume = read_volume(classic(tmp_path / "3.nc", values, dimensions))
    np.testing.assert_array_equal(volume.index_to_world[:3], expected)
    with h5py.File(tmp_path / "4.nc", "w") as file:
        data = file.create_dataset("h", data=values)
        for place, (name, (places, attributes)) in enumerate(dimensions.items()):
            file[name] = places
            file[name].make_scale(name)
            file[name].attrs.update(attributes)
            data.dims[place].attach_scale(file[name])
    np.testing.assert_array_equal(read_volume(tmp_path / "4.nc").index_to_world[:3], expected)


def test_version_4(tmp_path, values):
    """Checks version 4, which is HDF5; dimensions without coordinates have a scale, too."""
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "x.nc"
    with h5py.File(path, "w") as file:
        data = file.create_dataset("g/h", data=values)
        for place, name in enumerate("zyx"):
            if name == "z":
                file[name] = np.zeros(4, ">f4")
                file[name].make_scale("This is a netCDF dimension but not a netCDF variable.     4")
            else:
                file[name] = even(2, values.shape[place])
                file[name].make_scale(name)
                file[name].attrs["units"] = "nanometers"
            data.dims[place].attach_scale(file[name])
    volume = reads(values, path)
    assert (volume.spacing, volume.unit) == ((2, 2, 1), "nm")
    assert volume.notes == ("The file has no voxel size along z; it is assumed to be 1.",)


def test_damaged(tmp_path, values):
    dimensions = {name: (even(1, n), {}) for name, n in zip("zyx", values.shape)}
    path = classic(tmp_path / "x.nc", values, dimensions)
    whole = path.read_bytes()
    for broken, sentence in (
        (whole[:-200], "damaged"),
        (whole[:60], "damaged"),
        (b"CDF\x05" + whole[4:], "CDF-5"),
        (b"text", "damaged"),
    ):
        refused(f"x.nc: .*{sentence}", read_volume, written(path, broken))
