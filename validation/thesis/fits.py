# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits curves of error: slopes, noise and floor, and the break-even of two curves.

All fits are least squares of relative deviations, with 95 % intervals.
"""

from dataclasses import dataclass

import numpy as np
from leaflight.bake.color_error import REACH
from scipy import stats

CONFIDENCE = 0.95
# Number of random fits for the interval of a break-even.
DRAWS = 4000


@dataclass(frozen=True)
class Estimate:
    """A value and its 95 % interval; NaN if there are too few points."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Fit:
    """A fit y = first + second * samples^power.

    coefficients: (first, second); covariance: (2, 2); freedom: points - 2.
    """

    coefficients: np.ndarray
    covariance: np.ndarray
    freedom: int
    power: float = 1.0

    def interval(self, number):
        """Returns the Estimate of a coefficient."""
        value = float(self.coefficients[number])
        reach = quantile(self.freedom) * float(np.sqrt(self.covariance[number, number]))
        return Estimate(value, value - reach, value + reach)

    def drawn(self, count, rng):
        """Returns random coefficients (count, k): Student's t around the fit."""
        if self.freedom < 1:
            return np.full((count, len(self.coefficients)), np.nan)
        normal = rng.multivariate_normal(
            np.zeros(len(self.coefficients)), self.covariance, count, method="svd"
        )
        shrink = np.sqrt(rng.chisquare(self.freedom, count) / self.freedom)
        return self.coefficients + normal / shrink[:, None]


def quantile(freedom):
    """Returns the half width of an interval in standard errors, by degrees of freedom."""
    if freedom < 1:
        return float("nan")
    return float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, freedom))


def slope(samples, errors):
    """Returns the Estimate of d log error / d log samples."""
    return _least_squares(np.log(samples), np.log(errors), 1.0).interval(1)


def noise_and_floor(samples, errors, power=-0.5):
    """Returns the Fit of error^2 = floor^2 + a samples^(2 power), with coefficients (floor^2, a).

    power: the slope of the noise, -0.5 for random samples.
    """
    return _least_squares(samples, np.square(errors), 2.0 * power, relative=True)


def cost(samples, seconds):
    """Returns the Fit of seconds = start + each * samples, with coefficients (start, each)."""
    return _least_squares(samples, seconds, 1.0, relative=True)


def root(estimate):
    """Returns the Estimate of a square root; its argument may be negative by chance."""
    values = (estimate.value, estimate.low, estimate.high)
    return Estimate(*(float(np.sqrt(max(0.0, value))) for value in values))


def samples_for(error, fit):
    """Returns the samples at which a fit of noise and floor has an error; infinite below the
    floor.
    """
    return float(_samples_for(error, fit.coefficients[None], fit.power)[0])


def break_even(error, seconds, fit, costs, varying=0.0, seed=0):
    """Returns the Estimate of the number of isosurfaces that such a bake is worth.

    error, seconds: error and seconds of the bake
    fit, costs: Fits of the error and of the seconds of one isosurface computed without a bake
    varying: share by which the seconds of either may differ between runs (95 %)
    The value is 0 if one isosurface without a bake never reaches the error.
    """
    rng = np.random.default_rng(seed)

    def isosurfaces(errors, prices):
        start, each = np.maximum(prices, 0.0).T
        return seconds / (start + each * _samples_for(error, errors, fit.power))

    value = isosurfaces(fit.coefficients[None], costs.coefficients[None])[0]
    drawn = isosurfaces(fit.drawn(DRAWS, rng), costs.drawn(DRAWS, rng))
    # Divide both, with their variation from run to run.
    drawn *= rng.lognormal(0.0, np.sqrt(2) * varying / REACH, DRAWS)
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = np.quantile(drawn, (tail, 1.0 - tail))
    return Estimate(float(value), float(low), float(high))


def _samples_for(error, coefficients, power):
    """Returns the samples for an error, by coefficients (n, 2); negative noise or floor
    counts as 0.
    """
    floor_squared, a = np.maximum(coefficients, 0.0).T
    above = error**2 - floor_squared
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(above > 0, (a / above) ** (-1.0 / power), np.inf)


def _least_squares(samples, values, power, relative=False):
    """Returns the Fit of values (n,) by least squares; relative: of relative deviations."""
    values = np.float64(values)
    columns = np.stack([np.ones_like(values), np.float64(samples) ** power], axis=1)
    if relative:
        columns, values = columns / values[:, None], np.ones_like(values)
    coefficients, *_ = np.linalg.lstsq(columns, values, rcond=None)
    freedom = len(values) - 2
    if freedom < 1:
        return Fit(coefficients, np.full((2, 2), np.nan), freedom, power)
    residuals = values - columns @ coefficients
    covariance = np.linalg.inv(columns.T @ columns) * (residuals @ residuals) / freedom
    return Fit(coefficients, covariance, freedom, power)
