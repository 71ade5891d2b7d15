# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes stored in planes: TIFF stacks, folders of slices, files of microscopes."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from ...volume.voxels import new_voxels
from .channels import Channel
from .checks import choose_named, index_to_world, text, undecided
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
    if name is None:
        return StoredVolume(None, np.dtype(np.float32), undecided(path, names), datasets=names)
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
