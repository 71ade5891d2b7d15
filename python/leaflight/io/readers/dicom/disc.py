# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the DICOM files of a folder, of folders within it, and of a disc with a DICOMDIR."""

from pathlib import Path, PurePosixPath
from typing import Any

from ...._core import LeaflightError
from ..dicom_signature import DIRECTORY, files_within, is_dicom
from .header import Header, read_header

# Upper bound on the files in folders of a folder. Reading more headers would take too long.
MOST_FILES = 20_000
_DIRECTORY_STORAGE = "1.2.840.10008.1.3.10"
# Types of records of a DICOMDIR with pixels.
_PICTURES = {"IMAGE", "RT DOSE"}


def files_of(folder: Path) -> tuple[list[Path], int]:
    """Returns the DICOM files of a folder, and how many more a DICOMDIR lists.

    Folders within it are searched on a disc, or if the folder itself has no DICOM files. Raises
    LeaflightError.
    """
    entries = [entry for entry in sorted(folder.iterdir()) if entry.is_file()]
    directory = next((entry for entry in entries if entry.name.lower() == DIRECTORY), None)
    files = [entry for entry in entries if entry != directory and is_dicom(entry)]
    if files and directory is None:
        return files, 0
    files = [file for file in _within(folder) if file != directory and is_dicom(file)]
    return files, 0 if directory is None else listed_by(read_header(directory))[1]


def is_directory(header: Header) -> bool:
    """Returns True if a file is a DICOMDIR, by any name."""
    return str(header.tags.file_meta.get("MediaStorageSOPClassUID", "")) == _DIRECTORY_STORAGE


def listed_by(directory: Header) -> tuple[list[Path], int]:
    """Returns the files that a DICOMDIR lists, and how many of them are missing.

    Names on copied discs may be in upper or lower case, or have a version number as in ISO 9660.
    """
    folder = directory.file.parent
    here = {_plain(file.relative_to(folder).parts): file for file in _within(folder)}
    files, missing = [], 0
    for record in directory.tags.get("DirectoryRecordSequence", None) or []:
        name = record.get("ReferencedFileID", None)
        if not name or record.get("DirectoryRecordType", "") not in _PICTURES:
            continue
        file = here.get(_plain([name] if isinstance(name, str) else name))
        missing += file is None
        files += [file] if file is not None else []
    return files, missing


def _within(folder: Path) -> list[Path]:
    files: list[Path] = []
    for file in files_within(folder):
        files.append(file)
        if len(files) > MOST_FILES:
            raise LeaflightError(
                f"{folder}: its folders hold more than {MOST_FILES} files; choose the folder of "
                "one series."
            )
    return files


def _plain(parts: Any) -> str:
    name = str(PurePosixPath(*(str(part) for part in parts))).replace("\\", "/").lower()
    return name.partition(";")[0].rstrip(".")
