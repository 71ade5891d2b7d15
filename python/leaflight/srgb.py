# SPDX-License-Identifier: GPL-3.0-or-later
"""The curve of sRGB (IEC 61966-2-1)."""

import numpy as np

from .arrays import Array


def linear_from_srgb(encoded: Array) -> Array:
    """Returns linear values of sRGB values in 0..1."""
    curve = ((encoded + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, encoded / 12.92, curve)


def srgb_from_linear(linear: Array) -> Array:
    """Returns sRGB values of linear values in 0..1."""
    curve = 1.055 * np.power(linear, 1.0 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, 12.92 * linear, curve)
