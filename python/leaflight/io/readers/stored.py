# SPDX-License-Identifier: GPL-3.0-or-later
"""A volume in its file: what is known of it before its voxels are read."""

from collections.abc import Callable
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from ..._core import Progress
from ...arrays import Array
from ...volume.volume import Volume
from ...volume.voxels import held_type


@dataclass(frozen=True)
class StoredVolume:
    """The facts of a file's header, and how to read the rest.

    dims: voxels (nx, ny, nz), None where only reading shows; dtype: of the values as they come.
    load: load(frame, channel, progress) reads one scalar volume, its values an array [z, y, x] or
        what can be sliced like one, of any type of real numbers; it reports to the core's Progress,
        and raises Cancelled once that is cancelled.
    voxel_size: (x, y, z) in `unit`, None where only reading shows; unit: a key of METERS, "" where
        the file does not say.
    frames, channels: how many volumes there are to choose from, over time and otherwise.
    levels: dims of each resolution that the file holds, finest first; datasets: names of the
        volumes in it. Both empty where there is but one.
    patient: whether its world coordinates are a patient's: towards right, front and up.
    missing: numbers that the header itself names as fill values; they are NaN in the volume where
        they lie far from all other values.
    notes: sentences for the user about choices that the header left to the reader, such as slices
        that it leaves out. load() may add others, as notes of its Volume.
    """

    dims: tuple[int, ...] | None
    dtype: np.dtype[Any]
    load: Callable[[int, int, Progress], Volume]
    voxel_size: tuple[float, ...] | None = None
    unit: str = ""
    frames: int = 1
    channels: int = 1
    levels: tuple[tuple[int, ...], ...] = ()
    datasets: tuple[str, ...] = ()
    patient: bool = False
    missing: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()

    def bytes(self, downsample: int = 1) -> int | None:
        """Memory of the voxels once they are read, None where only reading shows."""
        if self.dims is None:
            return None
        halved = (max(1, n // downsample) for n in self.dims)
        return prod(halved) * held_type(np.dtype(self.dtype)).itemsize


def lengths(index_to_world: Array) -> tuple[float, ...]:
    """The sizes (x, y, z) of a voxel."""
    return tuple(float(n) for n in np.linalg.norm(np.asarray(index_to_world)[:3, :3], axis=0))
