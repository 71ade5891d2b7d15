# SPDX-License-Identifier: GPL-3.0-or-later
"""OME-Zarr folders, of which one resolution is read; and plain Zarr arrays.

https://ngff.openmicroscopy.org/0.4, and 0.5
"""

from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.setting_error import SettingError
from ...volume.units import unit_of
from ...volume.volume import Volume
from ...volume.voxels import new_voxels
from .checks import check_shape, listed
from .stored import StoredVolume, lengths
from .zarr_folder import ZarrArray, ZarrGroup, open_zarr


def open_volume(path: Path, level: int = 0) -> StoredVolume:
    """level: which resolution, 0 the finest."""
    node = open_zarr(path)
    if isinstance(node, ZarrArray):
        arrays, axes, matrices, unit = [node], _plain_axes(path, node.shape), [np.eye(4)], ""
    else:
        arrays, axes, matrices, unit = _multiscale(path, node)
    if not 0 <= level < len(arrays):
        raise SettingError(
            f"{path}: there is no level {level}; choose one of 0..{len(arrays) - 1}, 0 is the "
            "finest.",
            "level",
        )
    array, matrix = arrays[level], matrices[level]
    sizes = dict(zip(axes, array.shape))
    if not {"x", "y", "z"} <= sizes.keys():
        raise LeaflightError(f"{path}: its axes are {listed(axes)}, but a volume needs x, y and z.")

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        chosen = {"t": frame, "c": channel}
        places = [None if axis in "xyz" else chosen.get(axis, 0) for axis in axes]
        values = new_voxels([sizes[axis] for axis in "zyx"], array.dtype)
        array.read(values, places, [axes.index(axis) for axis in "zyx"], progress)
        return Volume(values, matrix, path.name.partition(".")[0])

    return StoredVolume(
        dims=tuple(sizes[axis] for axis in "xyz"),
        dtype=array.dtype,
        load=load,
        voxel_size=lengths(matrix),
        unit=unit,
        frames=sizes.get("t", 1),
        channels=sizes.get("c", 1),
        levels=tuple(tuple(dict(zip(axes, one.shape))[axis] for axis in "xyz") for one in arrays)
        if len(arrays) > 1
        else (),
    )


def _multiscale(
    path: Path, group: ZarrGroup
) -> tuple[list[ZarrArray], list[str], list[Array], str]:
    """(arrays, names of their axes, matrices, unit), from the finest resolution on."""
    attributes = group.attributes.get("ome", group.attributes)
    images = attributes.get("multiscales")
    if not images:
        raise LeaflightError(
            f"{path}: it has no multiscale image of OME-Zarr; give the folder of one image, or of "
            "one array."
        )
    image = images[0]
    # Before 0.4 axes were names alone, and before 0.3 always these.
    named = image.get("axes") or ["t", "c", "z", "y", "x"]
    axes = [axis["name"] if isinstance(axis, dict) else axis for axis in named]
    unit = next((a.get("unit") for a in named if isinstance(a, dict) and a["name"] == "x"), None)
    whole = _transform(image, axes)
    arrays = [group.array(part["path"]) for part in image["datasets"]]
    matrices = [whole @ _transform(part, axes) for part in image["datasets"]]
    return arrays, axes, matrices, unit_of(unit)


def _transform(part: dict[str, Any], axes: list[str]) -> Array:
    """The matrix (4, 4) of a list of scales and translations."""
    matrix = np.eye(4)
    for step in part.get("coordinateTransformations", []):
        numbers = dict(zip(axes, step.get(step["type"]) or ()))
        of_space = [float(numbers.get(axis, step["type"] == "scale")) for axis in "xyz"]
        one = np.eye(4)
        if step["type"] == "scale":
            one = np.diag([*of_space, 1.0])
        elif step["type"] == "translation":
            one[:3, 3] = of_space
        matrix = one @ matrix
    return matrix


def _plain_axes(path: Path, shape: tuple[int, ...]) -> list[str]:
    check_shape(path, shape)
    return ["t", "z", "y", "x"][-len(shape) :]
