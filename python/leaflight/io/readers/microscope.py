# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads files of microscopes in a subprocess, because their libraries trust them."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from functools import partial
from importlib import import_module
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError
from ...arrays import Array
from ..reader_process import ReaderProcess, has_package
from .channels import Channel, channel_of_json
from .checks import check_scalar, listed, text
from .stack import Axes, Blocks, Stack, stack_of, stored
from .stored import StoredVolume
from .voxel_size import voxel_size


@dataclass(frozen=True)
class Picture:
    """One image of a file, as the module of its format describes it.

    outer, inner: As in Blocks. P (position) separates volumes.
    dtype: Name of the type of the values.
    sizes: Voxel sizes along x, y and z, None if unknown.
    unit: Unit of the sizes.
    channel_list: Names and colors along C; empty if unknown.
    """

    name: str
    outer: Axes
    inner: Axes
    dtype: str
    sizes: Sequence[float | None] = (None, None, None)
    unit: str = "µm"
    channel_list: Sequence[Channel] = ()

    @property
    def axes(self) -> Axes:
        return (*self.outer, *self.inner)


@dataclass(frozen=True)
class Format:
    """A format of microscopes.

    name: Name for display.
    package: Package that reads it.
    module: Module of this package with pictures(path) and blocks(path, number, places).
    The first returns the Pictures of a file. The second yields the blocks of a Picture at these
    places along its outer axes, and checks that they are in the file.
    """

    name: str
    package: str
    module: str


def open_pictures(
    path: Path,
    dataset: str | None = None,
    spacing: float | Sequence[float] | None = None,
    *,
    kind: Format,
) -> StoredVolume:
    """Opens the only volume of a file, or the image that dataset names."""
    if not has_package(kind.package):
        raise ModuleNotFoundError(name=kind.package)
    with ReaderProcess(path, kind.name, __name__, "describe", kind.module) as process:
        pictures = [_picture(**one) for one in process.answer()]
    volumes: list[tuple[str, Callable[[], Stack]]] = []
    flat = []
    for number, picture in enumerate(pictures):
        for name, position, one in _positions(picture):
            made = _upright(one)
            if made is None:
                size = [n for axis, n in reversed(one.inner) if axis not in "CS"]
                flat.append(f"{name} {text(size)} pixels".strip())
            else:
                volumes.append((name, partial(_stack, path, kind, number, position, made)))
    if not volumes:
        raise LeaflightError(
            f"{path}: the images are single planes ({listed(flat)}), but a volume needs three "
            "dimensions; choose another file."
        )
    stored_volume = stored(path, volumes, dataset, spacing)
    if not flat:
        return stored_volume
    note = f"Single planes in the file are left out: {listed(flat)}."
    return replace(stored_volume, notes=(*stored_volume.notes, note))


def _picture(
    outer: list[list[Any]], inner: list[list[Any]], channel_list: list[Any], **others: Any
) -> Picture:
    """Returns the Picture of JSON data, with tuples for lists."""
    channels = tuple(channel_of_json(**one) for one in channel_list)
    axes = [tuple((str(name), int(n)) for name, n in one) for one in (outer, inner)]
    return Picture(outer=axes[0], inner=axes[1], channel_list=channels, **others)


def _positions(picture: Picture) -> Iterator[tuple[str, tuple[int, int] | None, Picture]]:
    """Yields (name, (index of the axis of positions, position) or None, Picture) of each volume."""
    places = [k for k, (name, n) in enumerate(picture.outer) if name == "P" and n > 1]
    if not places:
        yield picture.name, None, picture
        return
    place = places[0]
    left = (*picture.outer[:place], *picture.outer[place + 1 :])
    for position in range(picture.outer[place][1]):
        name = f"{picture.name} position {position}".strip()
        yield name, (place, position), replace(picture, name=name, outer=left)


def _upright(picture: Picture) -> tuple[Picture, str] | None:
    """Returns a picture with X and Y along rows and columns, and its order.

    Microscopes also scan other planes, such as xz. Returns None if it is no volume, nor a film of
    planes.
    """
    row, column = [name for name, _ in picture.inner if name != "S"][:-3:-1]
    if not {row, column} <= set("XYZ"):
        return None
    order = row + column + next(axis for axis in "ZYX" if axis not in (row, column))
    names = dict(zip(order, "XYZ"))
    outer, inner = (
        tuple((names.get(name, name), n) for name, n in axes)
        for axes in (picture.outer, picture.inner)
    )
    if not any(n > 1 and name in "ZT" for name, n in outer):
        return None
    return replace(picture, outer=outer, inner=inner), order


def _stack(
    path: Path,
    kind: Format,
    number: int,
    position: tuple[int, int] | None,
    upright: tuple[Picture, str],
) -> Stack:
    picture, order = upright
    check_scalar(path, picture.dtype)
    blocks = Blocks(
        picture.outer,
        picture.inner,
        np.dtype(picture.dtype),
        partial(_open_blocks, path, kind, number, position, picture),
        3,
        "S" in dict(picture.inner),
        tuple(picture.channel_list),
    )
    voxel = voxel_size(picture.sizes, [picture.unit] * 3, "µm")
    return stack_of(path, blocks, voxel, (), order)


@contextmanager
def _open_blocks(
    path: Path,
    kind: Format,
    number: int,
    position: tuple[int, int] | None,
    picture: Picture,
    numbers: Sequence[int],
) -> Iterator[Callable[[int], Array]]:
    """Yields a function for Blocks that returns one block after the other from a subprocess."""
    shape = [n for _, n in picture.inner]
    places = [_place(picture.outer, k, position) for k in numbers]
    options = (kind.module, number, places, picture.dtype)
    most = prod(shape) * np.dtype(picture.dtype).itemsize
    with ReaderProcess(path, kind.name, __name__, "read", *options) as process:
        process.answer()

        def read(_number: int) -> Array:
            block = process.array(most)
            if list(block.shape) != shape or block.dtype != picture.dtype:
                raise process.died()
            return block

        yield read


def _place(outer: Axes, number: int, position: tuple[int, int] | None) -> list[int]:
    """Returns the position of a block along the outer axes of its picture, with P."""
    place: list[int] = []
    for _, n in reversed(outer):
        number, k = divmod(number, n)
        place.insert(0, k)
    if position is not None:
        place.insert(*position)
    return place


def describe(path: Path, module: str) -> tuple[list[dict[str, Any]], tuple[()]]:
    """Returns the pictures of a file. Runs in the subprocess."""
    return [asdict(one) for one in import_module(module).pictures(path)], ()


def read(
    path: Path, module: str, number: int, places: list[list[int]], dtype: str
) -> tuple[None, Iterator[Array]]:
    """Yields blocks of a picture. Runs in the subprocess."""
    blocks = import_module(module).blocks(path, number, places)
    return None, (np.ascontiguousarray(block, dtype=dtype) for block in blocks)
