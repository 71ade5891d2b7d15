# SPDX-License-Identifier: GPL-3.0-or-later
"""The segments of a DICOM segmentation: their names and colors, by number."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pydicom

from ....srgb import srgb_from_linear
from ....volume.label_table import Label

# White of CIE's illuminant D65 as DCMTK and dcmjs have it, with which programs write colors.
_WHITE = np.array([0.950456, 1.0, 1.088754])
# Matrix from XYZ to linear sRGB (IEC 61966-2-1).
_RGB_FROM_XYZ = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)
# Largest stored number. It stands for 100 of L* and for 127 of a* and b*.
_MOST = 65535.0


def segments_of(header: pydicom.Dataset) -> dict[int, Label]:
    """Returns the segments of a file by their numbers. Their names are unique."""
    segments: dict[int, Label] = {}
    names = set()
    for item in header.get("SegmentSequence", None) or []:
        number = int(item.SegmentNumber)
        name = str(item.get("SegmentLabel", None) or "").strip() or f"segment {number}"
        name = f"{name} ({number})" if name in names else name
        names.add(name)
        color = _srgb(item.get("RecommendedDisplayCIELabValue", None))
        segments[number] = Label.of(number, name, color)
    return segments


def _srgb(stored: Any) -> list[float] | None:
    """Returns the sRGB of the three stored numbers of a CIELAB color, or None."""
    if not isinstance(stored, Sequence) or len(stored) != 3:
        return None
    lightness, a, b = (float(part) / _MOST for part in stored)
    y = (100.0 * lightness + 16.0) / 116.0
    roots = np.array([y + (255.0 * a - 128.0) / 500.0, y, y - (255.0 * b - 128.0) / 200.0])
    # The inverse of CIE's cube root, which is linear below 6/29.
    xyz = _WHITE * np.where(roots > 6 / 29, roots**3, 3 * (6 / 29) ** 2 * (roots - 4 / 29))
    encoded: list[float] = srgb_from_linear(np.clip(_RGB_FROM_XYZ @ xyz, 0.0, 1.0)).tolist()
    return encoded
