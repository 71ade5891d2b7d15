# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of a volume's data in the sidebar: a slice above the histogram.

It is painted again only after a visible change of the volume, its range or the isovalue.
"""

import numpy as np

from .. import icons, session
from ..show import distribution

# Side of the square picture and height of the histogram, in pixels.
SIDE, HISTOGRAM = 256, 84
BACKGROUND = (0.11, 0.11, 0.11)
OUTSIDE, INSIDE = (0.32, 0.32, 0.32), (0.75, 0.75, 0.75)
ISOVALUE = (1.0, 0.55, 0.1)
# Share of the isovalue's color in pixels at or above the isovalue.
TINT = 0.45

_last = session.cache()


def icon_of(obj):
    """Returns the icon of an object's picture, 0 until its Distribution is known."""
    found = distribution.of(obj)
    if found is None:
        return 0
    marks = [_column(found, value) for value in _values(obj)]
    key = (id(found), *marks)
    if _last.get("key") != key:
        _last.update(key=key, found=found)
        _put(paint(found, *_values(obj)))
    return icons.pictures()["data"].icon_id


def paint(found, low, high, isovalue):
    """Returns the picture of a Distribution, float32 (SIDE, SIDE, 4), bottom row first."""
    pixels = np.empty((SIDE, SIDE, 4), np.float32)
    pixels[..., :3], pixels[..., 3] = BACKGROUND, 1.0
    _paint_slice(pixels[: SIDE - HISTOGRAM - 4], found, low, high, isovalue)
    _paint_histogram(pixels[SIDE - HISTOGRAM :], found, low, high, isovalue)
    return pixels[::-1]


def bars(counts):
    """Returns the bars of a histogram, 0 to 1, on a log scale that shows small counts."""
    heights = np.log1p(counts.astype(np.float64))
    return heights / max(heights.max(), 1e-9)


def _paint_slice(pixels, found, low, high, isovalue):
    """Paints the slice from black at `low` to white at `high`, and tints the inside."""
    rows, columns = found.middle.shape
    first = (pixels.shape[0] - rows) // 2, (SIDE - columns) // 2
    part = pixels[first[0] : first[0] + rows, first[1] : first[1] + columns]
    middle = np.nan_to_num(found.middle, nan=found.low)
    gray = np.clip((middle - low) / max(high - low, 1e-30), 0, 1)
    part[..., :3] = gray[..., None]
    inside = found.middle >= isovalue
    part[inside, :3] += TINT * (np.array(ISOVALUE) - part[inside, :3])


def _paint_histogram(pixels, found, low, high, isovalue):
    heights = np.rint((HISTOGRAM - 2) * bars(found.counts)).astype(int)
    rows = np.arange(HISTOGRAM)[::-1, None]
    columns = np.arange(SIDE)
    filled = rows < heights[columns * len(heights) // SIDE]
    first, last, mark = (_column(found, value) for value in (low, high, isovalue))
    in_range = (columns >= first) & (columns <= last)
    pixels[:, in_range, :3] += 0.08
    for chosen, color in ((in_range, INSIDE), (~in_range, OUTSIDE)):
        pixels[filled & chosen, :3] = color
    pixels[:, max(0, mark - 1) : mark + 1, :3] = ISOVALUE


def _values(obj):
    settings = obj.leaflight
    return settings.low, settings.high, settings.isovalue


def _column(found, value):
    return int(np.clip(found.place_of(value) * (SIDE - 1), 0, SIDE - 1))


def _put(pixels):
    # Make a new picture, because Blender may cache the drawing of the old one.
    if "data" in icons.pictures():
        del icons.pictures()["data"]
    picture = icons.pictures().new("data")
    picture.image_size = picture.icon_size = (SIDE, SIDE)
    flat = np.ascontiguousarray(pixels).ravel()
    picture.image_pixels_float.foreach_set(flat)
    picture.icon_pixels_float.foreach_set(flat)


def unregister():
    _last.clear()
