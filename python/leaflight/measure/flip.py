# SPDX-License-Identifier: GPL-3.0-or-later
"""FLIP: the visible difference of two pictures that a viewer alternates (Andersson et al. 2020)."""

from dataclasses import dataclass

import numpy as np

from .._core import LeaflightError
from ..arrays import Array


@dataclass(frozen=True, eq=False)
class Flip:
    """The difference of two pictures.

    map: Visible difference of each pixel, 0 to 1, (height, width). mean and percentile_95 are its
        mean and its 95th percentile.
    """

    map: Array

    @property
    def mean(self) -> float:
        return float(self.map.mean())

    @property
    def percentile_95(self) -> float:
        return float(np.percentile(self.map, 95))


def flip(image: Array, reference: Array, exposure: float = 1.0) -> Flip:
    """Returns the Flip of two pictures of linear radiance (height, width, 3).

    Colors are exposed and clamped to 0..1. The viewer sees 67 pixels per degree, the default: a
    screen 0.7 m wide with 3840 pixels, 0.7 m away. Raises LeaflightError if flip-evaluator is not
    installed.
    """
    try:
        import flip_evaluator
    except ImportError:
        raise LeaflightError(
            "FLIP needs the Python package flip-evaluator, which is not installed: "
            "run 'pip install flip-evaluator'."
        ) from None
    shown = [
        np.ascontiguousarray(np.clip(np.float32(exposure) * x, 0, 1), np.float32)
        for x in (reference, image)
    ]
    found, _, _ = flip_evaluator.evaluate(
        *shown, "LDR", inputsRGB=False, applyMagma=False, computeMeanError=False
    )
    return Flip(np.asarray(found, np.float32).reshape(image.shape[:2]))
