# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs visibility maps into four bits a light point, for a web page.

Only isosurfaces of nearby values pass a texel. So a code of a map (DirectLight) is stored relative
to the least and the greatest of these values. The page computes both itself.
"""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from .._core import DirectLight
from ..arrays import Array

# Levels of light paths that no isosurface blocks, that all block, and that a mesh blocks. Levels
# between are equal parts of the range of codes; the first and the last part are cut.
LIT, HIDDEN, DARK = 0, 14, 15
# Number of light points whose levels the graphics card reads at once.
POINTS_A_TEXEL = 8
_PARTS = HIDDEN - 2
# Offset of the parts of each light point (a Kronecker sequence). Light points of a lamp have
# similar codes, and equal rounding would move all of their shadows in one direction.
_SHIFT = 0.6180339887


def code_of(value: Array, isovalue_range: Sequence[float]) -> Array:
    """Returns the code of a value, 1 to 253 over the range (low, high); values may lie beyond."""
    low, high = isovalue_range
    return 1.0 + (value - low) * (252.0 / (high - low))


def ranges(
    values: Array, missing: int | None, texels: Sequence[int], code: Callable[[Array], Array]
) -> tuple[Array, Array]:
    """Returns (least, greatest) code of the voxels within one texel of each texel, uint8 [z, y, x].

    values: Array [z, y, x].
    missing: Value of masked voxels, greater than all others, or None.
    texels: Texels (x, y, z) of the map.
    code: Ascending function from values to codes.
    """
    least = greatest = values
    if missing is not None:
        greatest = np.where(values == missing, values.dtype.type(0), values)
    for axis, count in enumerate(texels[::-1]):
        least = _by_texel(np.minimum, least, axis, count)
        greatest = _by_texel(np.maximum, greatest, axis, count)
    return _byte(np.floor(code(least))), _byte(np.ceil(code(greatest)))


def ranges_in_plane(
    values: Array,
    missing: int | None,
    texels: Sequence[int],
    code: Callable[[Array], Array],
    z: int,
) -> tuple[Array, Array]:
    """Returns ranges() of the texels of one z, uint8 [y, x]."""
    first, end = _voxels_about(z, texels[2], len(values))
    slab = values[first:end]
    masked = slab if missing is None else np.where(slab == missing, slab.dtype.type(0), slab)
    low, high = slab.min(axis=0), masked.max(axis=0)
    for axis, count in enumerate(texels[1::-1]):
        low = _by_texel(np.minimum, low, axis, count)
        high = _by_texel(np.maximum, high, axis, count)
    return _byte(np.floor(code(low))), _byte(np.ceil(code(high)))


def levels(codes: Array, least: Array, greatest: Array, point: int) -> Array:
    """Returns the levels, uint8, of codes for a light point, between least and greatest codes."""
    part = np.clip(codes, least, greatest) - least
    place = (greatest - least).astype(np.uint16) * np.uint16(256) + part
    found: Array = _table(point * _SHIFT % 1.0).take(place)
    found[codes == 255] = DARK
    return found


def pairs(direct: DirectLight, back: bool, least: Array, greatest: Array) -> Iterator[Array]:
    """Returns uint8 (n,) of the active texels for each pair of light points of a DirectLight.

    A byte is the level of the first plus 16 times that of the second. least, greatest: Codes around
    these texels.
    """
    for point in range(0, len(direct.light_points), 2):
        both = levels(direct.codes(point, back), least, greatest, point)
        if point + 1 < len(direct.light_points):
            both |= levels(direct.codes(point + 1, back), least, greatest, point + 1) << 4
        yield both


def pairs_in(direct: DirectLight, least: Array, greatest: Array, part: slice) -> Array:
    """Returns the first of pairs() of the front for a part of the active texels."""
    first = levels(direct.codes(0)[part], least, greatest, 0)
    if len(direct.light_points) > 1:
        first |= levels(direct.codes(1)[part], least, greatest, 1) << 4
    return first


def _by_texel(function: np.ufunc, values: Array, axis: int, count: int) -> Array:
    voxels = values.shape[axis]
    planes = []
    for texel in range(count):
        about = range(*_voxels_about(texel, count, voxels))
        planes.append(function.reduce(values.take(about, axis), axis))
    return np.stack(planes, axis)


def _voxels_about(texel: int, count: int, voxels: int) -> tuple[int, int]:
    """Returns the first voxel around a texel along an axis, and the one after the last."""
    width = (voxels - 1) / (count - 1)
    first = max(0, math.floor((texel - 1) * width))
    return first, min(voxels, math.ceil((texel + 1) * width) + 1)


def _byte(codes: Array) -> Array:
    return np.clip(codes, 0, 254).astype(np.uint8)


def _table(shift: float) -> Array:
    """Returns [range of codes, code in it]: the level. shift: Offset of the parts, 0 to 1."""
    span, part = np.mgrid[:256, :256]
    between = np.floor(part * _PARTS / np.maximum(span, 1) + 2.0 - shift)
    table = np.where(part == 0, LIT, np.where(part >= span, HIDDEN, between))
    return table.astype(np.uint8).ravel()
