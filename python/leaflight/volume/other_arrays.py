# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts arrays and images of other libraries to volumes. It checks attributes, not classes.

It imports only libraries that the object has already loaded. Plain arrays are [z, y, x].
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._core import LeaflightError
from ..arrays import Array
from .axes import CF, FROM_LPS, Axis, axis_at, grid_of
from .memory import as_voxels
from .setting_error import SettingError
from .units import unit_of
from .volume import Volume


class _Read(NamedTuple):
    """The parts of a Volume. index_to_world: None if the data have no voxel size."""

    values: Any
    index_to_world: Array | None
    unit: str
    name: str
    notes: tuple[str, ...] = ()
    patient: bool = False


def as_volume(data: Any, spacing: ArrayLike | None = None, name: str | None = None) -> Volume:
    """Returns the Volume of an array or an image with three axes of real numbers; a Volume as it
    is.

    data: An array [z, y, x] of NumPy, Zarr, Dask, h5py or the like. Or an array of xarray with
        evenly spaced coordinates; names and CF attributes tell which are x, y and z. Or an image of
        nibabel, SimpleITK, ITK, VTK or PyVista. Masked values become missing data. Axes of length 1
        beyond the three in space are dropped.
    spacing: Voxel size of arrays that have none, or a guessed one: one number or (x, y, z).
    name: Name for display. None is the name of the data.
    Raises LeaflightError.
    """
    if isinstance(data, Volume):
        found = data
    else:
        reader = _reader(data)
        read = reader(data)
        name, values = name or read.name, as_voxels(_scalars(read.values, read.name))
        # Notes are about guesses, which a voxel size replaces.
        if read.index_to_world is None or (read.notes and spacing is not None):
            return Volume(values, None, name, spacing=spacing)
        placed = read.index_to_world, name
        found = Volume(values, *placed, unit=read.unit, patient=read.patient)
        found = found.noted(*read.notes)
    if spacing is not None:
        raise SettingError(
            f"{found.name}: the image has its own voxel size: leave spacing out.", "spacing"
        )
    return found


def as_volumes(data: Any, spacing: ArrayLike | None = None) -> list[Volume]:
    """Returns a list of Volumes from one such object, or from a list or tuple of them."""
    several = isinstance(data, (list, tuple))
    return [as_volume(one, spacing) for one in (data if several else [data])]


def _reader(data: Any) -> Callable[[Any], _Read]:
    for names, reader in _READERS.items():
        if all(hasattr(data, name) for name in names):
            return reader
    return _of_array


def _of_array(data: Any) -> _Read:
    if isinstance(data, (str, Path)):
        raise LeaflightError(f"{data}: this is a path, not a volume: read it with read_volume().")
    full_name = getattr(data, "name", None)
    name = full_name.strip("/").rpartition("/")[2] if isinstance(full_name, str) else ""
    # Axes before the three and after them may have length 1.
    return _Read(_in_space(_in_space(_array(data)).T).T, None, "", name or "array")


def _of_nibabel(image: Any) -> _Read:
    """Reads an image of nibabel, or one with axes x, y, z and an affine to the world."""
    header: Any = getattr(image, "header", None)
    unit = header.get_xyzt_units()[0] if hasattr(header, "get_xyzt_units") else ""
    path = image.get_filename() if hasattr(image, "get_filename") else None
    values = _in_space(_array(getattr(image, "dataobj", image)))
    affine = np.eye(4) if image.affine is None else np.array(image.affine, np.float64)
    # A header without a unit means millimeters, as is usual for the format.
    name = Path(path or "image").name.partition(".")[0]
    # Method 1 of nifti1.h has no orientation.
    codes = [header[code] for code in ("qform_code", "sform_code") if code in (header or ())]
    is_patient = not codes or any(codes)
    return _Read(values.T, affine, unit_of(unit) or "mm", name, (), is_patient)


def _of_itk(image: Any) -> _Read:
    module = sys.modules[type(image).__module__.partition(".")[0]]
    view = getattr(module, "GetArrayViewFromImage", _array)
    matrix, spacing = np.eye(4), np.asarray(image.GetSpacing(), np.float64)
    if len(spacing) != 3:
        raise LeaflightError(
            f"The image has {len(spacing)} axes, but a volume needs three: choose one frame, or "
            "light a picture with flatland."
        )
    axes = np.reshape(np.asarray(image.GetDirection(), np.float64), (3, 3))
    matrix[:3, :3] = axes * spacing
    matrix[:3, 3] = image.GetOrigin()
    return _Read(view(image), FROM_LPS @ matrix, "mm", "image", (), True)


def _of_vtk(image: Any) -> _Read:
    """Reads an image of VTK or PyVista: its values at points, else in cells."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    shape, shift = np.array(image.GetDimensions()), np.eye(4)
    shift[:3, 3] = image.GetExtent()[::2]
    scalars = image.GetPointData().GetScalars()
    if scalars is None:
        scalars = image.GetCellData().GetScalars()
        # A flat image has one layer of cells.
        shape = np.maximum(shape - 1, 1)
        shift[:3, 3] += 0.5
    if scalars is None:
        raise LeaflightError(
            "The VTK image has no active scalars: choose an array with SetActiveScalars()."
        )
    matrix = image.GetIndexToPhysicalMatrix()
    matrix = [[matrix.GetElement(row, column) for column in range(4)] for row in range(4)]
    values = _in_space(vtk_to_numpy(scalars).reshape(*shape[::-1], -1))
    return _Read(values, np.array(matrix) @ shift, "", scalars.GetName() or "image")


def _of_xarray(data: Any) -> _Read:
    name = str(data.name or "array")
    axes = [_axis(name, data, dim) for dim in data.dims]
    grid = grid_of(axes)
    if grid is None or any(n > 1 and k not in "xyz" for n, k in zip(data.shape, grid.letters)):
        raise LeaflightError(
            f"{name}: the dimensions are {dict(data.sizes)}, but a volume needs x, y and z: choose "
            "one frame and one channel, or light an image with flatland."
        )
    data = data.transpose(*(data.dims[grid.letters.index(letter)] for letter in "zyx"), ...)
    matrix = grid.matrix if any(axis.step for axis in axes) else None
    return _Read(_in_space(data.data), matrix, grid.unit, name, grid.notes)


def _axis(name: str, data: Any, dim: Any) -> Axis:
    """Returns the axis of a dimension. Raises LeaflightError unless its coordinates are even."""
    size = data.sizes[dim]
    if dim not in data.coords:
        return Axis(size, str(dim))
    places = data.coords[dim]
    about = {one: str(places.attrs[one]) for one in CF if one in places.attrs}
    axis = axis_at(size, str(dim), places.values, about)
    is_even = axis.even and axis.step is not None
    if size > 1 and axis.letter != "t" and places.dtype.kind in "iuf" and not is_even:
        raise LeaflightError(
            f"{name}: the coordinates along {dim} are not evenly spaced: interpolate to even ones "
            "first (DataArray.interp)."
        )
    return axis


# Attributes of an object -> its reader; the first match is used.
_READERS = {
    ("dims", "coords", "name", "transpose"): _of_xarray,
    ("GetIndexToPhysicalMatrix", "GetPointData"): _of_vtk,
    ("GetSpacing", "GetOrigin", "GetDirection"): _of_itk,
    ("affine",): _of_nibabel,
}


def _array(data: Any) -> Array:
    try:
        return np.asanyarray(data)
    except (TypeError, ValueError, RuntimeError) as error:
        raise LeaflightError(
            f"{type(data).__name__} cannot be converted to a NumPy array: "
            f"{str(error).rstrip('.')}; convert it first."
        ) from None


def _in_space(values: Any) -> Any:
    """Returns an array without the axes of length 1 that follow the first three."""
    while values.ndim > 3 and values.shape[-1] == 1:
        values = values[..., 0]
    return values


def _scalars(data: Any, name: str) -> Array:
    """Returns an array of real numbers with three axes. Raises LeaflightError."""
    values = _array(data)
    if values.dtype.kind not in "biuf":
        raise LeaflightError(
            f"{name}: the array holds {values.dtype}, but a volume needs one real number per "
            "voxel; convert it first."
        )
    if values.ndim != 3:
        raise LeaflightError(
            f"{name}: the shape is {values.shape}, but a volume needs three axes [z, y, x]: "
            "choose one frame and one channel, or light an image with flatland."
        )
    if isinstance(values, np.ma.MaskedArray):
        masked: Any = values.astype(np.float32)
        values = masked.filled(np.nan)
    return np.asarray(values)
