# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds fill values and offsets in the values of files."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arrays import Array

Number = int | float

# The ends of integer types. Saturated voxels have these values, too.
_ENDS = (
    *(-32768, -32767, 32767, 65535, 65504, -(2**31), 1 - 2**31, 2**31 - 1, 2**32 - 1),
    *(-(2**63), 1 - 2**63, 2**63 - 1, 2**64 - 1),
)
# Fill value of NetCDF; the largest numbers of float32 and float64, and rounded forms of them.
_FAR = (9.969209968386869e36, 3.4028234663852886e38, 3.4e38, 1.70141e38, 1.7976931348623157e308)
# Fill value of well logs.
_OTHERS = (-999.25,)
# Least number and share of voxels with the end of a type. Fewer are saturated or hot pixels.
_LEAST, _LEAST_SHARE = 16, 1e-3


def _text(value: Number) -> str:
    """Returns the first seven digits, the precision of float32."""
    return f"{value:.6e}"


_IS_END = frozenset(map(_text, _ENDS))
_IS_OTHER = frozenset(map(_text, (*_FAR, *(-value for value in _FAR), *_OTHERS)))
_DIGITS = re.compile(r"(-?)(\d)\.(\d*?)0*e([+-]\d+)")


@dataclass
class Occurring:
    """The values of planes, as they were stored.

    low, high: Range of all values but the fill values; infinite before there are any.
    fills: Fill values, and the number of voxels with each.
    voxels: Number of voxels with a value.
    """

    low: Number = float("inf")
    high: Number = float("-inf")
    fills: dict[Number, int] = field(default_factory=dict)
    voxels: int = 0


def occurring(planes: Iterable[Array], named: Sequence[float] = ()) -> Occurring:
    """Returns the Occurring of planes of real numbers. named: Fill values in the header."""
    found, candidates = Occurring(), dict[Number, int]()
    for plane in planes:
        known = plane[np.isfinite(plane)] if plane.dtype.kind == "f" else plane.ravel()
        found.voxels += known.size
        while known.size:
            low, high = known.min().item(), known.max().item()
            ends = {end for end in (low, high) if _may_be_fill(end, named)}
            if not ends:
                found.low, found.high = min(found.low, low), max(found.high, high)
                break
            for end in ends:
                is_end = known == end
                candidates[end] = candidates.get(end, 0) + int(np.count_nonzero(is_end))
                known = known[~is_end]
    _part(found, candidates, named)
    return found


def _part(found: Occurring, candidates: dict[Number, int], named: Sequence[float]) -> None:
    """Adds each candidate to the fill values or to the range, the nearest to the others first."""

    def gap(value: Number) -> Number:
        return max(found.low - value, value - found.high)

    while candidates:
        value = min(candidates, key=lambda one: (gap(one), one))
        count = candidates.pop(value)
        is_far = 0 < found.high - found.low < gap(value) and found.low <= found.high
        if is_far and (_is_named(value, named) or not _is_saturation(value, count, found)):
            found.fills[value] = count
        else:
            found.low, found.high = min(found.low, value), max(found.high, value)


def _is_saturation(value: Number, count: int, found: Occurring) -> bool:
    least = max(_LEAST, _LEAST_SHARE * found.voxels)
    return _text(value) in _IS_END and count < least


def _is_named(value: Number, named: Sequence[float]) -> bool:
    return any(_text(value) == _text(one) for one in named)


def _may_be_fill(value: Number, named: Sequence[float]) -> bool:
    """Returns True if the number is a known fill value."""
    text = _text(value)
    if text in _IS_END or text in _IS_OTHER or _is_named(value, named):
        return True
    parts = _DIGITS.fullmatch(text)
    if parts is None:
        return False
    minus, first, others, exponent = parts.groups()
    size, is_real = int(exponent), isinstance(value, float)
    if first == "1" and not others:
        return is_real and size >= 10
    # Accept -999, -9999, 9999. and 9.999e20. Positive integers may be labels.
    nines = first + others
    return (
        set(nines) == {"9"} and len(nines) >= 3 and (size >= 2 if minus else is_real and size >= 3)
    )


# Limits on the steps of single precision between the lowest and the highest value. Below the first,
# terraces are visible if the data are more exact. Below the second, the light is wrong.
_ENOUGH, _AT_LEAST = 4096, 32


def common_offset(low: Number, high: Number, dtype: np.dtype[Any]) -> Number:
    """Returns a round number to subtract from all stored values; 0 if they need none.

    low, high: The lowest and the highest value. dtype: A type that holds them exactly.
    """
    most = max(abs(low), abs(high))
    if not 0 < high - low < most <= float(np.finfo(np.float32).max):
        return 0
    steps = float(high - low) / float(np.spacing(np.float32(most)))
    are_exact = np.can_cast(dtype, np.float32) or (dtype.kind in "iu" and most <= 1 << 24)
    if steps >= (_AT_LEAST if are_exact else _ENOUGH):
        return 0
    digits = math.ceil(math.log10(high - low) - 1e-6)
    if isinstance(low, int):
        unit = int(10**digits)
        return low // unit * unit
    # Round to a multiple of the unit if the value is nearly one.
    return round(math.floor(low / 10.0**digits + 1e-6) * 10.0**digits, -digits)
