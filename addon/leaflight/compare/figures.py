# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a baked still is from the path-traced one, in numbers and in a sentence."""

import numpy as np
from leaflight.bake import color_error

# Percent. The bakes of the tests, with 32 texels a side, are off by up to 1.4.
MEAN_OF_A_GOOD_BAKE = 2.0


def rms_percent(image, reference, exposure, mask):
    """Thesis Eq. 4.11, corrected, over the pixels of the mask; NaN where there are none."""
    if not mask.any():
        return float("nan")
    return color_error.rms_percent(image[mask], reference[mask], exposure)


def mean_off(baked_halves, cycles_halves, mask):
    """By how many percent the mean of the baked still differs from that of Cycles.

    With half of its interval of 95 %, from the difference of each still's halves, pixel by
    pixel; NaN where the mask holds no pixels, or all is dark.
    """
    off = within = float("nan")
    if mask.any():
        (baked, baked_error), (cycles, cycles_error) = (
            _mean(halves, mask) for halves in (baked_halves, cycles_halves)
        )
        if cycles > 0:
            off = baked / cycles - 1
            within = color_error.REACH * np.hypot(baked_error, cycles_error * (1 + off)) / cycles
    return {
        "isosurface_mean_off_percent": 100 * float(off),
        "isosurface_mean_off_within": 100 * float(within),
    }


def _mean(halves, mask):
    """(mean over the mask, its standard error) of a still of two halves of samples."""
    a, b = (half[mask].mean(axis=1, dtype=np.float64) for half in halves)
    return 0.5 * (a.mean() + b.mean()), 0.5 * np.sqrt(np.sum((a - b) ** 2)) / len(a)


def summary(result):
    off, within = result["isosurface_mean_off_percent"], result["isosurface_mean_off_within"]
    return (
        f"Isovalue {result['isovalue']:g}: RMS {result['isosurface_rms_percent']:.2f} % on the "
        f"isosurface, of which noise {result['isosurface_noise_percent']:.2f} %; mean off by "
        f"{off:+.2f} +- {within:.2f} %"
        + (", more than noise explains" if abs(off) > within else "")
        + f"; {flip_words(result)}"
    )


def flip_words(result):
    mean = result["flip_mean"]
    return "no FLIP: flip-evaluator is missing" if mean is None else f"FLIP {mean:.3f}"


def doubt(result):
    """A sentence when the mean is off by more than noise and texels explain, or an empty text."""
    off, within = result["isosurface_mean_off_percent"], result["isosurface_mean_off_within"]
    if not abs(off) - within > MEAN_OF_A_GOOD_BAKE:
        return ""
    return (
        f"The mean is off by {off:+.1f} %, of which noise explains {within:.1f} % and the texels "
        f"of a good bake {MEAN_OF_A_GOOD_BAKE:g} %: Cycles renders something brighter or darker "
        "than it was baked; see what differs, bake again, or bake with more texels and samples"
    )
