# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors in four bytes: three mantissas of nine bits with one exponent.

As graphics cards read them (GL_RGB9_E5; OpenGL 4.6, 8.25 "Shared Exponent Texture Color
Conversion"): half a percent exact, from 2^-24 to 65408.
"""

import numpy as np

_BITS, _BIAS, _LARGEST = 9, 15, 65408.0


def packed(colors):
    """uint32 (...) of colors (..., 3); what is below zero becomes zero."""
    colors = np.clip(np.asarray(colors, np.float32), 0.0, _LARGEST)
    largest = colors.max(axis=-1)
    _, power = np.frexp(largest)  # largest < 2^power
    power = np.where(largest > 0, power, -_BIAS - 1)
    exponent = np.clip(power + _BIAS, 0, 31)
    # Where the largest mantissa would be rounded up to ten bits.
    scale = np.ldexp(np.float32(1), _BIAS + _BITS - exponent)
    exponent = exponent + (np.floor(largest * scale + 0.5) >= 1 << _BITS)
    scale = np.ldexp(np.float32(1), _BIAS + _BITS - exponent)
    mantissas = np.floor(colors * scale[..., None] + 0.5).astype(np.uint32)
    word = exponent.astype(np.uint32) << 27
    for channel in range(3):
        word |= mantissas[..., channel] << np.uint32(9 * channel)
    return word
