# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of colors, as the thesis measures them.

A color is radiance times exposure, clamped to 0..1. Radiance arrays are (..., 3). Weights of means
have that shape without the last axis; None weighs all equally.
"""

from collections.abc import Sequence

import leaflight._core as _core
import numpy as np

from ..arrays import Array

# Half the width of a 95 % confidence interval, in standard errors.
REACH = 1.96
# The number of texels whose noise is averaged. All of a large bake take seconds.
_MOST_TEXELS = 1 << 18


def rms_percent(
    radiance: Array, reference: Array, exposure: float, weights: Array | None = None
) -> float:
    """Returns the RMS error of colors in percent (thesis Eq. 4.11, corrected)."""
    colors, truth = (
        np.clip(np.asarray(x, np.float64) * exposure, 0, 1) for x in (radiance, reference)
    )
    return 100.0 * rms(colors - truth, weights)


def noise_percent(
    radiance: Array, standard_error: Array, exposure: float, weights: Array | None = None
) -> float:
    """Returns the part of rms_percent caused by standard errors of a radiance; squares add up.

    Standard errors have the shape of the radiance, or one channel for all of its channels.
    """
    return 100.0 * rms(_color_noise(radiance, standard_error, exposure), weights)


def _color_noise(radiance: Array, error: Array, exposure: float) -> Array:
    """Returns half the width of radiance +- error, clamped: parts beyond white do not count."""
    radiance, error = (exposure * np.asarray(x, np.float64) for x in (radiance, error))
    noise: Array = 0.5 * (np.clip(radiance + error, 0, 1) - np.clip(radiance - error, 0, 1))
    return noise


def estimated_rms_percent(grids: Sequence[_core.RadianceGrid], exposure: float) -> float:
    """Returns the RMS over texels of the error that they report, in percent of a color.

    Reads at most _MOST_TEXELS of each grid. Returns 0 if there is no texel.
    """
    squares, texels = 0.0, 0
    for grid in grids:
        radiance, error = grid.some_texels(_MOST_TEXELS)
        noise = _color_noise(radiance, error[:, None], exposure)
        # They stand for all texels of their grid.
        squares += grid.texels * float(np.square(noise).mean()) if len(noise) else 0.0
        texels += grid.texels
    return 100.0 * float(np.sqrt(squares / max(texels, 1)))


def rms(values: Array, weights: Array | None = None) -> float:
    """Returns the root of the weighted mean of squares over all channels."""
    squares = np.square(np.asarray(values, np.float64)).mean(axis=-1)
    return float(np.sqrt(np.average(squares, weights=weights)))
