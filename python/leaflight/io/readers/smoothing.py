# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes smoothed by a Gaussian while they are read: against noise, and terraces of few bits."""

import math
import os
from collections.abc import Iterable

import numpy as np

from ..._core import Progress
from ...arrays import Array
from ...volume.voxels import new_voxels
from .watched import watched

# In standard deviations; what lies beyond has 0.3 % of the weight.
_REACH = 3.0


def smoothed(values: Array, sigma: float, progress: Progress) -> Array:
    """float32 [z, y, x]: the values under a Gaussian of this standard deviation in voxels.

    A voxel without data keeps none and has no weight; beyond the border the last voxel goes on.
    """
    weights = _weights(sigma)
    reach, depth = len(weights) // 2, values.shape[0]
    kept = new_voxels(values.shape, np.float32)
    for k in watched(progress, range(depth), "Smoothing"):
        planes = (values[min(max(k + i, 0), depth - 1)] for i in range(-reach, reach + 1))
        kept[k] = _smooth_plane(values[k], planes, weights)
    return kept


def source_of(path: str | os.PathLike[str], sigma: float) -> str:
    """The source of a volume from this file, for its provenance."""
    return f"{path}, smoothed by {sigma:g} voxels" if sigma > 0 else str(path)


def _weights(sigma: float) -> Array:
    reach = math.ceil(_REACH * sigma)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    return np.asarray(weights / weights.sum(), np.float32)


def _smooth_plane(plane: Array, planes: Iterable[Array], weights: Array) -> Array:
    total: Array | float = 0.0
    weight: Array | float = 0.0
    for each, w in zip(planes, weights):
        known = np.isfinite(each) if each.dtype.kind == "f" else None
        if known is None or known.all():
            total, weight = total + w * each, weight + w
        else:
            total, weight = total + w * np.where(known, each, 0), weight + w * known
    total = _along_both(np.asarray(total, np.float32), weights)
    if np.ndim(weight):
        with np.errstate(invalid="ignore", divide="ignore"):
            total /= _along_both(np.asarray(weight, np.float32), weights)
        total[~np.isfinite(plane)] = np.nan
    return total


def _along_both(plane: Array, weights: Array) -> Array:
    """A plane under the Gaussian along its two axes."""
    reach = len(weights) // 2
    for axis in range(2):
        padded = np.pad(plane, [(reach, reach) if a == axis else (0, 0) for a in range(2)], "edge")
        count = plane.shape[axis]
        parts = (padded.take(range(i, i + count), axis) for i in range(len(weights)))
        plane = sum(w * part for w, part in zip(weights, parts))
    return plane
