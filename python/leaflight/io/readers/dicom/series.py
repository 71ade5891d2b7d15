# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds DICOM files in folders and on discs with a DICOMDIR, and the pictures of one series."""

from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from ...._core import LeaflightError
from ..checks import listed
from ..sniffing import DIRECTORY, files_within, is_dicom
from .header import Header, damaged_header, read_header
from .planes import Plane, planes_of

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


# Kinds of series in which each file with several pages is a volume, as of a beam or an organ.
_VOLUMES = {"RTDOSE", "SEG", "NM"}
# Upper bound on the file names in a note.
_MOST_NAMES = 4

Key = tuple[str, ...]


@dataclass
class Series:
    """The planes of a series, and words that describe it.

    problem: Error in one of its files, for a user who chooses the series.
    """

    number: str
    description: str
    modality: str
    date: str
    planes: list[Plane] = field(default_factory=list)
    problem: LeaflightError | None = None

    @property
    def name(self) -> str:
        words = (self.number, self.description, self.modality)
        return " ".join(filter(None, words)) or "series"


@dataclass(frozen=True)
class _Picture:
    """A file with pixels.

    key: Equal for all pictures of a series.
    alone: True if the file is a volume.
    cut: True if the file ends before its pixels.
    """

    header: Header
    key: Key
    color: bool
    alone: bool
    cut: bool


def find_series(path: Path) -> tuple[list[Series], tuple[str, ...]]:
    """Returns the series of a folder or a disc, or the one that a file belongs to; and notes.

    Raises LeaflightError if there is none.
    """
    if path.is_dir():
        files, missing = files_of(path)
        return _series_of(path, files, missing)
    header = read_header(path)
    if is_directory(header):
        files, missing = listed_by(header)
        if not files:
            raise LeaflightError(
                f"{path}: this DICOMDIR lists {missing} files, and all are missing; copy the "
                "whole disc, or open the folder with the slices."
            )
        return _series_of(path, files, missing)
    picture = _picture(header)
    if picture is None or picture.cut:
        raise LeaflightError(f"{path}: this DICOM file holds no pixels; choose another file.")
    if picture.color:
        raise LeaflightError(
            f"{path}: the pixels are colors, but a volume needs one real number per voxel; choose "
            "another series."
        )
    if picture.alone:
        return _series_of(path, [path], 0)
    beside = [file for file in sorted(path.parent.iterdir()) if file.is_file() and is_dicom(file)]
    return _series_of(path, beside if path in beside else [path, *beside], 0, picture.key)


def _series_of(
    path: Path, files: list[Path], missing: int, only: Key | None = None
) -> tuple[list[Series], tuple[str, ...]]:
    """Returns the series of these files, and notes. Raises LeaflightError.

    missing: Number of files that are missing.
    only: Key of the only series to return.
    """
    series: dict[Key, Series] = {}
    colors, cut, damaged = 0, list[str](), list[str]()
    for file in files:
        try:
            picture = _picture(read_header(file))
        except LeaflightError:
            damaged.append(file.name)
            continue
        if picture is None or only not in (None, picture.key):
            continue
        if picture.cut:
            cut.append(file.name)
            continue
        if picture.color:
            colors += 1
            continue
        one = series.setdefault(picture.key, _empty(picture.header))
        try:
            one.planes += planes_of(picture.header)
        except LeaflightError as problem:
            one.problem = one.problem or problem
    if not series and colors:
        raise LeaflightError(
            f"{path}: all {colors} DICOM pictures are colors, but a volume needs one real number "
            "per voxel; choose another folder."
        )
    if not series:
        raise LeaflightError(f"{path}: its DICOM files hold no pixels; choose another folder.")
    return list(series.values()), _notes(colors, cut + damaged * (only is None), missing)


def _notes(colors: int, damaged: list[str], missing: int) -> tuple[str, ...]:
    notes = []
    if colors:
        notes.append(f"{colors} color picture{'s are' if colors > 1 else ' is'} left out.")
    if damaged:
        names = listed(damaged, _MOST_NAMES)
        notes.append(f"These are left out, because they are damaged or hold no pixels: {names}.")
    if missing:
        files = "1 more file, which is" if missing == 1 else f"{missing} more files, which are"
        notes.append(f"The DICOMDIR lists {files} missing.")
    return tuple(notes)


def _picture(header: Header) -> _Picture | None:
    """Returns the picture of a file, None without pixels. Raises LeaflightError."""
    tags = header.tags
    if "Rows" not in tags or "Columns" not in tags:
        return None
    try:
        many = tags.get("NumberOfFrames", None) not in (None, 0, 1)
        uid = str(tags.get("SeriesInstanceUID", None) or "")
        if uid:
            volume = many and tags.get("Modality", "") in _VOLUMES
            object_uid = str(tags.get("SOPInstanceUID", "")) if volume else ""
            key: Key = (str(tags.get("StudyInstanceUID", "")), uid, object_uid)
        else:
            # Anonymized files may lack identifiers.
            names = ("SeriesNumber", "SeriesDescription", "Modality")
            key = (str(header.file.parent), *(str(tags.get(name, "")) for name in names))
        return _Picture(
            header=header,
            key=key,
            color=tags.get("SamplesPerPixel", None) not in (None, 1),
            alone=many and "ConcatenationUID" not in tags,
            cut=header.found is None,
        )
    except Exception as error:
        # pydicom raises many types of exceptions when a damaged tag is read.
        raise damaged_header(header.file) from error


def _empty(header: Header) -> Series:
    tags = header.tags
    names = ("SeriesNumber", "SeriesDescription", "Modality", "StudyDate")
    number, description, modality, date = (
        "" if tags.get(name, None) is None else str(tags.get(name)).strip() for name in names
    )
    if len(date) == 8:
        date = f"{date[:4]}-{date[4:6]}-{date[6:]}"
    return Series(number, description, modality, date)
