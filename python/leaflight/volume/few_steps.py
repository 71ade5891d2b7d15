# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds values that are too close to each other, relative to their distance from 0, for float32."""

import math
from typing import Any

import numpy as np

from .fill_values import Number

# Limits on the steps of single precision between the lowest and the highest value. Below the first,
# terraces are visible if the data are more exact. Below the second, the light is wrong.
_ENOUGH, _AT_LEAST = 4096, 32


def common_offset(low: Number, high: Number, dtype: np.dtype[Any]) -> Number:
    """Returns a round number to subtract from all stored values; 0 if they need none.

    low, high: The lowest and the highest value. dtype: A type that holds them exactly.
    """
    most = max(abs(low), abs(high))
    if not 0 < high - low < most <= float(np.finfo(np.float32).max):
        return 0
    steps = float(high - low) / float(np.spacing(np.float32(most)))
    are_exact = np.can_cast(dtype, np.float32) or (dtype.kind in "iu" and most <= 1 << 24)
    if steps >= (_AT_LEAST if are_exact else _ENOUGH):
        return 0
    digits = math.ceil(math.log10(high - low) - 1e-6)
    if isinstance(low, int):
        unit = int(10**digits)
        return low // unit * unit
    # Round to a multiple of the unit if the value is nearly one.
    return round(math.floor(low / 10.0**digits + 1e-6) * 10.0**digits, -digits)
