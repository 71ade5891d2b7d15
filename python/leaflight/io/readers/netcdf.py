# SPDX-License-Identifier: GPL-3.0-or-later
"""NetCDF: version 4 is HDF5. nibabel's copy of SciPy's reader reads the classic format.

https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html
"""

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from nibabel.externals.netcdf import netcdf_file

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.axes import CF, Axis, Grid, axis_at, grid_of
from ...volume.memory import new_voxels
from ...volume.volume import Volume
from . import hdf5
from .checks import check_matrix, choose_named, index_to_world
from .packing import NAMES, Packing, packing_of, text_of
from .stored import StoredVolume, lengths
from .watched import watched

_CLASSIC = (b"CDF\x01", b"CDF\x02")
_CLASSIC_5 = b"CDF\x05"


def open_volume(
    path: Path, dataset: str | None = None, spacing: float | Sequence[float] | None = None
) -> StoredVolume:
    """Opens the only volume, or the variable that dataset names."""
    with open(path, "rb") as file:
        mark = file.read(4)
    if mark == _CLASSIC_5:
        raise LeaflightError(
            f"{path}: netCDF in the format CDF-5 is not supported; convert it with 'nccopy -k nc4'."
        )
    if mark not in _CLASSIC:
        return hdf5.open_volume(path, dataset, 0, spacing)
    with _Classic(str(path), "r", mmap=True) as file:
        found = {name: _variable(file, name) for name in file.variables}
    volumes = {name: variable for name, variable in found.items() if variable is not None}
    names = tuple(sorted(volumes))
    name = choose_named(path, names, dataset)
    grid, shape, stored, packing = volumes[name]
    sizes = dict(zip(grid.letters, shape))
    matrix = grid.matrix if spacing is None else index_to_world(path, spacing)
    check_matrix(path, matrix)

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        with _Classic(str(path), "r", mmap=True) as file:
            data = file.variables[name].data
            values = _values(data, grid.letters, packing, frame, channel, progress)
        return Volume(values, matrix, path.stem, notes=packing.note(values))

    return StoredVolume(
        dims=tuple(sizes[letter] for letter in "xyz"),
        dtype=packing.dtype(stored),
        load=load,
        voxel_size=lengths(matrix),
        unit=grid.unit if spacing is None else "",
        frames=sizes.get("t", 1),
        channels=sizes.get("c", 1),
        datasets=names,
        notes=grid.notes,
    )


class _Classic(netcdf_file):  # type: ignore[misc]
    """A reader without the warning about arrays that are still in use; none is."""

    def close(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            super().close()

    __del__ = close


def _variable(
    file: _Classic, name: str
) -> tuple[Grid, tuple[int, ...], np.dtype[Any], Packing] | None:
    """Returns (Grid, shape, type, Packing) of a variable; None if it is no volume."""
    variable = file.variables[name]
    data = variable.data
    if data.dtype.kind not in "biuf" or not data.size:
        return None
    grid = grid_of([_axis(file, axis, n) for axis, n in zip(variable.dimensions, data.shape)])
    return None if grid is None else (grid, data.shape, data.dtype, _packing(variable))


def _packing(variable: Any) -> Packing:
    return packing_of({one: getattr(variable, one, None) for one in NAMES})


def _axis(file: _Classic, name: str, size: int) -> Axis:
    """Returns the axis with the coordinates of the variable of the same name."""
    places = file.variables.get(name)
    if places is None or places.data.shape != (size,):
        return Axis(size, name)
    about = {one: text_of(getattr(places, one, None)) for one in CF}
    about = {one: text for one, text in about.items() if text}
    return axis_at(size, name, _packing(places).places(places.data.copy()), about)


def _values(
    data: Array, letters: str, packing: Packing, frame: int, channel: int, progress: Progress
) -> Array:
    """Returns one volume as [z, y, x]."""
    chosen: dict[str, int | slice] = {axis: slice(None) for axis in "xyz"}
    chosen |= {"t": frame, "c": channel}
    order = [letter for letter in letters if letter in "zyx"]
    part = data[tuple(chosen.get(letter, 0) for letter in letters)]
    part = part.transpose([order.index(letter) for letter in "zyx"])
    values = new_voxels(part.shape, packing.dtype(data.dtype).newbyteorder("="))
    for k in watched(progress, range(len(values))):
        values[k] = packing.unpacked(np.ascontiguousarray(part[k]))
    return values
