# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes smoothed by a Gaussian while they are read: against noise, and terraces of few bits."""

import math

import numpy as np

from ...volume.voxels import new_voxels
from .watched import watched

# In standard deviations; what lies beyond has 0.3 % of the weight.
_REACH = 3.0


def smoothed(values, sigma, progress):
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


def source_of(path, sigma):
    """The source of a volume from this file, for its provenance."""
    return f"{path}, smoothed by {sigma:g} voxels" if sigma > 0 else str(path)


def _weights(sigma):
    reach = math.ceil(_REACH * sigma)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    return np.float32(weights / weights.sum())


def _smooth_plane(plane, planes, weights):
    total = weight = 0.0
    for each, w in zip(planes, weights):
        known = np.isfinite(each) if each.dtype.kind == "f" else None
        if known is None or known.all():
            total, weight = total + w * each, weight + w
        else:
            total, weight = total + w * np.where(known, each, 0), weight + w * known
    total = _along_both(np.float32(total), weights)
    if np.ndim(weight):
        with np.errstate(invalid="ignore", divide="ignore"):
            total /= _along_both(np.float32(weight), weights)
        total[~np.isfinite(plane)] = np.nan
    return total


def _along_both(plane, weights):
    """A plane under the Gaussian along its two axes."""
    reach = len(weights) // 2
    for axis in range(2):
        padded = np.pad(plane, [(reach, reach) if a == axis else (0, 0) for a in range(2)], "edge")
        count = plane.shape[axis]
        parts = (padded.take(range(i, i + count), axis) for i in range(len(weights)))
        plane = sum(w * part for w, part in zip(weights, parts))
    return plane
