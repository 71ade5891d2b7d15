# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts values of files for volumes: without fill values, and fit for single precision.

Averaging voxels is one of the conversions.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.distribution import Distribution
from ...volume.fill_values import Number, common_offset, occurring
from ...volume.memory import held_type, new_voxels
from ...volume.volume import Volume
from ...words import figures
from .checks import text
from .watched import watched

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


# Number of planes in the middle of a volume that are examined.
_MIDDLE = 16


def look_like_labels(values: Array) -> bool:
    """Returns True if values [z, y, x] look like labels, and not like a mask."""
    first = max(0, len(values) // 2 - _MIDDLE // 2)
    planes = np.asarray(values[first : first + _MIDDLE])
    known = planes[np.isfinite(planes)]
    if not known.size:
        return False
    found = Distribution(planes, (float(known.min()), float(known.max())))
    return found.are_labels and found.levels is not None and len(found.levels[0]) > 2


def downsampled(
    path: Path, values: Array, step: int, progress: Progress, taken: int | None = None
) -> Array:
    """Returns means of step^3 voxels each, rounded if the values are integers.

    taken: Index along each axis of the voxel to take instead of the mean. None takes the mean.
    values: An array [z, y, x], or an object that can be sliced as one. Only `step` planes are in
        memory at once.
    Incomplete blocks at the far ends are dropped. A mean with a missing voxel is missing. Raises
    LeaflightError if fewer than 2 voxels along an axis would be left.
    """
    shape = tuple(n // step for n in values.shape)
    if min(shape) < 2:
        raise LeaflightError(
            f"{path}: the {text(values.shape[::-1])} voxels are too few to average {step} along "
            "each axis; choose a smaller number."
        )
    nz, ny, nx = shape
    kept = new_voxels(shape, held_type(values.dtype))
    for k in watched(progress, range(nz), "Averaging voxels"):
        slab = np.asarray(values[k * step : (k + 1) * step, : ny * step, : nx * step])
        if taken is not None:
            kept[k] = slab[taken, taken::step, taken::step]
            continue
        mean = slab.reshape(step, ny, step, nx, step).mean(axis=(0, 2, 4), dtype=np.float32)
        kept[k] = np.rint(mean) if kept.dtype.kind in "iu" else mean
    return kept
