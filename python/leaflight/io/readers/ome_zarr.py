# SPDX-License-Identifier: GPL-3.0-or-later
"""OME-Zarr folders, of which one resolution is read, and plain Zarr arrays.

https://ngff.openmicroscopy.org/0.4, and 0.5
"""

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.axes import Axis, Grid, grid_of
from ...volume.memory import new_voxels
from ...volume.volume import Volume
from .channels import Channel, bytes_of_hex, channel_of
from .checks import check_matrix, choose_level, choose_named, text
from .packing import packing_of
from .stored import StoredVolume, lengths
from .zarr_folder import ZarrArray, ZarrGroup, open_zarr

# Upper bound on the images in a folder.
_MOST_IMAGES = 1000


def open_volume(path: Path, dataset: str | None = None, level: int = 0) -> StoredVolume:
    """Opens an image of a folder.

    dataset: Name of one of several images.
    level: Resolution; 0 is the finest.
    """
    node = open_zarr(path)
    names: tuple[str, ...] = ()
    notes: list[str] = []
    channels: tuple[Channel, ...] = ()
    if isinstance(node, ZarrArray):
        levels = [(node, _plain_axes(node))]
    else:
        images = _images(path, node)
        names = tuple(images)
        name = choose_named(path, names, dataset)
        levels, notes = _levels(path, images[name])
        channels = _channel_list(images[name], notes)
    array, axes = levels[choose_level(path, level, len(levels))]
    grid = grid_of(axes)
    if grid is None:
        named = ", ".join(f"{axis.name or '(no name)'} {text([axis.size])}" for axis in axes)
        raise LeaflightError(
            f"{path}: the axes are {named[:200]}, but a volume needs x, y and z with at least two "
            "samples each; choose another image."
        )
    check_matrix(path, grid.matrix)
    packing = packing_of(array.attributes)
    sizes = {letter: axis.size for letter, axis in zip(grid.letters, axes)}
    count = sizes.get("c", 1)

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        values = packing.unpacked(_values(array, grid, frame, channel, progress))
        name = path.name.partition(".")[0]
        return Volume(values, grid.matrix, name, notes=packing.note(values))

    return StoredVolume(
        dims=tuple(sizes[letter] for letter in "xyz"),
        dtype=packing.dtype(array.dtype),
        load=load,
        voxel_size=lengths(grid.matrix),
        unit=grid.unit,
        frames=sizes.get("t", 1),
        channels=count,
        channel_list=channels if len(channels) == count else (),
        levels=_dims(levels, grid) if len(levels) > 1 else (),
        datasets=names if len(names) > 1 else (),
        notes=(*notes, *grid.notes),
    )


def _values(array: ZarrArray, grid: Grid, frame: int, channel: int, progress: Progress) -> Array:
    """Returns one volume as [z, y, x]."""
    chosen = {"x": None, "y": None, "z": None, "t": frame, "c": channel}
    places = [chosen.get(letter, 0) for letter in grid.letters]
    axes = [grid.letters.index(letter) for letter in "zyx"]
    values = new_voxels([array.shape[axis] for axis in axes], array.dtype)
    array.read(values, places, axes, progress)
    return values


def _dims(levels: list[tuple[ZarrArray, list[Axis]]], grid: Grid) -> tuple[tuple[int, ...], ...]:
    places = [grid.letters.index(letter) for letter in "xyz"]
    return tuple(tuple(int(array.shape[place]) for place in places) for array, _ in levels)


def _images(path: Path, group: ZarrGroup) -> dict[str, ZarrGroup]:
    """Returns {name: group of an image}: the folder itself, or those in it (bioformats2raw)."""
    if _multiscales(group):
        return {path.name: group}
    groups = islice(group.groups(), _MOST_IMAGES)
    found = {one.path.name: one for one in groups if _multiscales(one)}
    if not found:
        raise LeaflightError(
            f"{path}: this folder has no multiscale OME-Zarr image; give the folder of one image, "
            "or of one array."
        )
    return found


def _metadata(group: ZarrGroup, name: str) -> Any:
    return group.attributes.get("ome", group.attributes).get(name)


def _multiscales(group: ZarrGroup) -> Any:
    return _metadata(group, "multiscales")


def _channel_list(group: ZarrGroup, notes: list[str]) -> tuple[Channel, ...]:
    """Returns the names and colors of an image; none without them. Adds notes about others."""
    try:
        found = [
            (one.get("label"), one.get("color")) for one in _metadata(group, "omero")["channels"]
        ]
    except (AttributeError, KeyError, TypeError):
        return ()
    if not all(label is None or isinstance(label, str) for label, _ in found):
        notes.append("Names of channels that are not text are left out; choose by number.")
    return tuple(channel_of(label, bytes_of_hex(color)) for label, color in found)


def _levels(path: Path, group: ZarrGroup) -> tuple[list[tuple[ZarrArray, list[Axis]]], list[str]]:
    """Returns ([(array, its axes)], notes), the finest resolution first."""
    image = _multiscales(group)[0]
    # Before version 0.4 axes were only names, and before 0.3 always these.
    named = image.get("axes") or ["t", "c", "z", "y", "x"]
    named = [axis if isinstance(axis, dict) else {"name": axis} for axis in named]
    levels, left_out = [], set()
    for part in image["datasets"]:
        array = group.array(part["path"])
        if len(named) != len(array.shape):
            raise LeaflightError(
                f"{path}: the metadata have {len(named)} axes, but the arrays have "
                f"{len(array.shape)}; repair the metadata."
            )
        steps, firsts, others = _transform([part, image], len(named))
        left_out |= others
        axes = [
            _axis(n, axis, first, step)
            for n, axis, first, step in zip(array.shape, named, firsts, steps)
        ]
        levels.append((array, axes))
    notes = [f"The transformation {kind[:40]!r} is ignored." for kind in sorted(left_out)]
    return levels, notes


def _axis(size: int, named: dict[str, Any], first: float, step: float) -> Axis:
    name = str(named["name"])
    kinds = {"time": "t", "channel": "c"}
    letter = name.lower() if name.lower() in tuple("xyztc") else kinds.get(named.get("type", ""))
    return Axis(int(size), name, letter or "", first, step, str(named.get("unit") or ""))


def _transform(parts: Sequence[dict[str, Any]], axes: int) -> tuple[Array, Array, set[str]]:
    """Returns (steps, first positions, unknown kinds) of lists of scales and translations."""
    steps, firsts, others = np.ones(axes), np.zeros(axes), set()
    for part in parts:
        for one in part.get("coordinateTransformations") or ():
            kind = str(one["type"])
            numbers = np.asarray(one.get(kind, 1.0 if kind == "scale" else 0.0), object)
            if kind == "scale":
                scale = np.broadcast_to(numbers.astype(float), axes)
                steps, firsts = steps * scale, firsts * scale
            elif kind == "translation":
                firsts = firsts + np.broadcast_to(numbers.astype(float), axes)
            elif kind != "identity":
                others.add(kind)
    return steps, firsts, others


def _plain_axes(array: ZarrArray) -> list[Axis]:
    """Returns the axes of a single array, with the names of Zarr 3 or xarray."""
    names = array.names or tuple(array.attributes.get("_ARRAY_DIMENSIONS") or ())
    names = names if len(names) == len(array.shape) else ("",) * len(array.shape)
    return [Axis(n, str(name or "")) for n, name in zip(array.shape, names)]
