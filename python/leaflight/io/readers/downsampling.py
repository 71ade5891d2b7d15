# SPDX-License-Identifier: GPL-3.0-or-later
"""Downsamples volumes while they are read."""

from pathlib import Path

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.distribution import Distribution
from ...volume.voxels import held_type, new_voxels
from .checks import text
from .watched import watched

# Number of planes in the middle of a volume that are examined.
_PLANES = 16


def look_like_labels(values: Array) -> bool:
    """Returns True if values [z, y, x] look like labels, and not like a mask."""
    first = max(0, len(values) // 2 - _PLANES // 2)
    planes = np.asarray(values[first : first + _PLANES])
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
