# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that arrays and images of other libraries become volumes at the right position."""

import sys
from types import ModuleType

import leaflight
import nibabel
import numpy as np
import pytest
from leaflight import Volume, as_volume
from outcomes import refused

# A transform that mirrors, rotates and moves.
AFFINE = np.array([[-2.0, 0, 0, 90], [0, 0, 3.0, -120], [0, 1.5, 0, -70], [0, 0, 0, 1]])
# Index (i, j, k) of a voxel in values of shape (4, 5, 6).
INDEX = (4, 1, 2)


def place_of(volume, index=INDEX):
    return (volume.index_to_world @ [*index, 1])[:3]


def check(volume, values, place, name, unit=""):
    np.testing.assert_array_equal(volume.values, values)
    assert volume.values.flags.c_contiguous
    np.testing.assert_allclose(place_of(volume), place)
    assert (volume.name, volume.unit) == (name, unit)


def test_numpy(values):
    check(as_volume(values, (1, 2, 3)), values, [4, 2, 6], "array")
    check(as_volume(values.astype(">i8"), 0.5, "head"), values, [2, 0.5, 1], "head")
    # Test axes of length one, Fortran order, booleans and masks.
    check(as_volume(np.asfortranarray(values)[None, ..., None]), values, INDEX, "array")
    assert as_volume(values > 50).values.dtype == np.uint8
    masked = as_volume(np.ma.masked_less(values, 9))
    np.testing.assert_array_equal(np.isnan(masked.values), values < 9)


def test_volume_from_spacing_and_origin(values):
    volume = Volume(values, spacing=(1, 2, 3), origin=(10, 20, 30), name="head", unit="mm")
    check(volume, values, [14, 22, 36], "head", "mm")
    assert volume.spacing == (1, 2, 3)
    assert Volume(values.tolist()).values.shape == (4, 5, 6)
    assert Volume(values[0], spacing=0.5).index_to_world.shape == (3, 3)
    for wrong in (0, -1, (1, 2), (1, 2, np.nan), "two"):
        refused("The spacing .* is invalid", Volume, values, spacing=wrong)
    refused("index_to_world and spacing or origin", Volume, values, np.eye(4), spacing=1)
    refused("'parsec'.* m, cm, mm", Volume, values, unit="parsec")


def test_nibabel(values, tmp_path):
    image = nibabel.Nifti1Image(values.T, AFFINE)
    place = nibabel.affines.apply_affine(image.affine, INDEX)
    check(as_volume(image), values, place, "image", "mm")
    image.header.set_xyzt_units("micron")
    nibabel.save(image, tmp_path / "cell.nii.gz")
    loaded = nibabel.load(tmp_path / "cell.nii.gz")
    check(as_volume(loaded), values, place, "cell", "µm")
    assert loaded.dataobj[INDEX] == as_volume(loaded).values[INDEX[::-1]]
    refused("has its own voxel size", leaflight.bake, image, spacing=2)
    series = nibabel.Nifti1Image(values.T[:, :, None], AFFINE)
    refused(r"\(4, 1, 5, 6\)", as_volume, series)


class SimpleITKImage:
    """A copy of SimpleITK's interface, because Debian 12 has no SimpleITK for Python."""

    def __init__(self, values, spacing, origin, direction):
        self.values = values
        self.GetSpacing = lambda: spacing
        self.GetOrigin = lambda: origin
        self.GetDirection = lambda: direction

    def TransformIndexToPhysicalPoint(self, index):
        axes = np.reshape(self.GetDirection(), (3, 3)) * self.GetSpacing()
        return axes @ index + self.GetOrigin()


def test_simpleitk(values, monkeypatch):
    module = ModuleType("SimpleITK")
    module.GetArrayViewFromImage = lambda image: image.values
    monkeypatch.setitem(sys.modules, "SimpleITK", module)
    monkeypatch.setattr(SimpleITKImage, "__module__", "SimpleITK.SimpleITK")
    image = SimpleITKImage(values, (0.5, 2.0, 3.0), (9, 8, 7), (0, 1, 0, 0, 0, -1, 1, 0, 0))
    # SimpleITK's axes point left and back, ours right and front, as in NIfTI.
    left, back, up = image.TransformIndexToPhysicalPoint(INDEX)
    check(as_volume(image), values, [-left, -back, up], "image", "mm")
    vectors = SimpleITKImage(values[None], (1.0,) * 3, (0,) * 3, np.eye(3).ravel())
    refused(r"\(1, 4, 5, 6\)", as_volume, vectors)
    for count in (2, 4):
        other = SimpleITKImage(values, (1.0,) * count, (0,) * count, np.eye(count).ravel())
        refused(f"has {count} axes", as_volume, other)


def test_xarray(values):
    xarray = pytest.importorskip("xarray", reason="xarray (python3-xarray) is not installed")
    axes = {"z": 10 + 3.0 * np.arange(4), "y": 5 - 0.5 * np.arange(5), "x": np.arange(6)}
    data = xarray.DataArray(values, axes, list("zyx"), name="density")
    point = data.isel(x=INDEX[0], y=INDEX[1], z=INDEX[2])
    place = [float(point[axis]) for axis in "xyz"]
    check(as_volume(data), values, place, "density")
    check(as_volume(data.transpose("x", "z", "y")), values, place, "density")
    check(as_volume(data.expand_dims("time")), values, place, "density")
    # Coordinates have different units; lengths use that of x, the first.
    for axis, unit in (("x", "m"), ("z", "km"), ("y", "km")):
        data[axis].attrs["units"] = unit
    check(as_volume(data), values, np.multiply(place, [1, 1e3, 1e3]), "density", "m")
    # Test other names of axes, and no coordinates.
    plain = xarray.DataArray(values, dims=("depth", "row", "column"))
    check(as_volume(plain, (1, 2, 3)), values, [4, 2, 6], "array")
    uneven = data.assign_coords(y=np.arange(5.0) ** 2)
    refused("density: .* y .*not even", as_volume, uneven)
    refused("Dataset", as_volume, data.to_dataset())


def test_xarray_has_the_axes_of_netcdf(values):
    xarray = pytest.importorskip("xarray", reason="xarray (python3-xarray) is not installed")
    axes = {"lon": 2.0 * np.arange(6), "lat": 9 - np.arange(5), "height": 3.0 * np.arange(4)}
    data = xarray.DataArray(values.T, axes, list(axes))
    check(as_volume(data), values, [8, 8, 6], "array")
    # Degrees are no lengths.
    for axis, unit in (("lon", "degrees_east"), ("lat", "degrees_north"), ("height", "m")):
        data[axis].attrs["units"] = unit
    volume = as_volume(data)
    check(volume, values, [4, -1, 2], "array")
    assert "degrees, degrees, m, cannot be compared" in volume.notes[0]
    check(as_volume(data, (1, 2, 3)), values, [4, 2, 6], "array")
    refused("'band': 3", as_volume, xarray.DataArray(values[:3], dims=("band", "y", "x")))
    refused("'time': 2", as_volume, xarray.concat([data, data], "time"))


def vtk_image(values, cells=False):
    pytest.importorskip("vtkmodules", reason="VTK (python3-vtk9) is not installed")
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    image = vtkImageData()
    nz, ny, nx = np.array(values.shape) - (0 if not cells else -1)
    image.SetExtent(2, nx + 1, 0, ny - 1, -1, nz - 2)
    image.SetSpacing(0.5, 2.0, 3.0)
    image.SetOrigin(9.0, 8.0, 7.0)
    image.SetDirectionMatrix(0, 1, 0, 0, 0, -1, 1, 0, 0)
    array = numpy_to_vtk(values.ravel(), deep=True)
    array.SetName("density")
    (image.GetCellData() if cells else image.GetPointData()).SetScalars(array)
    return image


def test_vtk_and_pyvista(values):
    """Checks vtkImageData; PyVista's ImageData is a subclass."""
    image = vtk_image(values)
    nx, ny, _ = image.GetDimensions()
    number = INDEX[0] + nx * (INDEX[1] + ny * INDEX[2])
    check(as_volume(image), values, image.GetPoint(number), "density")
    cells = vtk_image(values, cells=True)
    bounds = cells.GetCell(INDEX[0] + 6 * (INDEX[1] + 5 * INDEX[2])).GetBounds()
    check(as_volume(cells), values, np.reshape(bounds, (3, 2)).mean(axis=1), "density")
    cells.GetCellData().SetActiveScalars("nothing")
    refused("no active scalars", as_volume, cells)


def test_a_flat_vtk_image_is_no_volume(values):
    vtk = pytest.importorskip("vtkmodules.util.numpy_support", reason="VTK is not installed")
    image = vtk_image(values[:1])
    colors = np.repeat(values[:1].ravel(), 3).reshape(-1, 3)
    image.GetPointData().SetScalars(vtk.numpy_to_vtk(colors))
    refused(r"\(1, 5, 6, 3\)", as_volume, image)
    image.GetPointData().SetScalars(None)
    image.GetCellData().SetScalars(vtk.numpy_to_vtk(values[0, :4, :5].ravel()))
    refused("1 voxel.* along axis z", as_volume(image).field)


def test_zarr_and_others_that_become_arrays(values, tmp_path):
    zarr = pytest.importorskip("zarr", reason="zarr (python3-zarr) is not installed")
    array = zarr.open(str(tmp_path / "x.zarr"), mode="w", shape=values.shape, dtype="f4", chunks=2)
    array[:] = values
    check(as_volume(array, (1, 2, 3)), values, [4, 2, 6], "array")
    h5py = pytest.importorskip("h5py", reason="h5py (python3-h5py) is not installed")
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file["scans/head"] = values
        check(as_volume(file["scans/head"]), values, INDEX, "head")


@pytest.mark.parametrize(
    "wrong, words",
    [
        (np.zeros((4, 4)), r"\(4, 4\)"),
        (np.zeros((4, 4, 4, 3)), "frame"),
        (np.zeros((4, 4, 4), complex), "holds complex128"),
        ("head.nii.gz", "head.nii.gz: .*read_volume"),
    ],
)
def test_what_is_no_volume(wrong, words):
    refused(words, leaflight.bake, wrong)


def test_an_array_is_baked_as_its_volume_is(bump_scene):
    box = leaflight.bump_box(12)
    work = {"error": 20.0, "isovalues": (30, 70)}
    volume = Volume(box.values, spacing=(1, 2, 3), name="array")
    expected = leaflight.bake(volume, bump_scene, **work)
    assert leaflight.bake(box.values, bump_scene, spacing=(1, 2, 3), **work).id == expected.id
    both = leaflight.bake([box.values, volume], spacing=None, **work | {"isovalues": None})
    assert [one.spacing for one in both.volumes] == [(1, 1, 1), (1, 2, 3)]
    assert leaflight.estimate(box.values, bump_scene, error=20.0).seconds > 0
