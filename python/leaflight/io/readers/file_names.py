# SPDX-License-Identifier: GPL-3.0-or-later
"""Sorts slices by the numbers in the names of their files."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import gcd, prod
from pathlib import Path

from ..._core import LeaflightError
from .checks import listed

# Letters before a number that name its axis; the first of each kind is the name in Blocks.
_MEANINGS = {
    "Z": ("z", "slice", "plane", "sl", "zpos"),
    "T": ("t", "time", "frame", "timepoint", "tp"),
    "C": ("c", "ch", "channel", "w", "wavelength", "chan"),
}
# Upper bounds on the number and the share of other files beside a sequence, such as previews.
_MOST_OTHERS, _SHARE_OF_OTHERS = 2, 0.1

_Numbers = tuple[int, ...]


@dataclass(frozen=True)
class Slices:
    """Files that are the slices of one volume, or of a series.

    name: Common part of the file names, "#" for the number of a slice.
    axes: Names and lengths of "T", "C" and "Z".
    files: Files in the order of the axes, the last one fastest.
    """

    name: str
    axes: tuple[tuple[str, int], ...]
    files: tuple[Path, ...]
    notes: tuple[str, ...] = ()


def visible(folder: Path) -> list[Path]:
    """Returns the files of a folder without hidden ones.

    macOS adds hidden files, ._NAME, to those that it copies to other disks.
    """
    return [path for path in folder.iterdir() if path.name[0] != "." and path.is_file()]


def visible_files(folder: Path, suffixes: Sequence[str]) -> list[Path]:
    """Returns the visible() files with one of these suffixes, sorted."""
    files = [path for path in visible(folder) if path.suffix.lower() in suffixes]
    return sorted(files, key=lambda path: _natural(path.name))


def sequences(folder: Path, files: Sequence[Path]) -> list[Slices]:
    """Returns the sequences of slices that files of a folder make. Raises LeaflightError."""
    groups: dict[tuple[str, ...], list[Path]] = {}
    for file in files:
        groups.setdefault(_texts(file), []).append(file)
    most = max(len(group) for group in groups.values())
    if most == 1:
        return [Slices(folder.name, (("Z", len(files)),), tuple(files))]
    others = [f for group in groups.values() if len(group) < most for f in group]
    left_out = [f for group in groups.values() if len(group) == 1 for f in group]
    if len(others) <= max(_MOST_OTHERS, _SHARE_OF_OTHERS * len(files)):
        left_out = others
    kept = [group for group in groups.values() if group[0] not in left_out]
    notes: tuple[str, ...] = ()
    if left_out:
        names = listed([file.name for file in left_out])
        notes = (f"Files with other names than the slices are left out: {names}.",)
    return [
        Slices(one.name, one.axes, one.files, (*notes, *one.notes))
        for group in kept
        for one in _of_one_pattern(folder, group)
    ]


def _natural(name: str) -> list[tuple[int, str]]:
    parts = re.split(r"(\d+)", name)
    return [(int(part), "") if k % 2 else (0, part.lower()) for k, part in enumerate(parts)]


def _texts(path: Path) -> tuple[str, ...]:
    return tuple(re.split(r"\d+", path.name.lower()))


def _of_one_pattern(folder: Path, files: list[Path]) -> list[Slices]:
    """Returns the sequences of files whose names differ only in their numbers."""
    numbers = {file: tuple(int(n) for n in re.findall(r"\d+", file.name)) for file in files}
    columns = [set(column) for column in zip(*numbers.values())]
    varying = [k for k, column in enumerate(columns) if len(column) > 1]
    if len(varying) > 1 and any(len(columns[k]) == len(files) for k in varying):
        # Another number may vary together with that of the slice, such as its time.
        varying = [next(k for k in varying if len(columns[k]) == len(files))]
    meanings = _meanings(_texts(files[0]), varying)
    depth = next((k for k in varying if meanings[k] == "Z"), varying[-1] if varying else 0)
    meanings[depth] = "Z"
    named = [k for kind in "TC" for k in varying if meanings[k] == kind]
    rest = [k for k in varying if k != depth and k not in named]
    parts: dict[_Numbers, list[Path]] = {}
    for file in files:
        parts.setdefault(tuple(numbers[file][k] for k in rest), []).append(file)
    return [
        _grid(folder, part, numbers, [(meanings[k], k) for k in (*named, depth)])
        for _, part in sorted(parts.items())
    ]


def _meanings(texts: tuple[str, ...], varying: Sequence[int]) -> dict[int, str]:
    """Returns {index of a number: axis} by the letters before it, "" for unknown letters."""
    found = {}
    for k in varying:
        letters = re.findall(r"[a-z]*$", re.sub(r"[^a-z]+$", "", texts[k]))[0]
        found[k] = next((axis for axis, words in _MEANINGS.items() if letters in words), "")
    return {k: axis if list(found.values()).count(axis) == 1 else "" for k, axis in found.items()}


def _grid(
    folder: Path,
    files: list[Path],
    numbers: dict[Path, _Numbers],
    columns: Sequence[tuple[str, int]],
) -> Slices:
    """Returns the sequence of files that fill a grid. Raises LeaflightError if one is missing.

    columns: Axis and index of each number in a name, the fastest axis last.
    """
    places = {tuple(numbers[file][k] for _, k in columns): file for file in files}
    if len(places) < len(files):
        double = next(file for file in files if file not in places.values())
        raise LeaflightError(
            f"{folder}: two files have the same numbers as {double.name}; keep one of them."
        )
    counted = [sorted({place[k] for place in places}) for k in range(len(columns))]
    order = list(product(*counted)) if prod(map(len, counted)) <= 2 * len(files) else []
    absent = [place for place in order if place not in places]
    if absent or not order:
        axes = " x ".join(str(len(one)) for one in counted)
        missing = ", ".join(f"{a} {n}" for (a, _), n in zip(columns, absent[0])) if absent else ""
        raise LeaflightError(
            f"{folder}: the numbers in the file names are those of {axes} slices, but there are "
            f"{len(files)}{f'; the one at {missing} is missing' if missing else ''}: add the "
            "missing ones, or keep one volume in the folder."
        )
    name = _name(files[0], [k for _, k in columns])
    return Slices(
        name,
        tuple((axis, len(one)) for (axis, _), one in zip(columns, counted)),
        tuple(places[place] for place in order),
        _gaps(name, counted[-1]),
    )


def _name(file: Path, columns: Sequence[int]) -> str:
    parts = re.split(r"(\d+)", file.name)
    for k in columns:
        parts[2 * k + 1] = "#"
    return "".join(parts)


def _gaps(name: str, numbers: Sequence[int]) -> tuple[str, ...]:
    """Returns a note about numbers that are missing in a sequence of equal steps."""
    step = gcd(*(b - a for a, b in zip(numbers, numbers[1:])))
    if step == 0 or (numbers[-1] - numbers[0]) // step >= 2 * len(numbers):
        # There is one file, or the steps are not equal.
        return ()
    present = set(numbers)
    missing = [n for n in range(numbers[0], numbers[-1], step) if n not in present]
    if not missing:
        return ()
    one, numbers_of = len(missing) == 1, listed([str(n) for n in missing])
    return (
        f"{'Slice' if one else 'Slices'} {numbers_of} of {name} {'is' if one else 'are'} missing; "
        "the slices on both sides are read as neighbors.",
    )
