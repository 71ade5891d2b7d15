# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes stored in planes: TIFF stacks, folders of slices, files of microscopes.

A picture with any axes becomes a series of volumes: its depth and its frames are chosen.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from itertools import groupby
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.memory import new_voxels
from ...volume.volume import Volume
from .channels import RGB, Channel
from .checks import choose_named, index_to_world, text
from .stored import StoredVolume, lengths
from .voxel_size import VoxelSize
from .watched import watched


@dataclass(frozen=True)
class Stack:
    """One volume of a file, or a series of them.

    shape: Sizes (depth, height, width).
    dtype: Type of the values.
    planes: planes(frame, channel) yields the planes [y, x] of one volume, lowest first. Each is
        read completely.
    channel_list: As in StoredVolume.
    order: Spatial axes along rows, columns and depth.
    """

    shape: tuple[int, int, int]
    dtype: np.dtype[Any]
    planes: Callable[[int, int], Iterable[Array]]
    frames: int = 1
    channels: int = 1
    voxel: VoxelSize | None = None
    notes: tuple[str, ...] = ()
    order: str = "XYZ"
    channel_list: tuple[Channel, ...] = ()


def stored(
    path: Path,
    volumes: Sequence[tuple[str, Callable[[], Stack]]],
    dataset: str | None = None,
    spacing: float | Sequence[float] | None = None,
) -> StoredVolume:
    """Returns the StoredVolume of the only volume of a file, or of the one that dataset names.

    volumes: Name of each volume, and a function that returns its Stack.
    """
    names = unique([name for name, _ in volumes])
    name = choose_named(path, names, dataset)
    stack = volumes[names.index(name)][1]()
    notes, voxel = stack.notes, stack.voxel
    if spacing is not None:
        voxel = None
    elif voxel is not None and voxel.note:
        notes = (*notes, voxel.note)
    sizes = voxel.sizes if voxel else 1.0 if spacing is None else spacing
    along = ["XYZ".index(axis) for axis in stack.order]
    matrix = index_to_world(path, sizes)[:, [*along, 3]]

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        return Volume(_filled(path, stack, frame, channel, progress), matrix, path.stem)

    return StoredVolume(
        dims=stack.shape[::-1],
        dtype=stack.dtype,
        load=load,
        voxel_size=lengths(matrix),
        unit=voxel.unit if voxel else "",
        frames=stack.frames,
        channels=stack.channels,
        channel_list=stack.channel_list,
        datasets=names if len(names) > 1 else (),
        notes=notes,
    )


def unique(names: Sequence[str]) -> tuple[str, ...]:
    """Returns the names; repeated ones get their number among all, from 0."""
    return tuple(
        f"{name} #{k}" if not name or names.count(name) > 1 else name
        for k, name in enumerate(names)
    )


def _filled(path: Path, stack: Stack, frame: int, channel: int, progress: Progress) -> Array:
    """Reads one volume. Assigns complete planes, or raises LeaflightError."""
    values = new_voxels(stack.shape, stack.dtype)
    planes = iter(stack.planes(frame, channel))
    for k in watched(progress, range(stack.shape[0])):
        plane = next(planes, None)
        if plane is None or plane.shape != stack.shape[1:]:
            found = "missing" if plane is None else text(plane.shape[::-1])
            raise LeaflightError(
                f"{path}: plane {k} is {found}, but the others are {text(stack.shape[:0:-1])}: "
                "the file is damaged, fetch it again."
            )
        if not np.can_cast(plane.dtype, values.dtype):
            values = values.astype(np.promote_types(plane.dtype, values.dtype))
        values[k] = plane
    return values


Axes = tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Blocks:
    """An array in a file, which is read block by block.

    outer, inner: Names and lengths of the axes outside and within a block, slowest first. Names are
        X, Y, Z, T (time), C (channel), S (color), or any other letter.
    open: open(numbers) is a context manager. It yields a function that reads a whole block by its
        number. Blocks are read in the order of `numbers`.
    samples: Number of samples of S that are values. The rest is alpha.
    colors: True if the samples are RGB.
    channel_list: Names and colors along C; empty if unknown.
    """

    outer: Axes
    inner: Axes
    dtype: np.dtype[Any]
    open: Callable[[Sequence[int]], AbstractContextManager[Callable[[int], Array]]]
    samples: int = 1
    colors: bool = False
    channel_list: tuple[Channel, ...] = ()

    @property
    def axes(self) -> Axes:
        return (*self.outer, *self.inner)


@dataclass(frozen=True)
class _Roles:
    """The axes of a picture, by number: depth, frames (None for one), and others."""

    depth: int
    frames: int | None
    channels: tuple[int, ...]


def has_depth(axes: Axes) -> bool:
    """Returns True if a picture with these axes is a volume."""
    return _roles(axes) is not None


def stack_of(
    path: Path,
    blocks: Blocks,
    voxel: VoxelSize | None = None,
    notes: tuple[str, ...] = (),
    order: str = "XYZ",
) -> Stack:
    """Returns the Stack of a picture that has a depth. Raises LeaflightError.

    order: As in Stack.
    """
    axes = tuple((a, blocks.samples if a == "S" else n) for a, n in blocks.axes)
    sizes = dict(axes)
    roles = _roles(axes)
    assert roles is not None
    depth, frames = axes[roles.depth][1], 1 if roles.frames is None else axes[roles.frames][1]
    gray = blocks.colors and _is_gray(blocks, roles)
    if gray:
        channels = tuple(k for k in roles.channels if axes[k][0] != "S")
        roles = _Roles(roles.depth, roles.frames, channels)

    def planes(frame: int, channel: int) -> Iterator[Array]:
        places = [_index(axes, roles, frame, channel, z) for z in range(depth)]
        for k, plane in enumerate(_planes(blocks, places, gray)):
            if gray and not _equal_samples(plane):
                raise LeaflightError(
                    f"{path}: plane {k} is in color, but the first one is gray; convert all "
                    "planes to gray."
                )
            yield plane[..., 0] if gray else plane

    return Stack(
        (depth, sizes["Y"], sizes["X"]),
        blocks.dtype,
        planes,
        frames,
        prod(axes[k][1] for k in roles.channels),
        voxel,
        notes,
        order,
        _channel_list(blocks, [axes[k] for k in roles.channels]),
    )


def _channel_list(blocks: Blocks, axes: Sequence[tuple[str, int]]) -> tuple[Channel, ...]:
    """Returns the names and colors of channels along these axes; none if an axis has none."""
    if [name for name, _ in axes] == ["S"] and blocks.colors:
        return RGB
    count = len(blocks.channel_list)
    return blocks.channel_list if list(axes) == [("C", count)] else ()


def picture(blocks: Blocks) -> Array:
    """Reads the pixels [y, x] or RGB [y, x, s] of a picture without a depth."""
    first = [[0] * len(blocks.axes)]
    (plane,) = _planes(blocks, first, blocks.colors)
    return plane


def _roles(axes: Axes) -> _Roles | None:
    """Returns the roles of axes, None for a picture without a depth.

    The depth is the first of: Z, an unknown axis, time, channel. Frames are the first of: time,
        another unknown axis.
    """
    left = [k for k, (name, n) in enumerate(axes) if n > 1 and name not in "YX"]

    def named(names: str) -> list[int]:
        return [k for k in left if axes[k][0] in names]

    unknown = [k for k in left if axes[k][0] not in "ZTCS"]
    depths = named("Z") or unknown[-1:] or named("T") or named("C")
    if not depths:
        return None
    left.remove(depths[0])
    frames = next(iter(named("T") or [k for k in unknown if k in left]), None)
    return _Roles(depths[0], frames, tuple(k for k in left if k != frames))


def _index(axes: Axes, roles: _Roles, frame: int, channel: int, z: int) -> list[int]:
    """Returns the index of a plane along each axis."""
    index = [0] * len(axes)
    index[roles.depth] = z
    if roles.frames is not None:
        index[roles.frames] = frame
    for k in reversed(roles.channels):
        channel, index[k] = divmod(channel, axes[k][1])
    return index


def _planes(blocks: Blocks, indices: Sequence[Sequence[int]], samples: bool) -> Iterator[Array]:
    """Yields the planes [y, x] at these indices, or [y, x, s] with all samples."""
    names = [name for name, _ in blocks.inner]
    letters = "YXS" if samples else "YX"
    order = [name for name in names if name in letters]
    split = len(blocks.outer)
    numbers = [_place(blocks.outer, index[:split]) for index in indices]
    with blocks.open([number for number, _ in groupby(numbers)]) as read:
        last, block = -1, None
        for index, number in zip(indices, numbers):
            if block is None or number != last:
                last, block = number, read(number)
            part = tuple(slice(None) if a in letters else k for a, k in zip(names, index[split:]))
            yield block[part].transpose([order.index(name) for name in letters if name in order])


def _place(axes: Axes, index: Sequence[int]) -> int:
    place = 0
    for (_, n), k in zip(axes, index):
        place = place * n + k
    return place


def _is_gray(blocks: Blocks, roles: _Roles) -> bool:
    """Returns True if the first, the middle and the last plane have only gray colors."""
    depth = blocks.axes[roles.depth][1]
    looked_at = sorted({0, depth // 2, depth - 1})
    indices = [_index(blocks.axes, roles, 0, 0, z) for z in looked_at]
    return all(_equal_samples(plane) for plane in _planes(blocks, indices, True))


def _equal_samples(plane: Array) -> bool:
    """Returns True if red, green and blue are equal in all pixels [y, x, s]."""
    red = plane[..., :1]
    return bool((plane[..., 1:3] == red).all())
