# SPDX-License-Identifier: GPL-3.0-or-later
"""The facts of a volume in a file that are known before its voxels are read."""

from collections.abc import Callable
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from ..._core import Progress
from ...arrays import Array
from ...volume.memory import held_type
from ...volume.volume import Volume
from .channels import Channel


@dataclass(frozen=True)
class StoredVolume:
    """The facts of a file's header, and the function that reads the values.

    dims: Voxels (nx, ny, nz), None if they are known only after reading.
    dtype: Type of the values in the file.
    load: load(frame, channel, progress) reads one scalar volume. Its values are an array [z, y, x]
        of real numbers, or an object that can be sliced as one. It reports to a Progress and raises
        Cancelled.
    voxel_size: Sizes (x, y, z) in `unit`, None if they are known only after reading.
    unit: A key of METERS, "" if the file has none.
    frames, channels: Numbers of volumes over time, and of other components.
    channel_list: Names and colors of all channels; empty if the file has none.
    levels: Dims of each resolution in the file, finest first; empty if there is only one.
    datasets: Names of the volumes in the file; empty if there is only one.
    patient: True if world coordinates are those of a patient: towards right, front and up.
    missing: Fill values in the header. They become NaN if they are far from all other values.
    notes: Sentences for the user about choices of the reader, such as omitted slices. load() may
        add others as notes of its Volume.
    """

    dims: tuple[int, ...] | None
    dtype: np.dtype[Any]
    load: Callable[[int, int, Progress], Volume]
    voxel_size: tuple[float, ...] | None = None
    unit: str = ""
    frames: int = 1
    channels: int = 1
    channel_list: tuple[Channel, ...] = ()
    levels: tuple[tuple[int, ...], ...] = ()
    datasets: tuple[str, ...] = ()
    patient: bool = False
    missing: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()

    def channel(self, number: int) -> Channel:
        """Returns the name and the color of a channel."""
        return self.channel_list[number] if self.channel_list else Channel()

    def bytes(self, downsample: int = 1) -> int | None:
        """Returns the memory of the voxels after reading, None if unknown."""
        if self.dims is None:
            return None
        halved = (max(1, n // downsample) for n in self.dims)
        return prod(halved) * held_type(np.dtype(self.dtype)).itemsize


def lengths(index_to_world: Array) -> tuple[float, ...]:
    """Returns the voxel size (x, y, z) of a matrix."""
    return tuple(float(n) for n in np.linalg.norm(np.asarray(index_to_world)[:3, :3], axis=0))
