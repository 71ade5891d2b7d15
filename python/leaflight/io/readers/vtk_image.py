# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays of points or cells in VTK images, for all formats of them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..._core import Progress
from ...arrays import Array
from ...volume.volume import Volume
from .channels import Channel
from .checks import check_matrix, check_shape, choose_named, listed
from .stored import StoredVolume, lengths

# VTK marks voxels by them that belong to another piece, too.
_NOT_VALUES = {"vtkGhostType", "vtkGhostLevels"}


@dataclass(frozen=True)
class ImageArray:
    """One array of an image.

    name: Name in the file.
    of_cells: True if values belong to cells, False if to points.
    dtype: Type of a value.
    channels: Number of values of a point or cell.
    read: read(channel, dims, progress) returns (values [z, y, x], notes).
    channel_list: As in StoredVolume.
    """

    name: str
    of_cells: bool
    dtype: np.dtype[Any]
    channels: int
    read: Callable[[int, tuple[int, ...], Progress], tuple[Array, Sequence[str]]]
    channel_list: tuple[Channel, ...] = ()


@dataclass(frozen=True)
class Image:
    """An image and its arrays. points: Number along x, y and z. matrix: Positions of the points."""

    path: Path
    points: tuple[int, ...]
    matrix: Array
    arrays: Sequence[ImageArray]
    notes: tuple[str, ...] = field(default=())


def open_image(image: Image, dataset: str | None) -> StoredVolume:
    """Opens the chosen array, else the only one of points, else the only one."""
    path = image.path
    check_shape(path, image.points)
    found = _named(image.arrays)
    names, notes = tuple(found), image.notes
    of_points = [name for name, array in found.items() if not array.of_cells]
    if dataset is None and len(of_points) == 1 < len(names):
        dataset = of_points[0]
        others = listed([other for other in names if other != dataset])
        notes += (f"The array {dataset} (points) is read; other datasets are {others}.",)
    name = choose_named(path, names, dataset, notes=notes)
    array, dims, matrix = found[name], image.points, image.matrix.copy()
    if array.of_cells:
        # A flat image has one layer of cells. Values of cells lie in their middle.
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
        channel_list=array.channel_list,
        datasets=names,
        notes=notes,
    )


def _named(arrays: Sequence[ImageArray]) -> dict[str, ImageArray]:
    """Returns the arrays that may be volumes, by unique names."""
    of_points = {array.name for array in arrays if not array.of_cells}
    found: dict[str, ImageArray] = {}
    for array in arrays:
        if array.name not in _NOT_VALUES:
            twice = array.of_cells and array.name in of_points
            found[f"{array.name} (cells)" if twice else array.name] = array
    return found


def matrix_of(origin: ArrayLike, spacing: ArrayLike, axes: ArrayLike, first: ArrayLike) -> Array:
    """Returns the matrix (4, 4). first: Index (x, y, z) of the first value."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(axes, (3, 3)) * np.asarray(spacing, np.float64)
    matrix[:3, 3] = np.asarray(origin, np.float64) + matrix[:3, :3] @ np.asarray(first, np.float64)
    return matrix
