# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of colours, as the thesis measures them.

A colour is radiance times exposure, clamped to 0..1. Radiance arrays are (..., 3); weights, by
which means are taken, have their shape without the last axis, None weighs all alike.
"""

from collections.abc import Sequence

import leaflight._core as _core
import numpy as np

from ..arrays import Array

# Standard errors to each side of an interval of 95 %.
REACH = 1.96


def rms_percent(
    radiance: Array, reference: Array, exposure: float, weights: Array | None = None
) -> float:
    """RMS error of colours in percent (thesis Eq. 4.11, corrected)."""
    colours, truth = (
        np.clip(np.asarray(x, np.float64) * exposure, 0, 1) for x in (radiance, reference)
    )
    return 100.0 * rms(colours - truth, weights)


def noise_percent(
    radiance: Array, standard_error: Array, exposure: float, weights: Array | None = None
) -> float:
    """What the standard errors of a radiance add to rms_percent: squares add up.

    They have the shape of the radiance, or one channel for all of its.
    """
    return 100.0 * rms(_color_noise(radiance, standard_error, exposure), weights)


def _color_noise(radiance: Array, error: Array, exposure: float) -> Array:
    """Half the width of radiance +- error, clamped: what lies beyond white does not count."""
    radiance, error = (exposure * np.asarray(x, np.float64) for x in (radiance, error))
    noise: Array = 0.5 * (np.clip(radiance + error, 0, 1) - np.clip(radiance - error, 0, 1))
    return noise


def estimated_rms_percent(grids: Sequence[_core.RadianceGrid], exposure: float) -> float:
    """RMS over the texels of radiance grids of the error that they report, in percent of a colour.

    Slices one by one, which bounds the memory. 0 where there is no texel.
    """
    squares, texels = 0.0, 0
    for grid in grids:
        slices = zip(grid.mask(), grid.dense("radiance"), grid.dense("radiance_error"))
        for mask, radiance, error in slices:
            active = mask.astype(bool)
            noise = _color_noise(radiance[active], error[active][..., None], exposure)
            squares += float(np.square(noise).mean(axis=-1).sum())
            texels += int(active.sum())
    return 100.0 * float(np.sqrt(squares / max(texels, 1)))


def rms(values: Array, weights: Array | None = None) -> float:
    """Root of the weighted mean of squares over all channels."""
    squares = np.square(np.asarray(values, np.float64)).mean(axis=-1)
    return float(np.sqrt(np.average(squares, weights=weights)))
