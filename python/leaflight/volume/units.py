# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of length, as files of volumes name them."""

# What files measure lengths in -> meters.
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
    """The key of METERS that a file's own word means, "" for any other."""
    return _WORDS.get(str(text or "").strip().lower(), "")


_WORDS = {
    "m": "m",
    "meter": "m",
    "meters": "m",
    "metre": "m",
    "cm": "cm",
    "centimeter": "cm",
    "mm": "mm",
    "millimeter": "mm",
    "millimeters": "mm",
    "millimetre": "mm",
    "µm": "µm",
    "μm": "µm",
    "um": "µm",
    "\\u00b5m": "µm",
    "micron": "µm",
    "microns": "µm",
    "micrometer": "µm",
    "micrometers": "µm",
    "micrometre": "µm",
    "nm": "nm",
    "nanometer": "nm",
    "nanometers": "nm",
    "nanometre": "nm",
    "å": "Å",
    "angstrom": "Å",
    "angstroms": "Å",
    "ångström": "Å",
    "bohr": "bohr",
}
