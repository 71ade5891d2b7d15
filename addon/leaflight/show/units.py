# SPDX-License-Identifier: GPL-3.0-or-later
"""The unit of a volume's coordinates, as a choice for people."""

from leaflight.volume.units import METERS

UNKNOWN = "UNKNOWN"
# Identifiers of Blender are ASCII.
_ITEMS = [
    ("mm", "mm", "Millimeters, as CT and MRI have"),
    ("µm", "um", "Micrometers, as microscopes have"),
    ("nm", "nm", "Nanometers"),
    ("Å", "angstrom", "Angstroms, as molecules have"),
    ("bohr", "bohr", "Atomic units"),
    ("cm", "cm", "Centimeters"),
    ("m", "m", "Meters"),
]
assert {unit for unit, _, _ in _ITEMS} == {*METERS}
ITEMS = [
    (UNKNOWN, "Not Known", "The file does not say"),
    *((key, unit, text) for unit, key, text in _ITEMS),
]
_UNITS = ["", *(unit for unit, _, _ in _ITEMS)]
_KEYS = [key for key, _, _ in ITEMS]


def unit_of(key):
    """The unit, a key of METERS or an empty text, of an item."""
    return _UNITS[_KEYS.index(key)]


def number_of(unit):
    """The number of the item of a unit."""
    return _UNITS.index(unit)


def unit_at(number):
    """The unit of the item of a number."""
    return _UNITS[number]
