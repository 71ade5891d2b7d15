# SPDX-License-Identifier: GPL-3.0-or-later
"""The volumes that a user can choose from, with names."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from ...._core import LeaflightError
from ..checks import listed, unlike
from .parts import Part, parts_of
from .series import Series

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
