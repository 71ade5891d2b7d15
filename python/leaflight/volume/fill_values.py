# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill values: numbers such as -9999 and 1e20 that files hold where there are no data.

A number is taken for one where it is known as such, by custom or by the header, and isolated: no
other value is as near to it as the others are to each other. Saturated voxels are not isolated,
since the values around them are in between. Conventions: NetCDF's and CF's _FillValue, CMIP's 1e20,
the no-data values of ESRI, GDAL, GrADS and Surfer, the least values of integer types.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array

Number = int | float

# The ends of types: integers that saturated voxels have, too.
_ENDS = (
    *(-32768, -32767, 32767, 65535, 65504, -(2**31), 1 - 2**31, 2**31 - 1, 2**32 - 1),
    *(-(2**63), 1 - 2**63, 2**63 - 1, 2**64 - 1),
)
# Fill value of NetCDF; the largest numbers of float32 and float64, and rounded forms of them.
_FAR = (9.969209968386869e36, 3.4028234663852886e38, 3.4e38, 1.70141e38, 1.7976931348623157e308)
# Fill value of well logs.
_OTHERS = (-999.25,)
# Voxels that must hold the end of a type: so many, and such a share. A few are saturated, or hot.
_LEAST, _LEAST_SHARE = 16, 1e-3


def _text(value: Number) -> str:
    """The first seven digits, as far as single precision goes."""
    return f"{value:.6e}"


_IS_END = frozenset(map(_text, _ENDS))
_IS_OTHER = frozenset(map(_text, (*_FAR, *(-value for value in _FAR), *_OTHERS)))
_DIGITS = re.compile(r"(-?)(\d)\.(\d*?)0*e([+-]\d+)")


@dataclass
class Occurring:
    """The values of planes, as they were stored.

    low, high: of all but the fill values, infinite before there are any. fills: fill values and
    how many voxels hold each. voxels: all with a value.
    """

    low: Number = float("inf")
    high: Number = float("-inf")
    fills: dict[Number, int] = field(default_factory=dict)
    voxels: int = 0


def occurring(planes: Iterable[Array], named: Sequence[float] = ()) -> Occurring:
    """The Occurring of planes of any type of real numbers; named: fill values by the header."""
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
    # -999, -9999, 9999 and 9.999e20; labels have positive numbers of all kinds.
    nines = first + others
    return (
        set(nines) == {"9"} and len(nines) >= 3 and (size >= 2 if minus else is_real and size >= 3)
    )
