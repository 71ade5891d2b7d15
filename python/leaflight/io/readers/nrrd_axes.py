# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the axes of an NRRD: those in space, with directions, and frames and channels."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..._core import LeaflightError
from ...arrays import Array
from ...volume.axes import FROM_LPS
from ...volume.units import METERS, unit_of
from .checks import check_matrix, text

_SPACES = {"ras": "right-anterior-superior", "las": "left-anterior-superior"}
_SPACES["lps"] = "left-posterior-superior"
# Matrices that convert each space to right-anterior-superior.
_TURNED = {
    "left-posterior-superior": FROM_LPS,
    "left-anterior-superior": np.diag([-1.0, 1.0, 1.0, 1.0]),
}
# Kinds of axes that are in space, and kinds that may be.
_IN_SPACE, _UNKNOWN = ("space", "domain"), ("???", "none", "unknown")
# Size of an axis above those of colors, tensors and complex numbers.
_MOST_CHANNELS = 16


@dataclass(frozen=True)
class Axes:
    """The meaning of each axis, by number, fastest first.

    matrix: Matrix from voxels to right-anterior-superior.
    unit: Unit of length, a key of METERS or "".
    patient: True if the coordinates are those of a patient.
    notes: Sentences for the user about guesses.
    """

    space: tuple[int, ...]
    frames: tuple[int, ...]
    channels: tuple[int, ...]
    matrix: Array
    unit: str
    patient: bool
    notes: tuple[str, ...]


def axes_of(path: Path, fields: dict[str, str], sizes: Sequence[int]) -> Axes:
    """Returns the Axes. Raises LeaflightError unless three axes in space have positions."""
    name = fields.get("space", "").lower().removesuffix("-time")
    name = _SPACES.get(name, _SPACES.get(name.removesuffix("t"), name))
    directions = _directions(path, fields, sizes)
    roles, notes = _roles(path, fields, sizes, directions)
    space, frames, channels = (
        tuple(i for i, role in enumerate(roles) if role == wanted)
        for wanted in ("space", "frame", "channel")
    )
    if directions is not None:
        matrix = _oriented(path, fields, [directions[i] for i in space])
        # Units belong to the axes of the world. Without directions these are the axes of the array.
        units = _units(fields.get("space units", ""), range(3))
    else:
        matrix = _upright(path, fields, sizes, space)
        axes = space if "units" in fields else range(3)
        units = _units(fields.get("units", fields.get("space units", "")), axes)
    for row, unit in zip(matrix, units):
        if unit and units[0]:
            row *= METERS[unit] / METERS[units[0]]
    check_matrix(path, matrix)
    # "3D-right-handed" and "3D-left-handed" are no spaces of a patient.
    patient = "superior" in name
    matrix = _TURNED.get(name, np.eye(4)) @ matrix
    unit = units[0] or ("mm" if patient else "")
    return Axes(space, frames, channels, matrix, unit, patient, notes)


def _roles(
    path: Path,
    fields: dict[str, str],
    sizes: Sequence[int],
    directions: Sequence[Array | None] | None,
) -> tuple[list[str], tuple[str, ...]]:
    """Returns ("space", "frame" or "channel" for each axis; notes about guesses)."""
    kinds = [word.lower() for word in _words(path, fields, "kinds", len(sizes), "???")]
    roles, notes = [], []
    for i, kind in enumerate(kinds):
        direction = directions[i] if directions is not None else None
        # The fourth axis of some spaces is time.
        if kind == "time" or (direction is not None and not direction[:3].any()):
            roles.append("frame")
        elif direction is not None or (
            directions is None and (kind in _IN_SPACE or kind in _UNKNOWN)
        ):
            roles.append("space")
        else:
            roles.append("channel")
    while roles.count("space") > 3:
        role, axis = _left_over(sizes, [i for i, role in enumerate(roles) if role == "space"])
        roles[axis] = role
        if sizes[axis] > 1 and kinds[axis] in _UNKNOWN:
            notes.append(
                f"The header does not name its {len(sizes)} axes: the "
                f"{'last' if axis else 'first'}, of {sizes[axis]}, is read as {role}s."
            )
    if roles.count("space") < 3:
        others = ", ".join(kind for kind, role in zip(kinds, roles) if role != "space")
        raise _no_volume(path, roles.count("space"), sizes, others)
    if directions is None and "kinds" not in fields and sizes[0] in (3, 4) and min(sizes[1:]) > 16:
        notes.append(
            f"The header does not name its axes: the first, of {sizes[0]}, is read as x, but it "
            "may be the colors of a picture."
        )
    return roles, tuple(notes)


def _no_volume(path: Path, count: int, sizes: Sequence[int], others: str = "") -> LeaflightError:
    also = f" (the others are {others[:60]})" if others else ""
    return LeaflightError(
        f"{path}: only {count} of the axes {text(sizes)} are in space{also}, but a volume needs "
        "three; join the slices to one file."
    )


def _left_over(sizes: Sequence[int], axes: Sequence[int]) -> tuple[str, int]:
    """Returns the role and the number of one axis that is not in space, of four or more."""
    first, last = axes[0], axes[-1]
    small = sizes[first] <= _MOST_CHANNELS and sizes[first] < min(sizes[i] for i in axes[1:])
    if sizes[last] > 1 and (sizes[first] == 1 or small):
        return "channel", first
    return "frame", last


def _oriented(path: Path, fields: dict[str, str], axes: Sequence[Array | None]) -> Array:
    matrix = np.eye(4)
    for i, axis in enumerate(axes):
        assert axis is not None
        matrix[:3, i] = axis[:3]
    if "space origin" in fields:
        origin = _vector(path, fields["space origin"])
        matrix[:3, 3] = np.zeros(3) if origin is None else origin[:3]
    return matrix


def _upright(
    path: Path, fields: dict[str, str], sizes: Sequence[int], space: Sequence[int]
) -> Array:
    """Returns the matrix from the spacings, or from the ends of each axis.

    Ends are the outer faces of cells, or nodes.
    """
    lists = [
        [_number(word) for word in _words(path, fields, name, len(sizes), "nan")]
        for name in ("spacings", "axis mins", "axis maxs")
    ]
    name = "centerings" if "centerings" in fields else "centers"
    centers = _words(path, fields, name, len(sizes), "cell")
    matrix = np.eye(4)
    for row, i in enumerate(space):
        step, low, high = (numbers[i] for numbers in lists)
        node = centers[i].lower() == "node"
        if not (math.isfinite(step) and step):
            step = (high - low) / max(1, sizes[i] - node)
        # NaN means unknown.
        matrix[row, row] = step if math.isfinite(step) and step else 1.0
        if math.isfinite(low):
            matrix[row, 3] = low if node else low + matrix[row, row] / 2
    return matrix


def _directions(
    path: Path, fields: dict[str, str], sizes: Sequence[int]
) -> list[Array | None] | None:
    """Returns a direction for each axis, None for axes without one; None if the header has none."""
    if "space directions" not in fields:
        return None
    words = re.findall(r"\([^()]*\)|[^\s()]+", fields["space directions"])
    if fields.get("space dimension") == "2":
        raise _no_volume(path, 2, sizes)
    if len(words) != len(sizes):
        raise LeaflightError(
            f"{path}: the header does not have {len(sizes)} space directions, one for each axis; "
            "repair the header."
        )
    return [None if word.lower() == "none" else _vector(path, word) for word in words]


def _vector(path: Path, words: str) -> Array | None:
    """Returns three numbers, or four of which the last is time; None if all are unknown."""
    numbers = np.array([_number(word) for word in words.strip("() ").split(",")])
    if np.isnan(numbers).all() and len(numbers) > 1:
        return None
    if len(numbers) not in (3, 4) or not np.isfinite(numbers).all():
        raise LeaflightError(
            f"{path}: {words[:60]} are not three numbers in brackets; repair the header."
        )
    return numbers


def _units(words: str, axes: Iterable[int]) -> list[str]:
    units = [unit_of(word) for word in re.findall(r'"([^"]*)"', words)]
    return [units[i] if i < len(units) else "" for i in axes]


def _words(
    path: Path, fields: dict[str, str], name: str, count: int, default: str
) -> Sequence[str]:
    """Returns the words of a field, one for each axis. Some files omit the space in its name."""
    value = fields.get(name, fields.get(name.replace(" ", "")))
    words = [default] * count if value is None else value.split()
    if len(words) != count:
        raise LeaflightError(
            f"{path}: the field {name} does not have {count} entries, one for each axis; repair "
            "the header."
        )
    return words


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return math.nan
