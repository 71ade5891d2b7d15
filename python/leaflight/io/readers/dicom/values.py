# SPDX-License-Identifier: GPL-3.0-or-later
"""The values of a volume, plane by plane."""

from functools import lru_cache
from typing import Any

import numpy as np

from ...._core import Progress
from ....arrays import Array
from ....volume.memory import new_voxels
from ..packing import scaled_type
from ..watched import watched
from .pixels import open_pages, values_of
from .planes import Plane

# Number of files that are open at once. Each time of a series may be a file with several planes.
_OPEN = 4


def value_type(planes: list[Plane]) -> np.dtype[Any]:
    """Returns the type of the values: the narrowest that holds usual values of slices."""
    pixels = {one.pixels for one in planes}
    if any(one.floats and one.allocated == 64 for one in pixels):
        return np.dtype(np.float64)
    if any(one.floats for one in pixels):
        return np.dtype(np.float32)
    if any(one.slope != 1 or one.intercept != round(one.intercept) for one in planes):
        sixteen = np.dtype(np.int16)
        kinds = [scaled_type(sixteen, one.slope, one.intercept) for one in planes]
        return max(kinds, key=lambda kind: kind.itemsize)
    low = min(one.intercept - (one.pixels.signed << (one.pixels.stored - 1)) for one in planes)
    high = max(one.intercept + (1 << one.pixels.stored) - 1 for one in planes)
    fits = (kind for kind in (np.uint8, np.uint16) if low >= 0 and high <= np.iinfo(kind).max)
    # Hounsfield units fit 16 bits, even if the header declares 16 bits before it subtracts 1024.
    return np.dtype(next(fits, np.int16))


def values_of_frame(
    planes: list[Plane | None], shape: tuple[int, int], dtype: np.dtype[Any], progress: Progress
) -> Array:
    """Returns the values of planes of this shape, 0 for one that is not stored.

    They have this type, or a wider one if they exceed it. Raises LeaflightError.
    """
    values = new_voxels((len(planes), *shape), dtype)
    opened = lru_cache(maxsize=_OPEN)(open_pages)
    for k, one in enumerate(watched(progress, planes)):
        if one is None:
            values[k] = 0
            continue
        page = values_of(one, opened(one.pixels))
        if values.dtype.kind != "f" and not _fits(page, values.dtype):
            values = _widened(values, k, page)
        values[k] = page
    return values


def label_map(
    frames: list[list[Plane | None]], shape: tuple[int, int], progress: Progress
) -> Array:
    """Returns the label map of segments, a frame for each; higher numbers are on top.

    Raises LeaflightError.
    """
    most = max(one.segment for planes in frames for one in planes if one is not None)
    values = new_voxels((len(frames[0]), *shape), np.uint8 if most < 256 else np.uint16)
    opened = lru_cache(maxsize=_OPEN)(open_pages)
    for page, planes in zip(values, watched(progress, zip(*frames))):
        page[...] = 0
        for one in sorted(filter(None, planes), key=lambda one: one.segment):
            page[values_of(one, opened(one.pixels)) > 0] = one.segment
    return values


def _fits(page: Array, dtype: np.dtype[Any]) -> bool:
    limits = np.iinfo(dtype)
    return bool(limits.min <= page.min() and page.max() <= limits.max)


def _widened(values: Array, count: int, page: Array) -> Array:
    """Returns a wider array that can hold another page, with the first `count` planes copied."""
    # Single precision is exact up to 24 bits.
    exact = np.int32 if _fits(page, np.dtype(np.int32)) else np.float64
    kind = np.float32 if np.abs(page.astype(np.float64)).max() < 1 << 24 else exact
    wide = new_voxels(values.shape, kind)
    wide[:count] = values[:count]
    return wide
