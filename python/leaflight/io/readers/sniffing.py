# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the reader of a file by its content, if its name is not enough.

DICOM files are recognized by their first bytes, without pydicom. Their names do not matter.
"""

import os
import re
import zipfile
import zlib
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from struct import unpack

from ..._core import LeaflightError
from ...paths import AnyPath

# Number of first bytes that are examined, also after decompression.
_LOOKED_AT = 1 << 16

# (module of the reader, offset of the bytes, the bytes) of binary formats.
_SIGNATURES = (
    ("dicom", 128, b"DICM"),
    ("nifti", 344, b"n+1\0"),
    ("nifti", 4, b"n+2\0\r\n\x1a\n"),
    ("hdf5", 0, b"\x89HDF\r\n\x1a\n"),
    ("hdf5", 512, b"\x89HDF\r\n\x1a\n"),
    ("mrc", 208, b"MAP "),
    ("tiff", 0, b"II*\0"),
    ("tiff", 0, b"MM\0*"),
    ("tiff", 0, b"II+\0"),
    ("tiff", 0, b"MM\0+"),
    ("czi", 0, b"ZISRAWFILE"),
    ("nd2_file", 0, b"\xda\xce\xbe\x0a"),
    ("vdb", 0, b" BDV\0\0\0\0"),
    ("numpy_file", 0, b"\x93NUMPY"),
    ("mtz", 0, b"MTZ "),
    ("dsn6", 0, b":-)"),
    ("amira", 0, b"# AmiraMesh"),
    ("amira", 0, b"# Avizo"),
    ("mrtrix", 0, b"mrtrix image"),
)
_DIGITS = rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?"
_THREE = 3 * (rb"[ \t]+" + _DIGITS)
_LINE = rb"[^\n]{0,999}\n"
# One whole number and three numbers, as in the header of a cube, and in tables.
_FOUR = rb"[ \t]*[-+]?\d+" + _THREE + rb"(?:[ \t]+\d+)?\s*\n"
_VECTOR = rb"[ \t]*" + _DIGITS + 2 * (rb"[ \t]+" + _DIGITS) + rb"\s*\n"
# (module, pattern) of text formats.
_TEXTS = (
    ("nrrd", rb"\ANRRD000\d"),
    ("vtk_legacy", rb"\A# vtk DataFile"),
    ("vti", rb"\A\s*(?:<\?xml[^>]{0,999}>\s*)?(?:<!--[^>]{0,9999}>\s*)?<VTKFile\b"),
    ("ply_points", rb"\Aply\r?\n"),
    ("metaimage", rb"\A\s*(?:ObjectType|NDims)[ \t]*="),
    ("opendx", rb"\A(?:\s*#" + _LINE + rb")*\s*object[ \t]+\S+[ \t]+class[ \t]+gridpositions"),
    ("xsf", rb"^[ \t]*BEGIN_BLOCK_DATAGRID_?3D"),
    # Gaussian cube: two lines of text, the number of atoms and the origin, and three axes.
    ("cube", rb"\A(?!" + _FOUR + rb")" + 2 * _LINE + rb"(?:" + _FOUR + rb"){4}"),
    # VASP: a line of text, a scale, and three vectors.
    ("vasp", rb"\A" + _LINE + rb"\s*" + _DIGITS + rb"\s*\n" + 3 * _VECTOR),
)


# Readers that also read files compressed by gzip.
_UNPACKING = {"nifti", "mrc", "mrtrix", "opendx", "xsf", "cube", "vasp", "dsn6"}


def module_of(path: Path) -> str | None:
    """Returns the module of the reader for a file's content, None if it is unknown.

    Raises LeaflightError for a compressed file whose reader does not decompress it.
    """
    try:
        with open(path, "rb") as file:
            head = file.read(_LOOKED_AT)
        if head.startswith(b"PK\x03\x04"):
            return "numpy_file" if _is_npz(path) else None
        packed = head.startswith(b"\x1f\x8b")
        if packed:
            head = zlib.decompressobj(31).decompress(head, _LOOKED_AT)
    except (OSError, zlib.error):
        return None
    module = _module_of(head)
    if packed and module and module not in _UNPACKING:
        raise LeaflightError(
            f"{path}: the file is compressed by gzip; decompress it first, for example with gunzip."
        )
    return module


def _module_of(head: bytes) -> str | None:
    """Returns the module of the reader for these first bytes."""
    for module, place, signature in _SIGNATURES:
        if head[place : place + len(signature)] == signature:
            return module
    found = (module for module, text in _TEXTS if re.search(text, head, re.MULTILINE))
    return next(found, None)


def _is_npz(path: Path) -> bool:
    """Returns True if an archive holds only NumPy arrays."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except zipfile.BadZipFile:
        return False
    return bool(names) and all(name.endswith(".npy") for name in names)


# Numbers of files that are opened to detect a series: in a folder, and in the folders within it.
_LOOKED_AT_IN_FOLDER, _LOOKED_AT_WITHIN = 100, 300
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
    if any(is_dicom(entry) for entry in entries[:_LOOKED_AT_IN_FOLDER]):
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
