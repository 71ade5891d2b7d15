# SPDX-License-Identifier: GPL-3.0-or-later
"""Detects masks and label maps: few values, and each fills connected pieces."""

import numpy as np

from ..arrays import Array
from .voxels import as_voxels

# Least share of the voxels of a label whose next neighbors along all axes have the same label, and
# least share of labels that pass. In a mask with soft edges, only the inside passes.
ALIKE, LABELS = 0.2, 0.6
# Upper bound on the slices that are examined.
_PLANES = 64


def are_labels(values: Array, levels: Array) -> bool:
    """Returns True if values [z, y, x] look like labels.

    levels: All different values in ascending order; the first is the background. Two levels are a
        mask. More must be whole numbers in connected pieces.
    """
    if len(levels) <= 2 or not (levels == np.rint(levels)).all():
        return len(levels) == 2
    voxels = np.zeros(len(levels), np.int64)
    alike = np.zeros(len(levels), np.int64)
    for k in range(0, len(values) - 1, max(1, len(values) // _PLANES)):
        plane, behind = as_voxels(values[k]), as_voxels(values[k + 1])
        here = plane[..., :-1]
        is_alike = (here == plane[..., 1:]) & (here == behind[..., :-1])
        if plane.ndim > 1:
            is_alike[:-1] &= here[:-1] == here[1:]
        voxels += _occurrences(here, levels)
        alike += _occurrences(here[is_alike], levels)
    seen = np.flatnonzero(voxels[1:]) + 1
    return len(seen) > 0 and bool(np.mean(alike[seen] >= ALIKE * voxels[seen]) >= LABELS)


def _occurrences(values: Array, levels: Array) -> Array:
    """Returns the number of values at each level. Values may be NaN."""
    known = values[np.isfinite(values)]
    return np.bincount(np.searchsorted(levels, known), minlength=len(levels))
