# SPDX-License-Identifier: GPL-3.0-or-later
"""OME-Zarr folders through zarr, of which one resolution is read; and plain Zarr arrays.

https://ngff.openmicroscopy.org/0.4, and 0.5 by zarr 3
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from ...volume.voxels import new_voxels
from .axes import Axis, Grid, grid_of
from .checks import check_matrix, check_scalar, choose_level, choose_named, text, undecided
from .stored import StoredVolume, lengths
from .watched import watched

_ZARR = int(zarr.__version__.partition(".")[0])
# Images within a folder that are looked for.
_MOST_IMAGES = 1000


def open_volume(path: Path, dataset: str | None = None, level: int = 0) -> StoredVolume:
    """dataset: which image of a folder of several; level: which resolution, 0 the finest."""
    _check_version(path)
    with _codecs_by_name(path):
        return _opened(path, dataset, level)


def _opened(path: Path, dataset: str | None, level: int) -> StoredVolume:
    node = zarr.open(str(path), mode="r")
    names: tuple[str, ...] = ()
    notes: list[str] = []
    if hasattr(node, "shape"):
        levels = [(node, _plain_axes(node))]
    else:
        images = _images(path, node)
        names = tuple(images)
        name = choose_named(path, names, dataset)
        if name is None:
            return StoredVolume(None, np.dtype(np.float32), undecided(path, names), datasets=names)
        levels, notes = _levels(path, images[name])
    array, axes = levels[choose_level(path, level, len(levels))]
    check_scalar(path, array.dtype)
    grid = grid_of(axes)
    if grid is None:
        named = ", ".join(f"{axis.name or '(no name)'} {text([axis.size])}" for axis in axes)
        raise LeaflightError(
            f"{path}: its axes are {named[:200]}, but a volume needs x, y and z of two samples at "
            "least."
        )
    check_matrix(path, grid.matrix)
    sizes = {letter: axis.size for letter, axis in zip(grid.letters, axes)}

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        values = _values(array, grid, frame, channel, progress)
        return Volume(values, grid.matrix, path.name.partition(".")[0])

    return StoredVolume(
        dims=tuple(sizes[letter] for letter in "xyz"),
        dtype=array.dtype,
        load=load,
        voxel_size=lengths(grid.matrix),
        unit=grid.unit,
        frames=sizes.get("t", 1),
        channels=sizes.get("c", 1),
        levels=_dims(levels, grid) if len(levels) > 1 else (),
        datasets=names if len(names) > 1 else (),
        notes=(*notes, *grid.notes),
    )


def _values(array: zarr.Array, grid: Grid, frame: int, channel: int, progress: Progress) -> Array:
    """One volume as [z, y, x], read by rows of chunks."""
    chosen: dict[str, int | slice] = {axis: slice(None) for axis in "xyz"}
    chosen |= {"t": frame, "c": channel}
    index = [chosen.get(letter, 0) for letter in grid.letters]
    order = [letter for letter in grid.letters if letter in "zyx"]
    sizes = {letter: n for letter, n in zip(grid.letters, array.shape)}
    values = new_voxels([sizes[letter] for letter in "zyx"], array.dtype)
    slow = grid.letters.index("z")
    # Several chunks lie in one file, a shard, from Zarr 3 on.
    step = (getattr(array, "shards", None) or array.chunks)[slow]
    for k in watched(progress, range(0, len(values), step)):
        index[slow] = slice(k, min(k + step, len(values)))
        part = _part(array, tuple(index), [*sizes.values()])
        values[k : k + step] = part.transpose([order.index(letter) for letter in "zyx"])
    return values


def _part(array: zarr.Array, index: tuple[int | slice, ...], shape: Sequence[int]) -> Array:
    if array.fill_value is not None or _ZARR > 2:
        return np.asarray(array[index])
    # Without a fill value zarr 2 leaves memory as it is where chunks are absent; zarr 3 has 0.
    cut = [len(range(*i.indices(n))) for i, n in zip(index, shape) if isinstance(i, slice)]
    part = np.zeros(cut, array.dtype)
    array.get_basic_selection(index, out=part)
    return part


def _dims(levels: list[tuple[zarr.Array, list[Axis]]], grid: Grid) -> tuple[tuple[int, ...], ...]:
    places = [grid.letters.index(letter) for letter in "xyz"]
    return tuple(tuple(int(array.shape[place]) for place in places) for array, _ in levels)


def _check_version(path: Path) -> None:
    """Raises LeaflightError where the folder is newer than the package that is to read it."""
    if (path / "zarr.json").is_file() and _ZARR < 3:
        raise LeaflightError(
            f"{path}: it is of Zarr 3, as OME-Zarr from 0.5 on, and the package zarr "
            f"{zarr.__version__} that is installed reads Zarr 2 alone: install zarr 3, or save the "
            "image as OME-Zarr 0.4."
        )


@contextmanager
def _codecs_by_name(path: Path) -> Iterator[None]:
    """Turns the error about a codec that is not at hand into a sentence with its name."""
    try:
        yield
    except ValueError as error:
        absent = re.search(r"codec.*?: '+([^']{1,40})'", str(error))
        if absent is None:
            raise
        raise LeaflightError(
            f"{path}: its chunks are packed by the codec {absent[1]}, which the installed zarr "
            "does not have; save them with another one, such as Blosc."
        ) from None


def _images(path: Path, group: zarr.Group) -> dict[str, dict[str, Any]]:
    """{name: the group of an image}: the folder itself, or those in it as of bioformats2raw."""
    if _multiscales(group):
        return {path.name: group}
    keys = sorted(group.group_keys(), key=lambda key: (len(key), key))[:_MOST_IMAGES]
    found = {key: group[key] for key in keys if _multiscales(group[key])}
    if not found:
        raise LeaflightError(
            f"{path}: it has no multiscale image of OME-Zarr; give the folder of one image, or of "
            "one array."
        )
    return found


def _multiscales(group: zarr.Group) -> Any:
    attributes = group.attrs.asdict()
    return attributes.get("ome", attributes).get("multiscales")


def _levels(path: Path, group: zarr.Group) -> tuple[list[tuple[zarr.Array, list[Axis]]], list[str]]:
    """([(array, its axes)], notes), from the finest resolution on."""
    image = _multiscales(group)[0]
    # Before 0.4 axes were names alone, and before 0.3 always these.
    named = image.get("axes") or ["t", "c", "z", "y", "x"]
    named = [axis if isinstance(axis, dict) else {"name": axis} for axis in named]
    levels, left_out = [], set()
    for part in image["datasets"]:
        array = group[part["path"]]
        if len(named) != array.ndim:
            raise LeaflightError(
                f"{path}: its metadata name {len(named)} axes, but its arrays have {array.ndim}; "
                "repair them."
            )
        steps, firsts, others = _transform([part, image], array.ndim)
        left_out |= others
        axes = [
            _axis(n, axis, first, step)
            for n, axis, first, step in zip(array.shape, named, firsts, steps)
        ]
        levels.append((array, axes))
    notes = [f"Its transformation {kind[:40]!r} is left out." for kind in sorted(left_out)]
    return levels, notes


def _axis(size: int, named: dict[str, Any], first: float, step: float) -> Axis:
    name = str(named["name"])
    kinds = {"time": "t", "channel": "c"}
    letter = name.lower() if name.lower() in tuple("xyztc") else kinds.get(named.get("type", ""))
    return Axis(int(size), name, letter or "", first, step, str(named.get("unit") or ""))


def _transform(parts: Sequence[dict[str, Any]], axes: int) -> tuple[Array, Array, set[str]]:
    """(steps, places of the first samples, kinds of others) by lists of scales and translations."""
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


def _plain_axes(array: zarr.Array) -> list[Axis]:
    """The axes of an array by itself, with the names that Zarr 3 or xarray gives them."""
    names = getattr(getattr(array, "metadata", None), "dimension_names", None)
    names = names or array.attrs.asdict().get("_ARRAY_DIMENSIONS") or ()
    names = names if len(names) == array.ndim else [""] * array.ndim
    return [Axis(int(n), str(name or "")) for n, name in zip(array.shape, names)]
