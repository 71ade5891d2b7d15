# SPDX-License-Identifier: GPL-3.0-or-later
"""Label maps: values that are numbers of labels, and the names and colors of labels."""

import colorsys
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from .memory import as_voxels

# Largest number of labels.
MOST_LABELS = 65535
# Largest label. Single precision holds all whole numbers up to it.
LARGEST_LABEL = 1 << 24


@dataclass(frozen=True)
class Label:
    """A label of a map. color: sRGB, each component in 0..1."""

    number: int
    name: str
    color: tuple[float, float, float]

    @staticmethod
    def of(number: int, name: str = "", color: Iterable[float] | None = None) -> "Label":
        """Returns a Label, by default with its number as name, and a color by its number."""
        if color is None:
            # Hues of the golden ratio, so that near numbers have different ones.
            color = colorsys.hsv_to_rgb(number * 0.618034 % 1.0, 0.55 + 0.3 * (number % 2), 0.9)
        red, green, blue = (min(max(float(part), 0.0), 1.0) for part in color)
        return Label(number, name or f"Label {number}", (red, green, blue))


def labels_of(values: Array, table: Iterable[Label] = ()) -> tuple[Label, ...]:
    """Returns the labels that occur in a map, as in its table if they are in it.

    Raises LeaflightError as label_numbers().
    """
    known = {label.number: label for label in table}
    return tuple(known.get(n) or Label.of(n) for n in label_numbers(values))


def label_numbers(values: Array) -> list[int]:
    """Returns the numbers above 0 that occur in a label map [z, y, x], ascending.

    NaN is no label. Raises LeaflightError unless all values are whole numbers in 0..LARGEST_LABEL,
    and for more than MOST_LABELS of them.
    """
    found, low, high = np.zeros(LARGEST_LABEL + 1, bool), 0.0, 0.0
    for plane in values:
        numbers = np.nan_to_num(plane)
        if numbers.dtype.kind == "f" and (numbers != np.rint(numbers)).any():
            raise LeaflightError("The values are not labels, because they are not whole numbers.")
        low, high = min(low, float(numbers.min())), max(high, float(numbers.max()))
        if low >= 0 and high <= LARGEST_LABEL:
            found[numbers.astype(np.int64)] = True
    if low < 0 or high > LARGEST_LABEL:
        raise LeaflightError(
            f"The labels {low:.10g} to {high:.10g} are outside 0 to {LARGEST_LABEL}: renumber them."
        )
    numbers_above: list[int] = (np.flatnonzero(found[1:]) + 1).tolist()
    if len(numbers_above) > MOST_LABELS:
        raise LeaflightError(
            f"There are {len(numbers_above)} labels, more than {MOST_LABELS}: remove small ones."
        )
    return numbers_above


def without_labels(values: Array, hidden: Iterable[int]) -> Array:
    """Returns a label map in which hidden labels are 0."""
    kept: Array = np.where(np.isin(values, list(hidden)), values.dtype.type(0), values)
    return kept


# Least share of the voxels of a label whose next neighbors along all axes have the same label, and
# least share of labels that pass. In a mask with soft edges, only the inside passes.
ALIKE, LABELS = 0.2, 0.6
# Upper bound on the slices that are examined.
_PLANES = 64


def are_labels(values: Array, levels: Array) -> bool:
    """Returns True if values [z, y, x] look like labels.

    levels: All different values in ascending order; the first is the background. Two levels are a
        mask. More must be whole numbers in connected pieces.
    """
    if len(levels) <= 2 or not (levels == np.rint(levels)).all():
        return len(levels) == 2
    voxels = np.zeros(len(levels), np.int64)
    alike = np.zeros(len(levels), np.int64)
    for k in range(0, len(values) - 1, max(1, len(values) // _PLANES)):
        plane, behind = as_voxels(values[k]), as_voxels(values[k + 1])
        here = plane[..., :-1]
        is_alike = (here == plane[..., 1:]) & (here == behind[..., :-1])
        if plane.ndim > 1:
            is_alike[:-1] &= here[:-1] == here[1:]
        voxels += _occurrences(here, levels)
        alike += _occurrences(here[is_alike], levels)
    seen = np.flatnonzero(voxels[1:]) + 1
    return len(seen) > 0 and bool(np.mean(alike[seen] >= ALIKE * voxels[seen]) >= LABELS)


def _occurrences(values: Array, levels: Array) -> Array:
    """Returns the number of values at each level. Values may be NaN."""
    known = values[np.isfinite(values)]
    return np.bincount(np.searchsorted(levels, known), minlength=len(levels))
