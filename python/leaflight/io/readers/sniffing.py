# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the reader of a file by its content, if its name is not enough."""

import re
import zipfile
import zlib
from pathlib import Path

from ..._core import LeaflightError

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
