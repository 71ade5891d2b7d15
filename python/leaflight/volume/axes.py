# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds which axes of an array in a file are x, y and z, and the positions of its samples."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from .units import common_unit

# From the world of ITK and DICOM (left-posterior-superior) to ours (right-anterior-superior).
FROM_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])
# Attributes of coordinates along an axis that axis_at() uses.
CF = ("units", "axis", "positive", "standard_name")
# Tolerance of even spacing, in steps.
_EVEN = 0.01
# Upper bound on the samples of an unknown last axis that is taken for channels.
_MOST_CHANNELS = 4
# Units that grow downwards, if a vertical axis does not give its direction.
_PRESSURES = {"pa", "hpa", "kpa", "mbar", "millibar", "bar", "atm", "dbar", "decibar"}
_DEGREES = re.compile(r"deg(?:ree)?s?_?([ensw]|east|north|south|west)", re.IGNORECASE)
_NAMES = {
    "x": "x lon longitude easting column columns col",
    "y": "y lat latitude northing row rows",
    "z": "z depth height altitude alt lev level levels plev pressure layer slice slices plane",
    "t": "t time times frame frames timepoint timepoints date",
    "c": "c channel channels band bands component components wavelength member ensemble",
}
_LETTERS = {name: letter for letter, names in _NAMES.items() for name in names.split()}
# Axes of a reciprocal lattice, only if all are present: k alone may be any axis.
_MILLER = {"h": "x", "k": "y", "l": "z"}


@dataclass(frozen=True)
class Axis:
    """One axis of an array, as its file describes it.

    size: Number of samples.
    name: Name of the dimension.
    letter: One of "xyztc", if the file gives it. Otherwise it is guessed from the name.
    first, step: Position of the first sample and distance of samples, None if unknown.
    unit: Unit of the positions, the file's own word.
    even: True if samples are evenly spaced.
    """

    size: int
    name: str = ""
    letter: str = ""
    first: float | None = None
    step: float | None = None
    unit: str = ""
    even: bool = True


@dataclass(frozen=True)
class Grid:
    """The positions of an array's samples.

    letters: One of "xyztc" for each axis of the array, "-" for axes of one sample.
    matrix: Matrix from indices to world coordinates.
    unit: Unit of world coordinates, a key of METERS or "".
    notes: As in StoredVolume.
    """

    letters: str
    matrix: Array
    unit: str
    notes: tuple[str, ...]


def grid_of(axes: Sequence[Axis]) -> Grid | None:
    """Returns the Grid of an array with these axes, None if it is not a volume."""
    letters, guesses = _letters(axes)
    if not set("xyz") <= set(letters):
        return None
    space = [axes[letters.index(letter)] for letter in "xyz"]
    # Times are not coordinates.
    space = [replace(axis, step=None) if axis.letter == "t" else axis for axis in space]
    matrix, unit, notes = _placed(space)
    return Grid(letters, matrix, unit, (*guesses, *notes))


def axis_at(size: int, name: str, places: Array, attributes: Mapping[str, str]) -> Axis:
    """Returns the Axis with samples, or edges between them, at these positions.

    attributes: CF attributes of the positions, as text; https://cfconventions.org
    """
    unit = attributes.get("units", "")
    unit = "degrees" if _DEGREES.fullmatch(unit) else unit
    axis = Axis(size, name, _cf_letter(name, attributes), unit=unit)
    if places.dtype.kind not in "iuf" or places.ndim != 1 or axis.letter == "t":
        return axis
    places = places.astype(np.float64)
    if len(places) == size + 1:
        places = 0.5 * (places[1:] + places[:-1])
    if len(places) != size or size < 2 or not np.isfinite(places).all():
        return axis
    steps = np.diff(places)
    if not ((steps > 0).all() or (steps < 0).all()):
        return axis
    if attributes.get("positive", "").lower() == "down" or (
        "positive" not in attributes and unit.lower() in _PRESSURES
    ):
        places = -places
    step = (places[-1] - places[0]) / (size - 1)
    slack = _EVEN * abs(step) + 8 * np.finfo(np.float32).eps * np.abs(places).max()
    even = np.abs(places - places[0] - step * np.arange(size)).max() <= slack
    return replace(axis, first=float(places[0]), step=float(step), even=bool(even))


def _cf_letter(name: str, attributes: Mapping[str, str]) -> str:
    """Returns the letter of an axis from its attributes or name, or ""."""
    letter = attributes.get("axis", "").strip().lower()
    if letter in tuple("xyzt"):
        return letter
    unit = attributes.get("units", "").strip()
    if " since " in f" {unit} ":
        return "t"
    degrees = _DEGREES.fullmatch(unit)
    if degrees:
        return "x" if degrees[1][0].lower() in "ew" else "y"
    if attributes.get("positive", "").lower() in ("up", "down"):
        return "z"
    return _letter_of(name) or _letter_of(attributes.get("standard_name", ""))


def _letter_of(name: str) -> str:
    """Returns the letter of an axis of this name, or "". "voxel_x" and "qx" are x."""
    name = name.strip().lower()
    if name in _LETTERS:
        return _LETTERS[name]
    words = re.split(r"[^a-z]+", name)
    letters = {word for word in words if word in tuple("xyz")}
    letters |= {_LETTERS[word] for word in words if len(word) > 1 and word in _LETTERS}
    letters |= {word[1] for word in words if re.fullmatch("[a-z][xyz]", word)}
    return letters.pop() if len(letters) == 1 else ""


def _letters(axes: Sequence[Axis]) -> tuple[str, tuple[str, ...]]:
    """Returns (a letter for each axis, "-" for none or one sample; notes).

    Axes with unknown letters are z, y and x in this order. Time and channels precede them.
    """
    names = [axis.name.lower() for axis in axes]
    known = _MILLER if _MILLER.keys() <= set(names) else {}
    found = [
        (axis.letter or known.get(name) or _letter_of(name)) if axis.size > 1 else ""
        for axis, name in zip(axes, names)
    ]
    # If two axes have the same letter, neither gets it.
    found = [letter if found.count(letter) == 1 else "" for letter in found]
    long = [i for i, axis in enumerate(axes) if axis.size > 1]
    unknown = [i for i in long if not found[i]]
    notes: list[str] = []
    sizes = [axes[i].size for i in long]
    nameless = len(unknown) == len(long) and len(long) > 3
    if nameless and sizes[-1] <= _MOST_CHANNELS < min(sizes[-4:-1]):
        found[unknown.pop()] = "c"
        notes.append(f"The last axis has only {sizes[-1]} samples and is read as channels.")
    missing = [letter for letter in "zyx" if letter not in found]
    kept = min(len(unknown), len(missing))
    for i, letter in zip(unknown[len(unknown) - kept :], missing[len(missing) - kept :]):
        found[i] = letter
    others = unknown[: len(unknown) - kept]
    if len(others) == 2:
        notes.append("The first two axes are read as frames and channels.")
    for i in others:
        before = all(i < found.index(letter) for letter in "xyz" if letter in found)
        free = [letter for letter in ("tc" if before else "ct") if letter not in found]
        if not free:
            return "-" * len(axes), ()
        found[i] = free[0]
    # Take time as the depth if there is no other, as in a film.
    if [letter for letter in missing if letter not in found] == ["z"] and "t" in found:
        found[found.index("t")] = "z"
        notes.append("The data have no axis z; frames are read as the slices of a volume.")
    return "".join(letter or "-" for letter in found), tuple(notes)


def _placed(space: Sequence[Axis]) -> tuple[Array, str, list[str]]:
    """Returns (matrix from index to world, unit, notes) of the axes x, y and z."""
    known = [axis for axis in space if axis.step]
    if not known:
        return np.eye(4), "", []
    steps, firsts, notes = [], [], []
    common = common_unit([axis.unit for axis in known])
    factors = iter(common[1] if common else [])
    for letter, axis in zip("xyz", space):
        if axis.step is None or axis.step == 0:
            steps.append(1.0)
            firsts.append(0.0)
            notes.append(f"The file has no voxel size along {letter}; it is assumed to be 1.")
        elif common is None:
            steps.append(float(np.sign(axis.step)))
            firsts.append(0.0)
        else:
            factor = next(factors)
            steps.append(factor * axis.step)
            firsts.append(factor * (axis.first or 0.0))
            if not axis.even:
                notes.append(
                    f"The samples along {letter} are unevenly spaced; their mean distance is used."
                )
    if common is None:
        units = ", ".join(f"{axis.unit[:40] or 'no unit'}" for axis in known)
        notes.append(
            f"The units of its axes, {units}, cannot be compared; voxels are read as cubes of "
            "size 1, unless you give a voxel size."
        )
    elif common[0] and not all(axis.unit for axis in known):
        notes.append(f"Only some axes have a unit; {common[0]} is used for all.")
    matrix = np.diag([*steps, 1.0])
    matrix[:3, 3] = firsts
    return matrix, common[0] if common else "", notes
