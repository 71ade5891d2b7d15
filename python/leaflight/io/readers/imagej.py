# SPDX-License-Identifier: GPL-3.0-or-later
"""ImageJ's metadata in TIFF files: voxel sizes, channels and calibrated values.

https://imagej.net/ij/developer/source/ij/io/FileSaver.java.html
"""

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from ...arrays import Array
from .channels import Channel, channel_of
from .voxel_size import VoxelSize, voxel_size

# Codes of TIFF for units of resolution.
_UNITS = {2: "inch", 3: "cm"}
# Pixels per inch of screens and printers, which are not the scale of the picture.
_OF_SCREENS = 72.0
# Coordinates of a slice in its label, such as "c:1/3 z:2/9 - ".
_COORDINATES = re.compile("[czt]:[0-9]+/[0-9]+")
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


def channel_list(metadata: dict[str, Any]) -> tuple[Channel, ...]:
    """Returns the names and colors of the channels; none if there are neither.

    A channel has the color of its largest value in its lookup table. Its name is the label that its
    slices share, without their coordinates.
    """
    count, tables = int(metadata.get("channels", 1)), list(metadata.get("LUTs") or ())
    labels = [_COORDINATES.sub("", str(one)).strip(" -") for one in metadata.get("Labels") or ()]
    if count > max(len(labels), len(tables)):
        return ()
    # Channels are the fastest axis of slices.
    shared = [set(labels[k::count]) for k in range(count)]
    names = [one.pop() if len(one) == 1 else "" for one in shared]
    names = names if len(set(names)) > 1 else [""] * count
    colors = [np.asarray(table)[:, -1] / 255 for table in tables if np.ndim(table) == 2]
    colors = colors if len(colors) == count else [np.zeros(3)] * count
    found = tuple(channel_of(name, color) for name, color in zip(names, colors))
    return found if any(one.name or one.color for one in found) else ()


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
