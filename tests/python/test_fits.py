# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the fits of the report with curves of known slope, floor and cost."""

import numpy as np
import pytest
from thesis.fits import (
    break_even,
    cost,
    noise_and_floor,
    quantile,
    root,
    samples_for,
    slope,
)

SAMPLES = 2.0 ** np.arange(8)


def error_of(samples, floor, a):
    return np.sqrt(floor**2 + a / np.float64(samples))


def holds(estimate, value):
    return estimate.low <= value <= estimate.high


@pytest.mark.parametrize("power", [-0.5, -0.7, 0.0])
def test_slope_without_noise(power):
    found = slope(SAMPLES, 3.0 * SAMPLES**power)
    assert found.value == pytest.approx(power, abs=1e-12)
    assert found.high - found.low < 1e-9


def test_floor_without_noise():
    fit = noise_and_floor(SAMPLES, error_of(SAMPLES, 1.5, 80.0))
    assert root(fit.interval(0)).value == pytest.approx(1.5)
    assert fit.interval(1).value == pytest.approx(80.0)
    assert samples_for(np.sqrt(2) * 1.5, fit) == pytest.approx(80.0 / 1.5**2)
    assert samples_for(1.49, fit) == np.inf and samples_for(0.1, fit) == np.inf


@pytest.mark.slow
def test_intervals_hold_the_truth_as_often_as_they_say():
    """Checks errors with a random deviation of 5 %: 95 % of the intervals must contain slope, floor
    and noise.
    """
    rng = np.random.default_rng(0)
    hits = np.zeros(3)
    trials = 1000
    for _ in range(trials):
        noise = rng.lognormal(0.0, 0.05, len(SAMPLES))
        hits[0] += holds(slope(SAMPLES, 4.0 * SAMPLES**-0.5 * noise), -0.5)
        fit = noise_and_floor(SAMPLES, error_of(SAMPLES, 1.0, 25.0) * noise)
        hits[1] += holds(root(fit.interval(0)), 1.0)
        hits[2] += holds(root(fit.interval(1)), 5.0)
    # Allow four standard deviations of a binomial. Only the slope's model is exact. Weights of the
    # others come from measured errors, so allow a little more.
    deviation = 4 * np.sqrt(0.95 * 0.05 * trials)
    assert abs(hits[0] - 0.95 * trials) < deviation
    assert (hits[1:] > 0.90 * trials - deviation).all()


def test_a_floor_that_is_none():
    """Checks that without a floor the interval includes 0."""
    rng = np.random.default_rng(1)
    found = 0
    for _ in range(200):
        noise = rng.lognormal(0.0, 0.03, len(SAMPLES))
        found += root(noise_and_floor(SAMPLES, error_of(SAMPLES, 0, 9) * noise).interval(0)).low > 0
    # Allow 2.5 % of 200, plus four standard deviations.
    assert found <= 5 + 4 * np.sqrt(200 * 0.025)


def test_too_few_points():
    fit = noise_and_floor([1, 2], [3.0, 2.0])
    assert np.isnan(fit.interval(0).high) and np.isnan(quantile(0))
    assert np.isnan(slope([1, 2], [1.0, 0.5]).low)
    assert slope([1, 2], [1.0, 0.5]).value == pytest.approx(-1)


def test_quantiles_are_students():
    assert quantile(1) == pytest.approx(12.706, abs=1e-3)
    assert quantile(5) == pytest.approx(2.571, abs=1e-3)


@pytest.mark.parametrize("power", [-0.5, -0.8])
def test_floor_of_noise_with_another_slope(power):
    errors = np.sqrt(1.5**2 + 80.0 * SAMPLES ** (2 * power))
    fit = noise_and_floor(SAMPLES, errors, power)
    assert root(fit.interval(0)).value == pytest.approx(1.5)
    n = samples_for(2.0, fit)
    assert 1.5**2 + 80.0 * n ** (2 * power) == pytest.approx(4.0)


def fits_of(floor, a, start, each, spread=0.0, seed=0):
    rng = np.random.default_rng(seed)
    errors, seconds = error_of(SAMPLES, floor, a), start + each * SAMPLES
    return (
        noise_and_floor(SAMPLES, errors * rng.lognormal(0, spread, len(SAMPLES))),
        cost(SAMPLES, seconds * rng.lognormal(0, spread, len(SAMPLES))),
    )


def test_break_even():
    found = break_even(2.0, 20.0, *fits_of(0.2, 36.0, 0.5, 0.25))
    expected = 20.0 / (0.5 + 0.25 * 36.0 / (4 - 0.04))
    assert found.value == pytest.approx(expected)
    assert found.low == pytest.approx(expected, rel=1e-3) and found.high == pytest.approx(found.low)


def test_break_even_of_uncertain_fits():
    truth = 20.0 / (0.5 + 0.25 * 36.0 / (4 - 0.04))
    found = [break_even(2.0, 20.0, *fits_of(0.2, 36, 0.5, 0.25, 0.03, k)) for k in range(200)]
    assert all(one.low < one.value < one.high for one in found)
    # Expect 95 % of 200, minus four standard deviations.
    assert sum(holds(one, truth) for one in found) >= 190 - 4 * np.sqrt(200 * 0.95 * 0.05)
    assert found[0] == break_even(2.0, 20.0, *fits_of(0.2, 36, 0.5, 0.25, 0.03, 0))


def test_break_even_of_seconds_that_vary():
    """Checks that the interval contains the ratio of a repeated measurement."""
    fits = fits_of(0.2, 36.0, 0.5, 0.25)
    found = break_even(2.0, 20.0, *fits, varying=0.1)
    assert found.value == break_even(2.0, 20.0, *fits).value
    rng = np.random.default_rng(3)
    bakes, singles = rng.lognormal(0, 0.1 / 1.96, (2, 10_000))
    again = found.value * bakes / singles
    assert np.mean((again > found.low) & (again < found.high)) == pytest.approx(0.95, abs=0.01)


def test_break_even_below_a_floor():
    assert break_even(0.5, 20.0, *fits_of(1.0, 36.0, 0.5, 0.25)).value == 0
