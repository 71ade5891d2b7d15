# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts values of files for volumes: without fill values, and fit for single precision."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..._core import Progress
from ...arrays import Array
from ...volume.few_steps import common_offset
from ...volume.fill_values import Number, occurring
from ...volume.volume import Volume
from ...words import figures

# Planes to examine before a volume is downsampled.
_PLANES = 64
# Largest integer below which all integers are exact in single precision.
_EXACT = 1 << 24


class Usable:
    """Values [z, y, x] that can be sliced as an array: float32, NaN if missing.

    missing: Fill values.
    offset: Number that is subtracted from the other values.
    """

    dtype = np.dtype(np.float32)

    def __init__(self, stored: Array, missing: Sequence[Number], offset: Number) -> None:
        self.stored, self._missing, self._offset = stored, missing, offset
        self.shape, self.ndim, self.size = stored.shape, stored.ndim, stored.size

    def __len__(self) -> int:
        return len(self.stored)

    def __getitem__(self, index: Any) -> Array:
        part = np.asarray(self.stored[index])
        # 64-bit integers stay exact. Values that leave the range of the type are missing.
        of_type = part.dtype if part.dtype.kind in "iu" else np.dtype(np.float64)
        less = part - of_type.type(self._offset) if self._offset else part
        values = np.array(less, np.float32, ndmin=part.ndim)
        for value in self._missing:
            values[part == value] = np.nan
        return values


def usable(
    stored: Array, named: Sequence[float], step: int, progress: Progress
) -> tuple[Any, Number, tuple[str, ...]]:
    """Returns (values, the offset that was subtracted, sentences about them).

    stored: Result of load() of a StoredVolume.
    named: Fill values in the header.
    step: Number of voxels along each axis that are averaged.
    """
    if stored.dtype.itemsize == 1 and not named:
        return stored, 0, ()
    every = 1 if step == 1 else max(1, len(stored) // _PLANES)

    def planes() -> Any:
        for k in range(0, len(stored), every):
            progress.check()
            yield np.asarray(stored[k])

    found = occurring(planes(), named)
    offset = common_offset(found.low, found.high, stored.dtype) if found.voxels else 0
    if not found.fills and not offset:
        return stored, 0, ()
    notes = []
    for value, count in found.fills.items():
        least, most = figures(found.low, found.high)
        notes.append(
            f"{_share(count / found.voxels)} of the voxels are {value:.7g}, far from all other "
            f"values {least}..{most}: they are read as missing data."
        )
    if offset:
        least, most = figures(found.low, found.high)
        notes.append(
            f"The values {least}..{most} differ too little for single precision: {offset:.15g} is "
            "subtracted from them and from isovalues."
        )
    return Usable(stored, tuple(found.fills), offset), offset, tuple(notes)


def about_labels(volume: Volume) -> list[str]:
    """Returns sentences about a mask or a label map."""
    found = volume.distribution
    if not found.are_labels or found.levels is None:
        return []
    levels, _ = found.levels
    kind = "a mask" if len(levels) == 2 else "labels"
    notes = [
        f"The volume holds {len(levels)} different values, like {kind}: Smooth (--smooth 1) "
        "removes the steps of its isosurfaces."
    ]
    if np.abs(levels).max() > _EXACT:
        notes.append(
            f"Single precision keeps 7 digits of labels up to {levels[-1]:.0f}: neighboring "
            "numbers may have become equal."
        )
    return notes


def _share(share: float) -> str:
    percent = 100.0 * share
    return f"{percent:.0f} %" if percent >= 1.0 else f"{percent:.1g} %"
