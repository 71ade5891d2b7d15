# SPDX-License-Identifier: GPL-3.0-or-later
"""The histogram of a volume and its middle slice, computed once for each volume.

This takes a fraction of a second, so a timer does it and never the drawing of a panel.
"""

import os
from dataclasses import dataclass

import bpy
import numpy as np
from leaflight import LeaflightError

from .. import session
from ..operators import jobs
from ..store import cache, source_files
from ..store.reading import StillReading

BINS = 256
# Approximate number of voxels, evenly spread, that are counted in a larger volume.
COUNTED = 1 << 22
# Pixels along the longer side of a slice.
SLICE = 160
# Largest difference between bytes that shows as a terrace, and the smallest share of an isosurface
# with such differences.
_STEPS, _TERRACED = 3, 0.25


@dataclass(frozen=True)
class Distribution:
    """The histogram and the middle slice of a volume.

    counts: Numbers of voxels in equal parts of low..high, at most BINS of them, (n,).
    middle: The slice in data units, (rows, columns), top row first, with square pixels.
    is_terraced: True if an isosurface shows the steps of 8-bit values.
    are_labels: True if the values look like those of a mask or a label map.
    """

    low: float
    high: float
    counts: np.ndarray
    middle: np.ndarray
    is_terraced: bool = False
    are_labels: bool = False

    def place_of(self, isovalue):
        """Returns the position of a value in the range, from 0 to 1."""
        return (isovalue - self.low) / (self.high - self.low)


# Cache: key of a volume -> its Distribution, or None while it is computed or if that failed.
_known = session.cache()


def of(obj):
    """Returns the Distribution of an object's volume, None until a timer has computed it."""
    key = _key(obj)
    if key not in _known:
        _known[key] = None
        name = obj.name_full
        bpy.app.timers.register(lambda: _look(name, key), first_interval=0.01)
    return _known[key]


def look_now(obj):
    """Computes the Distribution at once and returns it. Raises LeaflightError."""
    key = _key(obj)
    if _known.get(key) is None:
        _known[key] = _distribution(cache.volume_of(obj), obj.leaflight.isovalue)
    return _known[key]


def _key(obj):
    """Returns a key of an object's volume. It is cheap, because each draw of a panel needs it."""
    settings = obj.leaflight
    path, choices = source_files.path_of(settings), source_files.choices_of(settings)
    try:
        written = os.stat(path).st_mtime_ns
    except OSError:
        written = 0
    return (path, written, *choices.values(), settings.bake_id, settings.bake_index)


def _look(name, key):
    obj = next((obj for obj in bpy.data.objects if obj.name_full == name), None)
    if obj is None or key not in _known:
        return
    try:
        _known[key] = _distribution(cache.volume_of(obj), obj.leaflight.isovalue)
    except StillReading:
        # The panels are drawn again once it is read.
        del _known[key]
        return
    except LeaflightError:
        # The panel of the volume shows the error.
        return
    jobs.redraw_panels()


def _distribution(volume, isovalue):
    low, high = volume.data_range()
    values = volume.data()
    some = values.reshape(-1)[:: max(1, values.size // COUNTED)]
    bins = BINS
    if values.dtype.kind in "iu":
        # Give each bin the same number of integers.
        width = -(-int(high - low + 1) // BINS)
        bins = -(-int(high - low + 1) // width)
        low, high = low - 0.5, low - 0.5 + bins * width
    counts, _ = np.histogram(some[np.isfinite(some)], bins, (low, high))
    middle = _middle(values, volume.index_to_world)
    is_terraced, are_labels = _is_terraced(values, isovalue), volume.distribution.are_labels
    return Distribution(low, high, counts, middle, is_terraced, are_labels)


def _is_terraced(values, isovalue):
    """True if many neighbors across an isosurface of bytes differ by at most _STEPS."""
    if values.dtype != np.uint8:
        return False
    some = values[:: max(1, len(values) // 16)].astype(np.int16)
    left, right = some[..., :-1], some[..., 1:]
    steps = np.abs(right - left)[(left >= isovalue) != (right >= isovalue)]
    return len(steps) > 0 and np.mean(steps <= _STEPS) > _TERRACED


def _middle(values, index_to_world):
    """Returns the middle slice along z, sampled at the nearest voxels."""
    plane = values[len(values) // 2]
    sizes = np.linalg.norm(index_to_world[:3, :2], axis=0)
    sides = np.array(plane.shape) * sizes[::-1]
    rows, columns = np.maximum(1, np.rint(SLICE * sides / sides.max()).astype(int))
    # The volume's y runs up and rows run down, unless an axis is mirrored.
    up, right = index_to_world[1, 1] >= 0, index_to_world[0, 0] >= 0
    row = np.linspace(0, plane.shape[0] - 1, rows).round().astype(int)[:: -1 if up else 1]
    column = np.linspace(0, plane.shape[1] - 1, columns).round().astype(int)[:: 1 if right else -1]
    return plane[np.ix_(row, column)].astype(np.float32)
