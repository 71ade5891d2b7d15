# SPDX-License-Identifier: GPL-3.0-or-later
"""The values of a volume, plane by plane."""

from functools import lru_cache
from typing import Any

import numpy as np

from ...._core import Progress
from ....arrays import Array
from ....volume.voxels import new_voxels
from ..packing import scaled_type
from ..watched import watched
from .pixels import open_pages, values_of
from .planes import Plane

# Files that are open at once: times of a series may each be one, of which all have some planes.
_OPEN = 4


def value_type(planes: list[Plane]) -> np.dtype[Any]:
    """The type of the values: the narrowest that holds what slices usually hold."""
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
    # Hounsfield units do, though 16 bits may be declared for them before 1024 is taken away.
    return np.dtype(next(fits, np.int16))


def values_of_frame(
    planes: list[Plane | None], shape: tuple[int, int], dtype: np.dtype[Any], progress: Progress
) -> Array:
    """The values of planes of this shape, 0 where one is not stored. Raises LeaflightError.

    They are of this type, or of one that holds more where they exceed it.
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


def _fits(page: Array, dtype: np.dtype[Any]) -> bool:
    limits = np.iinfo(dtype)
    return bool(limits.min <= page.min() and page.max() <= limits.max)


def _widened(values: Array, count: int, page: Array) -> Array:
    """An array that holds another page as well, with the first `count` planes of values."""
    # 24 bits are exact in single precision.
    whole = np.int32 if _fits(page, np.dtype(np.int32)) else np.float64
    kind = np.float32 if np.abs(page.astype(np.float64)).max() < 1 << 24 else whole
    wide = new_voxels(values.shape, kind)
    wide[:count] = values[:count]
    return wide
