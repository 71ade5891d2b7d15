# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how often the error that a bake reports covers its true error.

Bakes that differ only in their seed are independent samples of one estimate. z is the deviation of
each from the mean of the others, over the reported error. It shows whether that error is true. The
bias, which all seeds share, does not show.
"""

from dataclasses import dataclass

import numpy as np
from leaflight.bake.color_error import rms
from leaflight.thesis import bake

# Number of standard errors that contain 95 % of a normal distribution.
QUANTILE = 1.959963984540054


@dataclass(frozen=True, eq=False)
class Coverage:
    """The result. z: of each seed and lit texel, float64 (seeds, texels); true_rms and
    reported_rms: of the errors, over the mean radiance.
    """

    z: np.ndarray
    true_rms: float
    reported_rms: float

    def within(self, quantile=QUANTILE):
        """Returns the share of intervals of +- quantile errors that contain the other seeds'
        mean.
        """
        return float((np.abs(self.z) <= quantile).mean())


def coverage(volume, scene=None, *, seeds=6, **settings):
    """Bakes with each of `seeds` seeds. Raises LeaflightError, Cancelled."""
    values, errors = [], []
    for seed in range(1000, 1000 + seeds):
        grid = bake(volume, scene, seed=seed, **settings).grid
        active = grid.mask().astype(bool)
        values.append(grid.dense("radiance")[active].mean(axis=-1, dtype=np.float64))
        errors.append(np.float64(grid.dense("radiance_error")[active]))
    values, errors = np.array(values), np.array(errors)
    # Texels that are dark with all seeds have no error and no interval.
    lit = values.any(axis=0)
    values, errors = values[:, lit], errors[:, lit]
    # The mean of the others has the error of a bake over sqrt(seeds - 1). Scale the deviation from
    # it to the error of one bake.
    deviations = (values - values.mean(axis=0)) * np.sqrt(seeds / (seeds - 1))
    z = np.divide(deviations, errors, out=np.full_like(errors, np.inf), where=errors > 0)
    z[deviations == 0] = 0
    mean = values.mean()
    return Coverage(z, rms(deviations[..., None]) / mean, rms(errors[..., None]) / mean)
