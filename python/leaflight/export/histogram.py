# SPDX-License-Identifier: GPL-3.0-or-later
"""The histogram of values, in bins that suit the data."""

from typing import Any

import numpy as np

from ..arrays import Array
from ..bake.baked import Bake

MOST_BINS, LEAST_BINS = 256, 16
_SAMPLES = 200_000
# Values that differ by less than this share of their span are equal after rounding.
_ROUNDING = 1e-5


def histogram(bake: Bake) -> dict[str, Any]:
    """Returns the histogram of the first volume, from the lower end of the isovalue range.

    The result is {"counts": of bins, "width": of a bin as a share of the range}. The last bin may
    end beyond the range.
    """
    low, high = (bake.isovalue_of(0, c) for c in bake.isovalues)
    values = bake.volume.data()
    values = values[np.isfinite(values)]
    width = bin_width(values, low, high)
    count = max(1, int(np.ceil((high - low) / width * (1.0 - 1e-9))))
    edges = low + width * np.arange(count + 1)
    counts, _ = np.histogram(values, edges)
    return {"counts": counts.tolist(), "width": width / (high - low)}


def bin_width(values: Array, low: float, high: float) -> float:
    """Returns the bin width over the isovalue range, low..high, for values (n,) without NaN.

    For values with regular steps, of any type, it is a multiple of the step. Other bins would hold
    varying numbers of steps. Otherwise it is the width of Freedman and Diaconis (1981).
    """
    sample = values[:: max(1, len(values) // _SAMPLES)].astype(np.float64)
    sample = np.sort(sample[(sample >= low) & (sample <= high)])
    least = (high - low) / MOST_BINS
    gaps = np.diff(sample)
    gaps = gaps[gaps > _ROUNDING * (high - low)]
    if len(gaps) == 0:
        return least
    step = float(gaps.min())
    if step > 0.02 * least and np.allclose(gaps, step * np.rint(gaps / step), atol=0.05 * step):
        step = float(gaps[gaps < 1.5 * step].mean())
        return step * max(1.0, float(np.ceil((1.0 - 1e-4) * least / step)))
    quarter, three = np.quantile(sample, (0.25, 0.75))
    width = 2.0 * (three - quarter) / len(sample) ** (1.0 / 3.0)
    return float(np.clip(width, least, (high - low) / LEAST_BINS))
