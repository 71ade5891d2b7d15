# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiance of a reference at points, and errors of other radiance against it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..bake.color_error import noise_percent, rms, rms_percent
from .cycles import Measured

FIGURES = (
    "rms_percent",
    "relative_rms",
    "reference_noise_percent",
    "mean_radiance",
    "mean_ratio",
    "mean_ratio_error",
)


@dataclass(frozen=True, eq=False)
class Truth:
    """The radiance of a reference at points, and its standard error: float64 (n, 3) each.

    weights: Weights of means over the points, (n,).
    mean_error: Function from a mask (n,) to the standard error of the mean radiance over its
        points.
    """

    points: Array
    weights: Array
    radiance: Array
    standard_error: Array
    mean_error: Callable[[Array], float]

    @classmethod
    def traced(cls, points: Array, radiance: Array, standard_error: Array) -> "Truth":
        """Returns the Truth by the core's path tracer, whose points are independent."""
        error = standard_error.astype(np.float64)

        def mean_error(mask: Array) -> float:
            return float(np.sqrt((error[mask].mean(axis=1) ** 2).sum()) / mask.sum())

        weights = np.ones(len(points))
        return cls(points, weights, radiance.astype(np.float64), error, mean_error)

    @classmethod
    def of_passes(cls, points: Array, weights: Array, passes: Array) -> "Truth":
        """Returns the mean of independent passes, [pass, n, RGB], with errors by their spread.

        So the errors also hold for stratified samples within a pass, which have less noise than
        random ones.
        """
        passes = passes.astype(np.float64)

        def error(values: Array) -> Array:
            found: Array = values.std(axis=0, ddof=1) / np.sqrt(len(passes))
            return found

        def mean_error(mask: Array) -> float:
            means = np.average(passes[:, mask].mean(axis=2), axis=1, weights=weights[mask])
            return float(error(means))

        return cls(points, weights, passes.mean(axis=0), error(passes), mean_error)

    @classmethod
    def measured(cls, measured: Measured) -> "Truth":
        """Returns the Truth by Cycles (cycles.py)."""
        return cls.of_passes(measured.probes.points, measured.probes.weights, measured.passes)


def parts_of(
    radiance: Array, error: Array, path: Truth, truth: Truth, exposure: float
) -> dict[str, float | None]:
    """Splits the error of radiance (n, 3) against the truth into parts: a dict of percents.

    error: Standard error that the bake reports for its radiance, (n,).
    path: Truth of the path tracer at the same points of the isosurface, which may be the truth.

    Squares of these parts add up:

    noise_percent: The reported error.
    texture_percent: The other difference of bake and path tracer: limited resolution, and bias of
        the estimator.
    mesh_percent: The difference of path tracer and truth, which sees a mesh instead of the
        isosurface. None if the path tracer is the truth.
    """
    weights = truth.weights
    noise = noise_percent(radiance, error[:, None], exposure, weights)
    path_noise = noise_percent(path.radiance, path.standard_error, exposure, weights)
    mesh = None
    if path is not truth:
        truth_noise = noise_percent(truth.radiance, truth.standard_error, exposure, weights)
        of_path = rms_percent(path.radiance, truth.radiance, exposure, weights)
        mesh = without(of_path, path_noise, truth_noise)
    of_bake = rms_percent(radiance, path.radiance, exposure, weights)
    return {
        "noise_percent": noise,
        "texture_percent": without(of_bake, path_noise, noise),
        "mesh_percent": mesh,
    }


def without(total: float, *parts: float) -> float:
    """Returns the root of whole^2 minus the squares of the parts, at least 0."""
    return float(np.sqrt(max(0.0, total**2 - sum(part**2 for part in parts))))


def errors_of(
    radiance: Array, truth: Truth, exposure: float, mask: Array | None = None
) -> dict[str, float | None]:
    """Returns errors of radiance (n, 3) against the truth at its points, or those of a mask (n,).

    The result is a dict of points and the six figures that compare() documents, None without
    points.
    """
    counted = truth.weights > 0
    mask = counted if mask is None else mask & counted
    if not mask.any():
        return {"points": 0, **dict.fromkeys(FIGURES)}
    compared, true = radiance[mask].astype(np.float64), truth.radiance[mask]
    weights = truth.weights[mask]
    mean = _mean(true, weights)
    ratio = _mean(compared, weights) / mean if mean > 0 else None
    return {
        "points": len(compared),
        "rms_percent": rms_percent(compared, true, exposure, weights),
        "relative_rms": rms(compared - true, weights) / mean if mean > 0 else None,
        "reference_noise_percent": noise_percent(
            true, truth.standard_error[mask], exposure, weights
        ),
        "mean_radiance": mean * exposure,
        "mean_ratio": ratio,
        "mean_ratio_error": None if ratio is None else ratio * truth.mean_error(mask) / mean,
    }


def _mean(values: Array, weights: Array) -> float:
    return float(np.average(values.mean(axis=1), weights=weights))
