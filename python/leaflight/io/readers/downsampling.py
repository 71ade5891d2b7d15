# SPDX-License-Identifier: GPL-3.0-or-later
"""Downsamples volumes while they are read."""

from pathlib import Path

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.voxels import held_type, new_voxels
from .checks import text
from .watched import watched


def downsampled(path: Path, values: Array, step: int, progress: Progress) -> Array:
    """Returns means of step^3 voxels each, rounded if the values are integers.

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
        mean = slab.reshape(step, ny, step, nx, step).mean(axis=(0, 2, 4), dtype=np.float32)
        kept[k] = np.rint(mean) if kept.dtype.kind in "iu" else mean
    return kept
