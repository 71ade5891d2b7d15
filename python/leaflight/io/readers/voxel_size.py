# SPDX-License-Identifier: GPL-3.0-or-later
"""Sizes of voxels as the metadata of pictures give them: an own unit for each axis."""

import re
import unicodedata
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import SupportsFloat

from ...volume.units import METERS, meters_of, unit_of

# Encodings that UTF-8 is often mistaken for.
_MISREAD_AS = ("latin-1", "cp1252", "mac_roman")


@dataclass(frozen=True)
class VoxelSize:
    """Sizes (x, y, z), and the key of their unit in METERS, "" where that is not known.

    note: a sentence about a size that was assumed, else empty.
    """

    sizes: tuple[float, float, float]
    unit: str = ""
    note: str = ""


def voxel_size(
    sizes: Sequence[object], words: Sequence[object], unit: str | None = None
) -> VoxelSize | None:
    """Returns the size of a voxel by numbers (x, y, z) of a file and its words for their units.

    None where neither x nor y has one. unit: a key of METERS to convert to, None is that of x.
    """
    x, y, z = (_positive(size) for size in sizes)
    if x is None and y is None:
        return None
    known = [_length(word) for word in words]
    first = known[0]
    if first is None:
        # Pixels, or a word that says nothing: the numbers still give the proportions.
        scales, unit = [1.0, 1.0, 1.0], ""
    else:
        unit = unit or first[1]
        scales = [
            scale * METERS[own] / METERS[unit] for scale, own in (one or first for one in known)
        ]
    x, y = x or y, y or x
    assert x is not None and y is not None
    note = ""
    if z is None:
        z = 1.0 / scales[2]
        note = (
            f"The file does not say how far apart its planes are; 1 {unit or 'pixel'} is assumed."
        )
    x, y, z = (size * scale for size, scale in zip((x, y, z), scales))
    return VoxelSize((x, y, z), unit, note)


def _positive(size: object) -> float | None:
    try:
        if isinstance(size, str):
            # Programs of some countries write a comma.
            size = size.replace(",", ".")
        number = abs(float(size)) if isinstance(size, (str, SupportsFloat)) else 0.0
    except (ValueError, OverflowError):
        return None
    return number if 0 < number < float("inf") else None


def _length(word: object) -> tuple[float, str] | None:
    """Returns (factor, key of METERS) of a file's word for a unit, None where it is no length.

    Inches become millimeters.
    """
    text = str(word or "").strip("\x00 ")
    # ImageJ escapes letters as Java does. A letter that was lost can only be that of micrometers.
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
