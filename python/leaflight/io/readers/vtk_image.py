# SPDX-License-Identifier: GPL-3.0-or-later
"""The arrays of VTK's images, whichever kind of file they come from: of points or of cells."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from .checks import check_matrix, choose_named, listed, undecided
from .stored import StoredVolume, lengths

# VTK marks voxels by them which another piece has, too.
_NOT_VALUES = {"vtkGhostType", "vtkGhostLevels"}


@dataclass(frozen=True)
class ImageArray:
    """One array of an image.

    name: in the file; of_cells: whether each cell has a value, not each point; dtype: of a value;
    channels: values of a point or cell.
    read: read(channel, dims, progress) gives (the values [z, y, x], notes on them).
    """

    name: str
    of_cells: bool
    dtype: np.dtype[Any]
    channels: int
    read: Callable[[int, tuple[int, ...], Progress], tuple[Array, Sequence[str]]]


@dataclass(frozen=True)
class Image:
    """An image and its arrays; points: how many along x, y and z; matrix: places the points."""

    path: Path
    points: tuple[int, ...]
    matrix: Array
    arrays: Sequence[ImageArray]
    notes: tuple[str, ...] = field(default=())


def open_image(image: Image, dataset: str | None) -> StoredVolume:
    """Opens the array that is chosen, else the only one of points, else the only one."""
    path = image.path
    if min(image.points) < 1:
        raise LeaflightError(f"{path}: the header claims no voxels; the file is damaged.")
    found = _named(image.arrays)
    names, notes = tuple(found), image.notes
    of_points = [name for name, array in found.items() if not array.of_cells]
    name = choose_named(path, names, dataset)
    if name is None and len(of_points) == 1:
        name = of_points[0]
        others = listed([other for other in names if other != name])
        notes += (f"The array {name}, of points, is read; the dataset can also be {others}.",)
    if name is None:
        unread = np.dtype(np.float32)
        return StoredVolume(None, unread, undecided(path, names), datasets=names, notes=notes)
    array, dims, matrix = found[name], image.points, image.matrix.copy()
    if array.of_cells:
        # A flat image has one layer of cells, and cells have their values in their middle.
        middle = [0.5 if n > 1 else 0.0 for n in dims]
        dims = tuple(max(1, n - 1) for n in dims)
        matrix[:3, 3] += matrix[:3, :3] @ middle
    check_matrix(path, matrix)

    def load(_frame: int, channel: int, progress: Progress) -> Volume:
        values, notes = array.read(channel, dims, progress)
        return Volume(values, matrix, path.stem, notes=notes)

    return StoredVolume(
        dims,
        array.dtype,
        load,
        lengths(matrix),
        channels=array.channels,
        datasets=names,
        notes=notes,
    )


def _named(arrays: Sequence[ImageArray]) -> dict[str, ImageArray]:
    """Returns the arrays that may be volumes, by names of their own."""
    of_points = {array.name for array in arrays if not array.of_cells}
    found: dict[str, ImageArray] = {}
    for array in arrays:
        if array.name not in _NOT_VALUES:
            twice = array.of_cells and array.name in of_points
            found[f"{array.name} (cells)" if twice else array.name] = array
    return found


def matrix_of(origin: ArrayLike, spacing: ArrayLike, axes: ArrayLike, first: ArrayLike) -> Array:
    """Returns the matrix (4, 4); first: the index (x, y, z) that the values begin at."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(axes, (3, 3)) * np.asarray(spacing, np.float64)
    matrix[:3, 3] = np.asarray(origin, np.float64) + matrix[:3, :3] @ np.asarray(first, np.float64)
    return matrix
