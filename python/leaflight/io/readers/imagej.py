# SPDX-License-Identifier: GPL-3.0-or-later
"""What ImageJ writes beside the pixels of a TIFF file: sizes of voxels, and calibrated values.

https://imagej.net/ij/developer/source/ij/io/FileSaver.java.html
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...arrays import Array
from .voxel_size import VoxelSize, voxel_size

# TIFF's codes of a unit of resolution.
_UNITS = {2: "inch", 3: "cm"}
# Pixels an inch that say nothing of what is in the picture.
_OF_SCREENS = 72.0
# Codes of calibrations: a + b x, the only one that keeps proportions of distances, and none.
_LINEAR, _NONE = 0, 20
# ImageJ keeps signed numbers of 16 bits as unsigned ones.
_SIGNED = (-32768.0, 1.0)


def size_of_voxel(metadata: dict[str, Any], tags: Any) -> VoxelSize | None:
    """Returns the size of a voxel, None where there is none.

    metadata: of the description; tags: of the first page, as tifffile has them.
    ImageJ leaves out what is 1, and a unit that an axis shares with x.
    """
    unit = metadata.get("unit")
    if unit is None:
        unit = _UNITS.get(tags.valueof("ResolutionUnit"))
        if unit == "inch" and _pixels(tags, "XResolution") == _OF_SCREENS:
            return voxel_size((1.0, 1.0, metadata.get("spacing", 1.0)), ("", "", ""))
    across = [1 / (_pixels(tags, name) or 1.0) for name in ("XResolution", "YResolution")]
    words = (unit, metadata.get("yunit", unit), metadata.get("zunit", unit))
    return voxel_size((*across, metadata.get("spacing", 1.0) or 1.0), words)


def _pixels(tags: Any, name: str) -> float | None:
    """Returns how many pixels a unit of length has."""
    try:
        above, below = tags.valueof(name)
        number = float(above / below)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        return None
    return number if 0 < number < float("inf") else None


def calibration(
    metadata: dict[str, Any], dtype: np.dtype[Any]
) -> tuple[np.dtype[Any], Callable[[Array], Array], str] | None:
    """Returns the calibration of values a + b x for the numbers x of a file, None without one.

    It is the type of the values, the function that makes them of numbers, and a note.
    """
    try:
        if int(metadata.get("cf", _NONE)) == _NONE:
            return None
        a, b = float(metadata["c0"]), float(metadata["c1"])
    except (KeyError, TypeError, ValueError, OverflowError):
        return None
    if metadata["cf"] != _LINEAR or not np.isfinite([a, b]).all() or b == 0:
        note = "The calibration of ImageJ is not linear; the values are the numbers in the file."
        return dtype, lambda numbers: numbers, note
    if (a, b) == (0.0, 1.0):
        return None
    note = f"The values are calibrated as in ImageJ: {a:g} + {b:g} x the number in the file."
    if (a, b) == _SIGNED and dtype == np.uint16:
        return np.dtype(np.int16), lambda numbers: (numbers ^ 0x8000).view(np.int16), note
    return np.dtype(np.float32), lambda numbers: (a + b * numbers).astype(np.float32), note
