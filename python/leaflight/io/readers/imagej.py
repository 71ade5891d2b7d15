# SPDX-License-Identifier: GPL-3.0-or-later
"""ImageJ's metadata in TIFF files: voxel sizes and calibrated values.

https://imagej.net/ij/developer/source/ij/io/FileSaver.java.html
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...arrays import Array
from .voxel_size import VoxelSize, voxel_size

# Codes of TIFF for units of resolution.
_UNITS = {2: "inch", 3: "cm"}
# Pixels per inch of screens and printers, which are not the scale of the picture.
_OF_SCREENS = 72.0
# Codes of calibrations that are supported: a + b x, and none.
_LINEAR, _NONE = 0, 20
# ImageJ stores signed 16-bit numbers as unsigned.
_SIGNED = (-32768.0, 1.0)


def size_of_voxel(metadata: dict[str, Any], tags: Any) -> VoxelSize | None:
    """Returns the voxel size, None if there is none.

    metadata: Metadata of the description. tags: Tags of the first page, as in tifffile.
    ImageJ leaves out sizes of 1, and units that equal that of x.
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
    """Returns the pixels per unit of length."""
    try:
        above, below = tags.valueof(name)
        number = float(above / below)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        return None
    return number if 0 < number < float("inf") else None


def calibration(
    metadata: dict[str, Any], dtype: np.dtype[Any]
) -> tuple[np.dtype[Any], Callable[[Array], Array], str] | None:
    """Returns the calibration a + b x of the numbers x of a file, None without one.

    The result is the type of the values, the function from numbers to values, and a note.
    """
    try:
        if int(metadata.get("cf", _NONE)) == _NONE:
            return None
        a, b = float(metadata["c0"]), float(metadata["c1"])
    except (KeyError, TypeError, ValueError, OverflowError):
        return None
    if metadata["cf"] != _LINEAR or not np.isfinite([a, b]).all() or b == 0:
        note = "The calibration of ImageJ is not linear, so the values are the stored numbers."
        return dtype, lambda numbers: numbers, note
    if (a, b) == (0.0, 1.0):
        return None
    note = f"The values are calibrated as in ImageJ: {a:g} + {b:g} x the stored number."
    if (a, b) == _SIGNED and dtype == np.uint16:
        return np.dtype(np.int16), lambda numbers: (numbers ^ 0x8000).view(np.int16), note
    return np.dtype(np.float32), lambda numbers: (a + b * numbers).astype(np.float32), note
