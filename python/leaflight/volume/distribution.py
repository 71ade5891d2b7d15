# SPDX-License-Identifier: GPL-3.0-or-later
"""The distribution of the values of a volume, counted plane by plane to save memory."""

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from .label_table import are_labels
from .memory import as_voxels

# Upper bounds on different values that are counted one by one: whole numbers, and others.
MOST_LEVELS, FEW_LEVELS = 4096, 32
# Least number of steps of single precision in a range. In a range with fewer, the lowest value is
# subtracted before values are counted.
_STEPS = 1 << 16


class Distribution:
    """The distribution of the values in an array [z, y, x] from a lowest one on.

    data_range: The lowest and the highest value. count: Number of values.
    """

    def __init__(self, values: Array, data_range: tuple[float, float]) -> None:
        # float32 gives the same edges of bins with any NumPy.
        self._range: Any = tuple(np.float32(end) for end in data_range)
        low, high = self._range
        # Offset of the bins, where their edges would otherwise be equal in single precision; else
        # 0.
        self._least = low if high - low < _STEPS * np.spacing(max(-low, high)) else np.float32(0)
        self._data = values
        is_integer = as_voxels(values[:1]).dtype != np.float32
        self._counted = self._count_whole() if is_integer else None
        if self._counted is not None:
            self.count = int(self._counted[1].sum())
        else:
            self.count = sum(plane.size for plane in self._planes())

    def _count_whole(self) -> tuple[Array, Array]:
        """Returns the different values, float32, and the voxels of each, for whole numbers."""
        limits = np.iinfo(as_voxels(self._data[:1]).dtype)
        least, voxels = int(limits.min), np.zeros(limits.max - limits.min + 1, np.int64)
        for plane in self._data:
            plane = as_voxels(plane)
            voxels += np.bincount(plane.ravel().astype(np.int64) - least, minlength=voxels.size)
        present = np.flatnonzero(voxels)
        present = present[present + least >= self._range[0]]
        return (present + least).astype(np.float32), voxels[present]

    def _planes(self) -> Iterator[Array]:
        """Yields the values of each plane, float32, without NaN and lower ones."""
        for plane in self._data:
            plane = as_voxels(plane).ravel()
            known = plane >= self._range[0]
            yield plane if known.all() else plane[known]

    def voxels_of(self, value: float) -> int:
        """Returns the number of voxels with this value."""
        if self._counted is not None:
            values, voxels = self._counted
            return int(voxels[values == np.float32(value)].sum())
        return sum(int(np.count_nonzero(plane == np.float32(value))) for plane in self._planes())

    def histogram(self, bins: int) -> tuple[Array, Array]:
        """Returns (numbers of voxels, edges) of bins of equal width over the range."""
        if self._counted is not None:
            values, voxels = self._counted
            return np.histogram(values, bins, self._range, weights=voxels)
        counts, least = np.zeros(bins, np.int64), self._least
        ends: Any = tuple(end - least for end in self._range)
        for plane in self._planes():
            found, edges = np.histogram(plane - least if least else plane, bins, ends)
            counts += found
        return counts, edges.astype(np.float64) + float(least) if least else edges

    @cached_property
    def levels(self) -> tuple[Array, Array] | None:
        """The different values, float64, ascending, and the voxels that have each; None if many.

        Many are more than MOST_LEVELS, or more than FEW_LEVELS that are not whole numbers.
        """
        if self._counted is not None:
            values, voxels = self._counted
            return (values.astype(np.float64), voxels) if len(values) <= MOST_LEVELS else None
        found: dict[float, int] = {}
        most = MOST_LEVELS
        for plane in self._planes():
            values, voxels, are_whole = _levels_of(plane)
            most = most if are_whole else FEW_LEVELS
            if len(values) > most:
                return None
            for value, count in zip(values.tolist(), voxels.tolist()):
                found[value] = found.get(value, 0) + count
            if len(found) > most:
                return None
        ascending = sorted(found)
        return np.array(ascending), np.array([found[value] for value in ascending])

    @cached_property
    def are_labels(self) -> bool:
        """Returns True if the values look like those of a mask or a label map."""
        return self.levels is not None and are_labels(self._data, self.levels[0])

    def are_whole(self, without: Sequence[float] = ()) -> bool:
        """Returns True if all values except `without` are whole numbers."""
        if self._counted is not None:
            return True
        left = [np.float32(value) for value in without]
        return all(
            np.all((plane == np.rint(plane)) | np.isin(plane, left)) for plane in self._planes()
        )

    def at(self, ranks: Sequence[int], without: Sequence[float] = ()) -> Array:
        """Returns the values (float64) of these ranks in ascending order, counted from 0.

        without: Values that are left out.
        """
        if self._counted is not None:
            values, voxels = self._counted
            kept = ~np.isin(values, np.asarray(without, np.float32))
            values, last = values[kept], np.cumsum(voxels[kept])
            return values[np.searchsorted(last, ranks, side="right")].astype(np.float64)
        left = np.asarray(without, np.float32)
        # Count the upper 16 bits of the keys first, then the lower bits within the bins that
        # matter.
        upper = np.zeros(1 << 16, np.int64)
        for keys in self._keys(left):
            upper += np.bincount(keys >> 16, minlength=upper.size)
        last = np.cumsum(upper)
        bins = np.searchsorted(last, ranks, side="right")
        lower = {int(one): np.zeros(1 << 16, np.int64) for one in bins}
        for keys in self._keys(left):
            for one, voxels in lower.items():
                voxels += np.bincount(keys[keys >> 16 == one] & 0xFFFF, minlength=voxels.size)
        found = []
        for rank, one in zip(ranks, bins):
            within = rank - (last[one] - upper[one])
            low = np.searchsorted(np.cumsum(lower[int(one)]), within, side="right")
            found.append(_value(int(one) << 16 | int(low)))
        return np.array(found, np.float64)

    def _keys(self, left: Array) -> Iterator[Array]:
        """Yields whole numbers, uint32, in the order of the values."""
        for plane in self._planes():
            if left.size:
                plane = plane[~np.isin(plane, left)]
            bits = plane.view(np.uint32)
            yield np.where(bits >> 31, ~bits, bits | np.uint32(1 << 31))


def _levels_of(plane: Array) -> tuple[Array, Array, bool]:
    """Returns the different values of float32 (n,), the voxels of each, and if all are whole
    numbers.
    """
    are_whole = bool((plane == np.rint(plane)).all())
    if are_whole and plane.size and plane.max() - plane.min() < 1 << 16:
        least = int(plane.min())
        voxels = np.bincount((plane - np.float32(least)).astype(np.int64))
        present = np.flatnonzero(voxels)
        return present + least, voxels[present], True
    # Labels lie in pieces, so count runs of equal values.
    first = np.flatnonzero(np.append(plane.size > 0, plane[1:] != plane[:-1]))
    values, of_piece = np.unique(plane[first], return_inverse=True)
    lengths = np.diff(np.append(first, plane.size))
    return values, np.bincount(of_piece, lengths, len(values)).astype(np.int64), are_whole


def _value(key: int) -> np.float32:
    bits = key ^ (1 << 31) if key >> 31 else ~key & 0xFFFFFFFF
    return np.uint32(bits).view(np.float32)
