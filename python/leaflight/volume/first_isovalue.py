# SPDX-License-Identifier: GPL-3.0-or-later
"""Default isovalues: the range to bake, the first one to show, and the next one inside it."""

from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from .backs import MOSTLY, back_shares
from .distribution import FEW_LEVELS, Distribution
from .volume import Volume

# Above this share of the voxels, a value at an end of the range is padding around the object.
BACKGROUND_SHARE = 0.1
# Least depth of a level set below 0, relative to the highest value. Shallower values are noise.
LEVEL_SET = 0.1
# Share of the range above 0 below which isosurfaces between lobes of both signs show nothing.
AT_ZERO = 0.02


def default_isovalue_range(volume: Volume) -> tuple[float, float]:
    """Returns the default range (lo, hi): the middle 99 % of the values except the background.

    Labels and data with few different values give the whole range.
    """
    low, high = volume.data_range()
    if _levels_to_part(volume) is not None:
        return low, high
    lo, hi = _quantiles(volume, (0.005, 0.995))
    if not lo < hi:
        # Nearly all values are equal: only the whole range surely holds a surface.
        lo, hi = low, high
    return float(lo), float(hi)


def default_isovalue(volume: Volume) -> float:
    """Returns the isovalue that best separates object and background (Otsu 1979), in the range.

    If there are few values, it lies half way between two of them. Labels are separated from 0, or
    else from the lowest label.
    """
    found = _levels_to_part(volume)
    if found is not None:
        levels, counts = found
        if volume.distribution.are_labels:
            return _half_way(levels, _last_of_background(levels))
        isovalue = _half_way(levels, _best_splits(counts, levels)[0])
        return _seen_from_front(volume, isovalue, *volume.data_range())
    isovalue, _ = _best_edges(*volume.distribution.histogram(256))
    if _is_integer(volume):
        isovalue = np.floor(isovalue) + 0.5
    lo, hi = default_isovalue_range(volume)
    if not lo < isovalue < hi:
        return 0.5 * (lo + hi)
    if lo < 0 < hi and abs(isovalue) < AT_ZERO * hi and is_mostly_zero(volume):
        lobe = inner_isovalue(volume, 0.0)
        return lobe if lobe is not None and lobe < hi else float(isovalue)
    return _seen_from_front(volume, float(isovalue), lo, hi)


def inner_isovalue(volume: Volume, isovalue: float) -> float | None:
    """Returns the isovalue that best separates the values inside an isosurface (Otsu 1979).

    In a head it finds the skull within the skin. If there are few values, it lies half way between
    two of them. Returns None if all values inside are equal.
    """
    found = _levels_to_part(volume)
    if found is not None:
        levels, counts = (each[found[0] >= isovalue] for each in found)
        if len(levels) < 2:
            return None
        return _half_way(levels, _best_splits(counts, levels)[0])
    counts, edges = volume.distribution.histogram(256)
    inside = np.flatnonzero((edges[:-1] >= isovalue) & (counts > 0))
    if len(inside) < 2:
        return None
    begin, end = inside[0], inside[-1] + 1
    # Take the middle of an empty part, away from the noise on both sides.
    inner = np.mean(_best_edges(counts[begin:end], edges[begin : end + 1]))
    return float(np.floor(inner) + 0.5 if _is_integer(volume) else inner)


def is_mostly_zero(volume: Volume) -> bool:
    """Returns True if most values are near 0, between lobes of both signs."""
    counts, edges = volume.distribution.histogram(256)
    middles = 0.5 * (edges[1:] + edges[:-1])
    is_near = np.abs(middles) < 0.1 * np.abs(middles).max()
    return bool(counts[is_near].sum() > 0.5 * counts.sum())


def _seen_from_front(volume: Volume, isovalue: float, lo: float, hi: float) -> float:
    """Returns another isovalue if values have both signs and this one shows a back.

    An isosurface around a negative lobe shows its back, so the opposite isovalue is returned if it
    shows a positive lobe. A level set has its surface at 0.
    """
    if not lo < 0 < hi or volume.values.ndim != 3:
        return isovalue
    if isovalue > 0 and -lo < LEVEL_SET * hi:
        return isovalue
    other = -isovalue if isovalue < 0 else 0.5 if _is_integer(volume) else 0.0
    if not other < hi:
        return isovalue
    shares = back_shares(volume.data(), volume.index_to_world, (isovalue, other))
    if shares[0] <= MOSTLY:
        return isovalue
    is_better = shares[1] < 1.0 - MOSTLY if isovalue < 0 else shares[1] > MOSTLY
    return other if is_better else isovalue


def _levels_to_part(volume: Volume) -> tuple[Array, Array] | None:
    """Returns the levels of the Distribution if an isovalue must lie half way between two; else
    None.
    """
    found = volume.distribution
    if found.levels is None or len(found.levels[0]) < 2:
        return None
    return found.levels if len(found.levels[0]) <= FEW_LEVELS or found.are_labels else None


def _last_of_background(levels: Array) -> int:
    """Returns the index of label 0, or else of the lowest label; never of the highest."""
    zero = np.flatnonzero(levels == 0.0)
    return min(int(zero[0]), len(levels) - 2) if len(zero) else 0


def _half_way(levels: Array, first: int) -> float:
    """Returns the mean of a level and the next."""
    return 0.5 * float(levels[first] + levels[first + 1])


def _best_edges(counts: Array, edges: Array) -> tuple[float, float]:
    """Returns the first and last of the edges of a histogram that best separate its two sides."""
    first, last = _best_splits(counts, 0.5 * (edges[1:] + edges[:-1]))
    return edges[first + 1], edges[last + 1]


def _best_splits(counts: Array, values: Array) -> tuple[int, int]:
    """Returns the first and the last index after which values are best split into two classes.

    Values at both indices occur. Several splits are equally good if no value between them occurs.
    """
    below, below_sum = np.cumsum(counts)[:-1], np.cumsum(counts * values)
    above = counts.sum() - below
    distance = below_sum[:-1] / below - (below_sum[-1] - below_sum[:-1]) / above
    between = below * above.astype(np.float64) * distance**2
    best = np.flatnonzero(between == between.max())
    return int(best[0]), int(best[-1])


def _quantiles(volume: Volume, shares: Sequence[float]) -> list[float]:
    """Returns quantiles of the values outside the background; half-integers for integer data.

    An isosurface of integer data at an integer passes through grid nodes and shows the
    quantization.
    """
    low, high = volume.data_range()
    found: Distribution = volume.distribution
    count, background = found.count, []
    for end in (low, high):
        of_end = found.voxels_of(end)
        if (count - of_end) / count < 1.0 - BACKGROUND_SHARE:
            background.append(end)
            count -= of_end
        if count == 0:
            return [0.5 * (low + high)] * len(shares)
    quantiles = found.at([int(share * (count - 1)) for share in shares], background)
    if _is_integer(volume, background):
        quantiles = np.floor(quantiles) + 0.5
    return list(np.clip(quantiles, low, high))


def _is_integer(volume: Volume, without: Sequence[float] = ()) -> bool:
    low, high = volume.data_range()
    return high - low >= 4 and volume.distribution.are_whole(without)
