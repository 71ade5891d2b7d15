# SPDX-License-Identifier: GPL-3.0-or-later
"""Voxel sizes in the metadata of pictures, with a unit for each axis."""

import re
import unicodedata
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import SupportsFloat

from ...volume.units import METERS, meters_of, unit_of

# Encodings that are often confused with UTF-8.
_MISREAD_AS = ("latin-1", "cp1252", "mac_roman")


@dataclass(frozen=True)
class VoxelSize:
    """Sizes (x, y, z), and the key of their unit in METERS, "" if unknown.

    note: A sentence about an assumed size, else "".
    """

    sizes: tuple[float, float, float]
    unit: str = ""
    note: str = ""


def voxel_size(
    sizes: Sequence[object], words: Sequence[object], unit: str | None = None
) -> VoxelSize | None:
    """Returns the voxel size from numbers (x, y, z) of a file and its words for their units.

    unit: Key of METERS to convert to. None is the unit of x.
    Returns None if neither x nor y has a size.
    """
    x, y, z = (_positive(size) for size in sizes)
    if x is None and y is None:
        return None
    known = [_length(word) for word in words]
    first = known[0]
    if first is None:
        # Pixels and unknown words: the numbers still give the proportions.
        scales, unit = [1.0, 1.0, 1.0], ""
    else:
        unit = unit or first[1]
        scales = [
            scale * METERS[key] / METERS[unit] for scale, key in (one or first for one in known)
        ]
    x, y = x or y, y or x
    assert x is not None and y is not None
    note = ""
    if z is None:
        z = 1.0 / scales[2]
        note = f"The file has no distance between planes; 1 {unit or 'pixel'} is assumed."
    x, y, z = (size * scale for size, scale in zip((x, y, z), scales))
    return VoxelSize((x, y, z), unit, note)


def _positive(size: object) -> float | None:
    try:
        if isinstance(size, str):
            # Programs in some languages write a decimal comma.
            size = size.replace(",", ".")
        number = abs(float(size)) if isinstance(size, (str, SupportsFloat)) else 0.0
    except (ValueError, OverflowError):
        return None
    return number if 0 < number < float("inf") else None


def _length(word: object) -> tuple[float, str] | None:
    """Returns (factor, key of METERS) of a word for a unit, None if it is no length.

    Inches become millimeters.
    """
    text = str(word or "").strip("\x00 ")
    # ImageJ escapes letters as in Java. A lost letter can only be the micro sign.
    text = re.sub(r"\\u([0-9a-fA-F]{4})", lambda found: chr(int(found[1], 16)), text)
    text = text.replace("\ufffdm", "µm")
    for encoding in _MISREAD_AS:
        with suppress(UnicodeError):
            text = text.encode(encoding).decode("utf-8")
    text = unicodedata.normalize("NFKC", text)
    unit, meters = unit_of(text), meters_of(text)
    if unit or meters is None:
        return (1.0, unit) if unit else None
    unit = next((key for key in ("mm", "µm") if METERS[key] <= meters), "nm")
    return meters / METERS[unit], unit
