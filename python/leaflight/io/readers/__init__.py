# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes from files: read_volume() chooses the reader by the suffix, probe() reads the header."""

from ...volume.units import METERS
from .formats import FORMATS, RAW, SUFFIXES, format_of, name_patterns
from .missing_package import MissingPackage
from .reading import probe, read_volume
from .stored import StoredVolume

__all__ = [
    "FORMATS",
    "METERS",
    "RAW",
    "SUFFIXES",
    "MissingPackage",
    "StoredVolume",
    "format_of",
    "name_patterns",
    "probe",
    "read_volume",
]
