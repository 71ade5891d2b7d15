# SPDX-License-Identifier: GPL-3.0-or-later
"""Recognizes DICOM files by their first bytes, without pydicom. Their names do not matter."""

import os
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from struct import unpack

from ...paths import AnyPath

# Numbers of files that are opened to detect a series: in a folder, and in the folders within it.
_LOOKED_AT, _LOOKED_AT_WITHIN = 100, 300
# Upper bound on the depth of folders on a disc.
_DEEPEST = 8
# Name of the list of a disc's files, by the standard.
DIRECTORY = "dicomdir"
# Value types of the first elements of a file.
_FIRST_TYPES = {b"UL", b"UI", b"CS", b"SH", b"DA", b"TM", b"DT", b"OB", b"LO", b"US"}
_LAST_OF_FIRST, _LONGEST = 0x18, 512


def is_dicom(path: AnyPath) -> bool:
    """Returns True if a file begins as DICOM, with or without the standard's preamble."""
    try:
        with open(path, "rb") as file:
            start = file.read(132)
    except OSError:
        return False
    return start[128:] == b"DICM" or _is_first_element(start)


def holds_dicom(folder: Path) -> bool:
    """Returns True if a folder holds DICOM files, or is a disc or a tree of such folders."""
    entries = [entry for entry in folder.iterdir() if entry.is_file()]
    if any(entry.name.lower() == DIRECTORY for entry in entries):
        return True
    if any(is_dicom(entry) for entry in entries[:_LOOKED_AT]):
        return True
    return any(is_dicom(file) for file in islice(files_within(folder), _LOOKED_AT_WITHIN))


def files_within(folder: Path) -> Iterator[Path]:
    """Returns the files of a folder and of folders within it, sorted by name, without hidden ones.

    Links to folders are not followed, because they may form loops.
    """
    for place, folders, files in os.walk(folder):
        depth = len(Path(place).relative_to(folder).parts)
        folders[:] = sorted(name for name in folders if name[0] != "." and depth < _DEEPEST)
        found = (Path(place, name) for name in sorted(files) if name[0] != ".")
        # Skip pipes, because reading one may never end.
        yield from (file for file in found if file.is_file())


def _is_first_element(start: bytes) -> bool:
    """Returns True if a data set begins here: with the element that identifies the file."""
    if len(start) < 16:
        return False
    for order in "<>":
        group, element = unpack(f"{order}HH", start[:4])
        if group in (2, 8) and element <= _LAST_OF_FIRST:
            return start[4:6] in _FIRST_TYPES or (order == "<" and _is_value(element, start[4:]))
    return False


def _is_value(element: int, start: bytes) -> bool:
    """Returns True if these are the length and the first bytes of a value without its type."""
    (length,) = unpack("<I", start[:4])
    if element == 0:
        return bool(length == 4)
    begin = start[4 : 4 + min(length, 16)].rstrip(b"\0")
    return length % 2 == 0 and 0 < length <= _LONGEST and begin.isascii() and bool(begin.strip())
