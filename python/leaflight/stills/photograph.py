# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures for the screen: exposed, highlights compressed, encoded as sRGB."""

import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..bake.baked import Bake
from ..io.images import display_colors
from .first_view import default_isovalue_of
from .still import still

# Khronos PBR Neutral (2024) without its offset for specular reflection. Colors up to START are
# unchanged. Brighter colors approach white and are desaturated gradually.
START = 0.8
DESATURATION = 0.15
# The scene's exposure is kept if the 99th percentile of brightness is within these limits.
DIMMEST, BRIGHTEST = 0.4, 1.25
MOST_STOPS = 4.0


def tone_mapped(linear: ArrayLike) -> Array:
    """Returns the displayed values of exposed colors (..., 3), linear and below 1."""
    linear = np.asarray(linear, np.float32)
    peak = linear.max(axis=-1, keepdims=True)
    rest = 1.0 - START
    shown = 1.0 - rest * rest / np.maximum(peak + rest - START, rest)
    white = 1.0 - 1.0 / (DESATURATION * np.maximum(peak - shown, 0.0) + 1.0)
    mapped = linear * (shown / np.maximum(peak, START)) * (1.0 - white) + shown * white
    return np.where(peak <= START, linear, mapped)


def photographed(picture: Array, exposure: float) -> Array:
    """Returns the picture of still() as uint8 RGBA with straight alpha."""
    alpha = picture[..., 3:]
    radiance = picture[..., :3] / np.maximum(alpha, 1e-6)
    colors = display_colors(tone_mapped(radiance * np.float32(exposure)), 1.0)
    return np.concatenate([colors, np.rint(255.0 * alpha).astype(np.uint8)], axis=-1)


def metered_stops(bake: Bake, isovalue: float | None = None) -> float:
    """Returns the stops by which a Bake is shown brighter than the scene's exposure, to a tenth.

    It is zero if the first view is neither dark nor overexposed. isovalue: None is the default one.
    """
    isovalue = default_isovalue_of(bake) if isovalue is None else isovalue
    picture = still(bake, isovalue, size=(128, 72), samples=1)
    seen = picture[picture[..., 3] > 0.0][:, :3].max(axis=1) * bake.scene.exposure
    peak = float(np.quantile(seen, 0.99)) if len(seen) else 0.0
    if not peak > 0.0:
        return 0.0
    stops = math.log2(min(max(peak, DIMMEST), BRIGHTEST) / peak)
    return round(min(max(stops, -MOST_STOPS), MOST_STOPS), 1)
