# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts arrays and images of other libraries to volumes. It checks attributes, not classes.

It imports only libraries that the object has already loaded. Plain arrays are [z, y, x].
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._core import LeaflightError
from ..arrays import Array
from .memory import as_voxels
from .setting_error import SettingError
from .units import METERS, unit_of
from .volume import Volume

# Values, index_to_world or None, unit, name.
_Read = tuple[Any, Array | None, str, str]
# Matrix from the patient coordinates of ITK (left, back, up) to those of NIfTI (right, front, up).
_TO_NIFTI = np.diag([-1.0, -1.0, 1.0, 1.0])


def as_volume(data: Any, spacing: ArrayLike | None = None, name: str | None = None) -> Volume:
    """Returns the Volume of an array or an image with three axes of real numbers; a Volume as it
    is.

    data: An array [z, y, x] of NumPy, Zarr, Dask, h5py or the like. Or an array of xarray with
        evenly spaced coordinates; its dimensions x, y and z may be in any order. Or an image of
        nibabel, SimpleITK, ITK, VTK or PyVista. Masked values become missing data. Further axes of
        length 1 are dropped.
    spacing: Voxel size of arrays that have none: one number or (x, y, z).
    name: Name for display. None is the name of the data.
    Raises LeaflightError.
    """
    if isinstance(data, Volume):
        found = data
    else:
        reader = _reader(data)
        values, index_to_world, unit, data_name = reader(data)
        values = as_voxels(_scalars(values, data_name))
        if index_to_world is None:
            return Volume(values, None, name or data_name, spacing=spacing)
        is_patient = reader in (_of_nibabel, _of_itk)
        found = Volume(values, index_to_world, name or data_name, unit=unit, patient=is_patient)
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
    full_name = getattr(data, "name", None)
    name = full_name.strip("/").rpartition("/")[2] if isinstance(full_name, str) else ""
    return data, None, "", name or "array"


def _of_nibabel(image: Any) -> _Read:
    """Reads an image of nibabel, or one with axes x, y, z and an affine to the world."""
    header: Any = getattr(image, "header", None)
    unit = header.get_xyzt_units()[0] if hasattr(header, "get_xyzt_units") else ""
    path = image.get_filename() if hasattr(image, "get_filename") else None
    values = _without_single_axes(_array(getattr(image, "dataobj", image)))
    affine = np.eye(4) if image.affine is None else np.array(image.affine, np.float64)
    # A header without a unit means millimeters, as is usual for the format.
    return values.T, affine, unit_of(unit) or "mm", Path(path or "image").name.partition(".")[0]


def _of_itk(image: Any) -> _Read:
    module = sys.modules[type(image).__module__.partition(".")[0]]
    view = getattr(module, "GetArrayViewFromImage", _array)
    matrix = np.eye(4)
    axes = np.reshape(np.asarray(image.GetDirection(), np.float64), (3, 3))
    matrix[:3, :3] = axes * np.asarray(image.GetSpacing(), np.float64)
    matrix[:3, 3] = image.GetOrigin()
    return view(image), _TO_NIFTI @ matrix, "mm", "image"


def _of_vtk(image: Any) -> _Read:
    """Reads an image of VTK or PyVista: its values at points, else in cells."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    shape, shift = np.array(image.GetDimensions()), np.eye(4)
    shift[:3, 3] = image.GetExtent()[::2]
    scalars = image.GetPointData().GetScalars()
    if scalars is None:
        scalars = image.GetCellData().GetScalars()
        shape -= 1
        shift[:3, 3] += 0.5
    if scalars is None:
        raise LeaflightError(
            "The VTK image has no active scalars: choose an array with SetActiveScalars()."
        )
    matrix = image.GetIndexToPhysicalMatrix()
    matrix = [[matrix.GetElement(row, column) for column in range(4)] for row in range(4)]
    values = vtk_to_numpy(scalars).reshape(*shape[::-1], -1)
    return values, np.array(matrix) @ shift, "", scalars.GetName() or "image"


def _of_xarray(data: Any) -> _Read:
    name, data = str(data.name or "array"), data.squeeze()
    if data.ndim != 3:
        return data.data, None, "", name
    by_name = {str(dim).lower(): dim for dim in data.dims}
    known = {"x", "y", "z"} <= by_name.keys()
    order = [by_name[axis] for axis in "zyx"] if known else list(data.dims)
    data = data.transpose(*order)
    # Times are not coordinates.
    places = {d: data.coords[d] for d in order if d in data.coords and _is_real(data.coords[d])}
    if not places:
        return data.data, None, "", name
    units = {dim: unit_of(one.attrs.get("units")) for dim, one in places.items()}
    unit, matrix = next(filter(None, units.values()), ""), np.eye(4)
    for axis, dim in enumerate(order[::-1]):
        if dim in places:
            first, step = _even(name, dim, places[dim].values)
            scale = METERS[units[dim] or unit] / METERS[unit] if unit else 1.0
            matrix[axis, axis], matrix[axis, 3] = scale * step, scale * first
    return data.data, matrix, unit, name


def _is_real(array: Any) -> bool:
    return array.dtype.kind in "iuf"


def _even(name: str, dim: object, places: ArrayLike) -> tuple[float, float]:
    """Returns (first, step) of evenly spaced coordinates. Raises LeaflightError for others."""
    places = np.asarray(places, np.float64)
    step = (places[-1] - places[0]) / (len(places) - 1)
    even = places[0] + step * np.arange(len(places))
    slack = 1e-3 * abs(step) + 1e-6 * np.abs(places).max()
    if not (step != 0 and (np.abs(places - even) <= slack).all()):
        raise LeaflightError(
            f"{name}: the coordinates along {dim} are not evenly spaced: interpolate to even ones "
            "first (DataArray.interp)."
        )
    return places[0], step


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


def _without_single_axes(values: Array) -> Array:
    return np.squeeze(values) if values.ndim > 3 else values


def _scalars(data: Any, name: str) -> Array:
    """Returns an array of real numbers with three axes. Raises LeaflightError."""
    if isinstance(data, (str, Path)):
        raise LeaflightError(f"{data}: this is a path, not a volume: read it with read_volume().")
    values = _without_single_axes(_array(data))
    if values.dtype.kind not in "biuf":
        raise LeaflightError(
            f"{name}: {type(data).__name__} holds {values.dtype}, but a volume needs one real "
            "number per voxel; convert it first."
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
