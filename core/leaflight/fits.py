# SPDX-License-Identifier: GPL-3.0-or-later
"""What curves of error tell: slopes, noise and floor, and where two of them break even.

All fits are least squares of relative deviations, and intervals are those of 95 %.
"""

from dataclasses import dataclass

import numpy as np

from ._core import LeaflightError

CONFIDENCE = 0.95
# Fits drawn to see how far a break-even is certain.
DRAWS = 4000


@dataclass(frozen=True)
class Estimate:
    """A value and its interval of 95 %; NaN where there are too few points."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Fit:
    """y = sum of coefficients times columns.

    coefficients: (k,); covariance: (k, k); freedom: points less coefficients.
    """

    coefficients: np.ndarray
    covariance: np.ndarray
    freedom: int

    def interval(self, number):
        """The Estimate of a coefficient."""
        value = float(self.coefficients[number])
        reach = quantile(self.freedom) * float(np.sqrt(self.covariance[number, number]))
        return Estimate(value, value - reach, value + reach)

    def drawn(self, count, rng):
        """Coefficients (count, k) as they may be: Student's t around the fit."""
        if self.freedom < 1:
            return np.full((count, len(self.coefficients)), np.nan)
        normal = rng.multivariate_normal(
            np.zeros(len(self.coefficients)), self.covariance, count, method="svd"
        )
        shrink = np.sqrt(rng.chisquare(self.freedom, count) / self.freedom)
        return self.coefficients + normal / shrink[:, None]


def quantile(freedom):
    """By how many standard errors a value may be off, at so many degrees of freedom."""
    if freedom < 1:
        return float("nan")
    return float(_statistics().t.ppf(0.5 + 0.5 * CONFIDENCE, freedom))


def slope(samples, errors):
    """The Estimate of d log error / d log samples."""
    x = np.log(np.float64(samples))
    fit = _least_squares(np.stack([np.ones_like(x), x], axis=1), np.log(np.float64(errors)))
    return fit.interval(1)


def noise_and_floor(samples, errors):
    """The Fit of error^2 = floor^2 + a / samples: its coefficients are (floor^2, a)."""
    squares = np.square(np.float64(errors))
    columns = np.stack([np.ones_like(squares), 1.0 / np.float64(samples)], axis=1)
    return _relative(columns, squares)


def cost(samples, seconds):
    """The Fit of seconds = start + each * samples: its coefficients are (start, each)."""
    seconds = np.float64(seconds)
    columns = np.stack([np.ones_like(seconds), np.float64(samples)], axis=1)
    return _relative(columns, seconds)


def root(estimate):
    """The Estimate of the square root, of what may be below 0 by chance."""
    values = (estimate.value, estimate.low, estimate.high)
    return Estimate(*(float(np.sqrt(max(0.0, value))) for value in values))


def samples_for(error, fit):
    """Samples with which error^2 = floor^2 + a / samples; infinite below the floor."""
    return _samples_for(error, fit.coefficients[None])[0]


def seconds_for(error, fit, costs):
    """Seconds that an error takes by two Fits, of the error and of the cost; may be infinite."""
    return _seconds(error, fit.coefficients[None], costs.coefficients[None])[0]


def break_even(error, bake, other, seed=0):
    """The Estimate of how many isosurfaces one bake is worth, when both have the error.

    bake, other: (Fit of the error, Fit of the cost), of the bake and of one isosurface. The value
    is infinite where the bake cannot reach the error and 0 where the other cannot.
    """
    rng = np.random.default_rng(seed)

    def ratio(coefficients):
        bake_seconds, other_seconds = (_seconds(error, *coefficients[i : i + 2]) for i in (0, 2))
        with np.errstate(invalid="ignore"):
            return bake_seconds / other_seconds

    fits = [*bake, *other]
    value = float(ratio([fit.coefficients[None] for fit in fits])[0])
    drawn = ratio([fit.drawn(DRAWS, rng) for fit in fits])
    tail = 0.5 * (1.0 - CONFIDENCE)
    # Not the mean of two neighbours, of which one may be infinite.
    low, high = np.quantile(drawn, (tail, 1.0 - tail), method="nearest")
    return Estimate(value, float(low), float(high))


def _samples_for(error, coefficients):
    """Of coefficients (n, 2); noise and floor are not below 0."""
    floor_squared, a = np.maximum(coefficients, 0.0).T
    above = error**2 - floor_squared
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(above > 0, a / above, np.inf)


def _seconds(error, coefficients, costs):
    samples = _samples_for(error, coefficients)
    start, each = np.maximum(costs, 0.0).T
    return start + each * samples


def _relative(columns, values):
    """Least squares of relative deviations from values (n,) above 0."""
    return _least_squares(columns / values[:, None], np.ones_like(values))


def _least_squares(columns, values):
    coefficients, *_ = np.linalg.lstsq(columns, values, rcond=None)
    freedom = len(values) - columns.shape[1]
    if freedom < 1:
        return Fit(coefficients, np.full((columns.shape[1],) * 2, np.nan), freedom)
    residuals = values - columns @ coefficients
    covariance = np.linalg.inv(columns.T @ columns) * (residuals @ residuals) / freedom
    return Fit(coefficients, covariance, freedom)


def check_statistics():
    """Raises LeaflightError unless there is what intervals are made with."""
    _statistics()


def _statistics():
    try:
        from scipy import stats
    except ImportError:
        raise LeaflightError(
            "The report's intervals need SciPy: install the Debian package python3-scipy."
        ) from None
    return stats
