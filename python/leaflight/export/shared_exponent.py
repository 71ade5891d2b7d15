# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs colors into four bytes: three mantissas of nine bits and one exponent.

Graphics cards read this format, GL_RGB9_E5 (OpenGL 4.6, 8.25 "Shared Exponent Texture Color
Conversion"). Its precision is half a percent, up to 65408.
"""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array

_BITS, _BIAS, _LARGEST = 9, 15, 65408.0
# Quantum of the least mantissas: a third of the darkest gray of an 8-bit screen. Less is noise,
# which does not deflate.
LEAST = 2.0**-13


def packed(colors: ArrayLike) -> Array:
    """Returns uint32 (...) of colors (..., 3); negative values become zero."""
    colors = np.clip(np.asarray(colors, np.float32), 0.0, _LARGEST)
    largest = colors.max(axis=-1)
    _, power = np.frexp(largest)  # largest < 2^power
    exponent = np.clip(power + _BIAS, int(np.log2(LEAST)) + _BIAS + _BITS, 31)
    # Increase the exponent if the largest mantissa would be rounded up to ten bits.
    scale = np.ldexp(np.float32(1), _BIAS + _BITS - exponent)
    exponent = exponent + (np.floor(largest * scale + 0.5) >= 1 << _BITS)
    scale = np.ldexp(np.float32(1), _BIAS + _BITS - exponent)
    mantissas = np.floor(colors * scale[..., None] + 0.5).astype(np.uint32)
    word = exponent.astype(np.uint32) << 27
    for channel in range(3):
        word |= mantissas[..., channel] << np.uint32(9 * channel)
    words: Array = np.where(mantissas.any(axis=-1), word, np.uint32(0))
    return words


def planes(words: Array) -> Array:
    """Returns the same as bytes (4, n) that deflate well.

    The first three are the lower eight bits of the mantissas: green, red less green, blue less
        green. The fourth is the exponent and the highest bits of blue, green and red.
    """
    words = words.ravel()
    red, green, blue = (words >> np.uint32(9 * channel) for channel in range(3))
    high = words >> np.uint32(24) & np.uint32(0xF8)
    for channel, mantissa in enumerate((red, green, blue)):
        high |= (mantissa >> np.uint32(8) & np.uint32(1)) << np.uint32(channel)
    found: Array = np.stack([green, red - green, blue - green, high]).astype(np.uint8)
    return found
