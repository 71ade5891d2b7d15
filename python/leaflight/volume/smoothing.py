# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaussian smoothing of values, against noise and against terraces of few bits."""

import math
from collections.abc import Iterable

import numpy as np

from .._core import Progress
from ..arrays import Array
from ..paths import AnyPath
from .memory import new_voxels
from .setting_error import SettingError

# Standard deviation in voxels.
MOST_SMOOTH = 10.0

# Cutoff radius in standard deviations. The rest has 0.3 % of the weight.
_REACH = 3.0


def smoothed(values: Array, sigma: float, progress: Progress) -> Array:
    """Returns values, float32 [z, y, x] or [y, x], convolved with a Gaussian.

    sigma: Standard deviation in voxels.
    Voxels without data stay empty and have no weight. Beyond the border the last voxel is repeated.
    Raises Cancelled.
    """
    weights = _weights(sigma)
    planes = values if values.ndim == 3 else values[np.newaxis]
    reach, depth = len(weights) // 2, len(planes)
    kept = new_voxels(planes.shape, np.float32)
    progress.begin("Smoothing")
    if progress.fraction < 1:
        progress.expect(depth)
    for k in range(depth):
        progress.check()
        near = (planes[min(max(k + i, 0), depth - 1)] for i in range(-reach, reach + 1))
        kept[k] = _smooth_plane(planes[k], near, weights)
        progress.advance(1)
    return kept.reshape(values.shape)


def source_of(path: AnyPath, smooth: float, smooth_normals: float, offset: float = 0) -> str:
    """Returns the source of a volume from a file, for its provenance.

    offset: Number that was subtracted from the values.
    """
    less = f", less {offset:.15g}" if offset else ""
    values = f", smoothed by {smooth:g} voxels" if smooth > 0 else ""
    normals = f", normals smoothed by {smooth_normals:g} voxels" if smooth_normals > 0 else ""
    return f"{path}{less}{values}{normals}"


def checked(sigma: float, name: str, whose: AnyPath) -> float:
    """Returns the standard deviation that was asked for. Raises SettingError with this name."""
    if not 0.0 <= sigma <= MOST_SMOOTH:
        raise SettingError(
            f"{whose}: {name} must be 0 to {MOST_SMOOTH:g} voxels, not {sigma:g}.", name
        )
    return sigma


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
    """Returns a plane convolved along its two axes."""
    reach = len(weights) // 2
    for axis in range(2):
        padded = np.pad(plane, [(reach, reach) if a == axis else (0, 0) for a in range(2)], "edge")
        count = plane.shape[axis]
        parts = (padded.take(range(i, i + count), axis) for i in range(len(weights)))
        plane = sum(w * part for w, part in zip(weights, parts))
    return plane
