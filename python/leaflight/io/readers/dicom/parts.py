# SPDX-License-Identifier: GPL-3.0-or-later
"""Splits a series into volumes: segments, stacks, and planes of each size and direction.

A user chooses one of them by a name.
"""

from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...._core import LeaflightError
from ..checks import listed, text, unlike
from .planes import Plane
from .series import Series

# Upper bound on the difference of directions, and of relative spacings, of planes in a volume.
_SAME_AXES, _SAME_SPACING = 1e-3, 1e-4
# Planes beside a volume are a localizer if there are fewer than this.
_FEWEST = 3
# Upper bound on the directions and sizes of planes in a series.
_MOST_KINDS = 64
# Name of the label map of all segments.
_ALL = "all segments"
_DIRECTIONS = ("sagittal", "coronal", "axial")


@dataclass(frozen=True)
class Part:
    """Planes that make one volume.

    label: Name of the part, "" if the series has only one.
    within: All planes of the grid that segments share.
    is_map: True for the label map of all segments.
    """

    label: str
    planes: list[Plane]
    within: list[Plane]
    notes: tuple[str, ...] = ()
    is_map: bool = False


def parts_of(path: Path, series: Series) -> list[Part]:
    """Returns the volumes of a series. Raises LeaflightError if its planes make none."""
    groups = _groups(path, series.planes)
    if series.planes[0].sparse:
        parts = [Part(planes[0].label, planes, series.planes) for planes in groups]
        return _map_of(parts) + parts
    most = max(len(planes) for planes in groups)
    kept = [planes for planes in groups if len(planes) >= min(most, _FEWEST)]
    left = sum(len(planes) for planes in groups) - sum(len(planes) for planes in kept)
    notes = (_left_out(left),) if left else ()
    labels = _labels(kept) if len(kept) > 1 else [""]
    return [Part(label, planes, planes, notes) for label, planes in zip(labels, kept)]


def _map_of(parts: list[Part]) -> list[Part]:
    """Returns the label map of several segments in one grid, none if they have no numbers."""
    planes, first = parts[0].within, parts[0].planes[0]
    if len(parts) < 2 or len({part.label for part in parts}) < len(parts):
        return []
    # Segments by their share have slopes.
    if not all(one.segment > 0 and one.slope == 1 and _is_alike(first, one) for one in planes):
        return []
    return [Part(_ALL, planes, planes, is_map=True)]


def _groups(path: Path, planes: list[Plane]) -> list[list[Plane]]:
    """Returns planes of one label, size and direction each, in the order of their first planes."""
    groups: list[list[Plane]] = []
    by_label: dict[str, list[list[Plane]]] = defaultdict(list)
    for one in planes:
        alike = by_label[one.label]
        group = next((group for group in reversed(alike) if _is_alike(group[0], one)), None)
        if group is None:
            if len(alike) == _MOST_KINDS:
                raise LeaflightError(
                    f"{path}: the slices of this series have more than {_MOST_KINDS} directions "
                    "or sizes; choose another series."
                )
            group = []
            alike.append(group)
            groups.append(group)
        group.append(one)
    return groups


def _is_alike(one: Plane, other: Plane) -> bool:
    return (
        one.pixels.shape == other.pixels.shape
        and (one.position is None) == (other.position is None)
        and np.allclose(one.axes, other.axes, rtol=0, atol=_SAME_AXES)
        and np.allclose(one.spacing, other.spacing, rtol=_SAME_SPACING, atol=0)
    )


def _labels(groups: list[list[Plane]]) -> list[str]:
    """Returns unique names of volumes within a series."""
    words = [[planes[0].label, _direction(planes[0])] for planes in groups]
    sizes = [text(planes[0].pixels.shape[::-1]) for planes in groups]
    labels = [" ".join(filter(None, pair)) for pair in words]
    if len(set(labels)) < len(labels):
        labels = [f"{label} {size}" for label, size in zip(labels, sizes)]
    return unlike(labels)


def _direction(plane: Plane) -> str:
    return _DIRECTIONS[int(np.argmax(np.abs(plane.normal)))]


def _left_out(count: int) -> str:
    slices = "1 slice of another size or direction is" if count == 1 else ""
    slices = slices or f"{count} slices of other sizes or directions are"
    return f"{slices} left out, such as a localizer."


# Upper bound on the series names in a note.
_MOST_NAMES = 4


@dataclass(frozen=True)
class Choice:
    """A volume of a series, with words that select it.

    found: The volume, or the error, which only concerns a user who chooses it.
    """

    series: str
    found: Part | LeaflightError
    words: frozenset[str]

    def part(self, path: Path) -> Part:
        """Returns the volume. Raises LeaflightError."""
        if isinstance(self.found, LeaflightError):
            raise self.found
        return self.found

    @property
    def is_map(self) -> bool:
        return isinstance(self.found, Part) and self.found.is_map

    @property
    def is_slice(self) -> bool:
        return isinstance(self.found, Part) and len(self.found.within) == 1


def choices_of(path: Path, found: list[Series]) -> tuple[dict[str, Choice], tuple[str, ...]]:
    """Returns {name: volume} of the series, and notes about omitted ones.

    Raises LeaflightError if there is none.
    """
    choices: dict[str, Choice] = {}
    for series, name in zip(found, _names(found)):
        words = {series.number, series.description, f"{series.number} {series.description}"}
        for label, part in _parts(path, series):
            both = label or name if len(found) == 1 or not label else f"{name}: {label}"
            choices[both] = Choice(name, part, frozenset(filter(None, {*words, label, name})))
    slices = dict.fromkeys(one.series for one in choices.values() if one.is_slice)
    kept = {name: choice for name, choice in choices.items() if not choice.is_slice}
    if not slices or len(choices) == 1:
        return choices, ()
    if not kept:
        raise LeaflightError(
            f"{path}: all {len(choices)} series in it are single slices; choose a folder with a "
            "series of several slices."
        )
    names = listed(list(slices), _MOST_NAMES)
    return kept, (f"These are left out, because each is a single slice: {names}.",)


def meant(choices: dict[str, Choice], word: str | None) -> str | None:
    """Returns the name of the only choice with this word, else the word. None fits all choices.

    The label map of a series stands for all of its segments.
    """
    if word in choices:
        return word
    names = [name for name, choice in choices.items() if word is None or word in choice.words]
    if len(names) == 1:
        return names[0]
    is_one = len({choices[name].series for name in names}) == 1
    return names[0] if is_one and choices[names[0]].is_map else word


def _parts(path: Path, series: Series) -> list[tuple[str, Part | LeaflightError]]:
    """Returns (label, volume) of each part of a series."""
    if series.problem is not None:
        return [("", series.problem)]
    try:
        return [(part.label, part) for part in parts_of(path, series)]
    except LeaflightError as problem:
        return [("", problem)]


def _names(found: list[Series]) -> list[str]:
    """Returns unique names of series, including those of several studies."""
    counts = Counter(series.name for series in found)
    dated = [
        f"{one.name} ({one.date})" if counts[one.name] > 1 and one.date else one.name
        for one in found
    ]
    return unlike(dated)
