# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of length, as files of volumes name them."""

import re
from collections.abc import Sequence

# Units of length in files -> meters.
METERS = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "µm": 1e-6,
    "nm": 1e-9,
    "Å": 1e-10,
    "bohr": 5.29177210903e-11,
}


def unit_of(text: object) -> str:
    """Returns the key of METERS for a file's own word, "" for any other."""
    length = meters_of(text)
    return next((key for key, meters in METERS.items() if meters == length), "")


def meters_of(text: object) -> float | None:
    """Returns the length of a file's own word for a unit in meters; None for other words."""
    word = str(text or "").strip().lower()
    for spelling, sign in _SIGNS.items():
        word = word.replace(spelling, sign)
    if word in _WORDS:
        return _WORDS[word]
    found = _LONG.fullmatch(word) or _SHORT.fullmatch(word)
    return _PREFIXES[found[1] or ""] if found else None


def common_unit(texts: Sequence[object]) -> tuple[str, tuple[float, ...]] | None:
    """Returns (unit, factors): one key of METERS for the axes x, y, z, and factors from their
        units.

    texts: The file's words; "" takes the unit of the other axes.
    The unit is that of the first axis with a known one, or the next smaller. If all axes have the
    same unknown word it is "". Returns None if lengths along the axes cannot be compared.
    """
    words = [str(text or "").strip() for text in texts]
    lengths = [meters_of(word) for word in words]
    first = next((length for length in lengths if length), None)
    if first is None:
        return ("", (1.0,) * len(words)) if len(set(words)) == 1 else None
    if any(word and not length for word, length in zip(words, lengths)):
        return None
    smaller = [key for key in _DECIMAL if METERS[key] <= first]
    unit = unit_of(texts[lengths.index(first)]) or (smaller[0] if smaller else _DECIMAL[-1])
    return unit, tuple((length or first) / METERS[unit] for length in lengths)


_DECIMAL = ("m", "cm", "mm", "µm", "nm", "Å")
# Spellings of the micro sign: the Greek letter, escaped, and decoded by the wrong table.
_SIGNS = {"μ": "µ", "\\u00b5": "µ", "âµ": "µ", "î¼": "µ"}
_PREFIXES = {
    "": 1.0,
    "tera": 1e12,
    "giga": 1e9,
    "mega": 1e6,
    "kilo": 1e3,
    "k": 1e3,
    "hecto": 1e2,
    "deci": 1e-1,
    "d": 1e-1,
    "centi": 1e-2,
    "c": 1e-2,
    "milli": 1e-3,
    "m": 1e-3,
    "micro": 1e-6,
    "u": 1e-6,
    "µ": 1e-6,
    "nano": 1e-9,
    "n": 1e-9,
    "pico": 1e-12,
    "p": 1e-12,
    "femto": 1e-15,
    "f": 1e-15,
}
_LONG = re.compile(f"({'|'.join(p for p in _PREFIXES if len(p) != 1)})[ -]?met(?:er|re)s?")
_SHORT = re.compile(f"([{''.join(p for p in _PREFIXES if len(p) == 1)}]?)m")
_WORDS = {
    "micron": 1e-6,
    "microns": 1e-6,
    "µ": 1e-6,
    "å": 1e-10,
    "a": 1e-10,
    "ang": 1e-10,
    "angstrom": 1e-10,
    "angstroms": 1e-10,
    "ångström": 1e-10,
    "ångstrom": 1e-10,
    "bohr": METERS["bohr"],
    "in": 0.0254,
    "inch": 0.0254,
    "inches": 0.0254,
    "foot": 0.3048,
    "feet": 0.3048,
    "ft": 0.3048,
    "yard": 0.9144,
    "mile": 1609.344,
}
