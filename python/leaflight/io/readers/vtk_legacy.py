# SPDX-License-Identifier: GPL-3.0-or-later
"""Structured points in legacy .vtk files, text or binary.

https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html
"""

import io
import mmap
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import prod
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from .checks import check_size, truncated
from .encodings import NUMBERS
from .stored import StoredVolume
from .text_numbers import check_count, numbers_of, read_numbers
from .vtk_image import Image, ImageArray, matrix_of, open_image
from .watched import STAGE, begin

# A vtkIdType is written as an int.
_TYPES = NUMBERS | {"vtktypeint64": "i8", "vtktypeuint64": "u8", "vtkidtype": "i4"}
_TYPES |= {"long": "i8", "unsigned long": "u8"}
# Attribute with a type -> number of values of each point or cell; 0 if the line has it.
_ATTRIBUTES = {
    "SCALARS": 0,
    "VECTORS": 3,
    "NORMALS": 3,
    "TENSORS": 9,
    "TENSORS6": 6,
    "TEXTURE_COORDINATES": 0,
    "GLOBAL_IDS": 1,
    "PEDIGREE_IDS": 1,
}
_MOST_LINE = 1 << 12
_MAGIC = b"# vtk DataFile"
# A line that is not a number, nan or inf: a keyword, or an array of a field.
_WORD = re.compile(
    rb"\n[ \t]*(?:(?!nan|inf)[a-z_]|\S+[ \t]+\d+[ \t]+\d+[ \t]+[a-z])", re.IGNORECASE
)
_SECTION = re.compile(rb"\n[ \t]*(?:POINT_DATA|CELL_DATA|DIMENSIONS)[ \t]+\d", re.IGNORECASE)
_EMPTY_LINE = re.compile(rb"\n[ \t\r]*\n")


@dataclass
class _File:
    """A partly read file.

    place: Start of the next line.
    of_cells, count: Kind and number of the points or cells of the attributes that follow.
    """

    path: Path
    data: mmap.mmap
    binary: bool = False
    place: int = 0
    of_cells: bool = False
    count: int = 0
    header: dict[str, list[float]] = field(default_factory=dict)
    arrays: list[ImageArray] = field(default_factory=list)

    def line(self) -> list[str] | None:
        """Reads the words of the next line that is not empty, None at the end."""
        while self.place < len(self.data):
            end = self.data.find(b"\n", self.place)
            end = len(self.data) if end < 0 else end
            words = self.data[self.place : min(end, self.place + _MOST_LINE)].split()
            self.place = end + 1
            if words:
                return [word.decode("latin-1") for word in words]
        return None

    def go_to(self, pattern: re.Pattern[bytes]) -> None:
        """Skips to the next line that matches, or to the end."""
        found = pattern.search(self.data, max(0, self.place - 1))
        self.place = found.start() + 1 if found else len(self.data)


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """Opens an image. Its arrays are datasets; components of vectors and colors are channels."""
    with open(path, "rb") as opened:
        data = mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ)
    file = _File(path, data)
    # The first two lines are the version and a title, which may be empty.
    file.place = data.find(b"\n", data.find(b"\n") + 1) + 1
    form = " ".join(file.line() or ()).upper()
    if not data[: len(_MAGIC)] == _MAGIC or form not in ("ASCII", "BINARY"):
        raise ValueError("the first lines")
    file.binary = form == "BINARY"
    _check_kind(file)
    while (words := file.line()) is not None:
        if not _read(file, words):
            # The length of this type is unknown, so skip the rest of these points or cells.
            file.go_to(_SECTION)
    points = tuple(int(n) for n in file.header["DIMENSIONS"])
    spacing = file.header.get("SPACING") or file.header.get("ASPECT_RATIO") or [1.0] * 3
    matrix = matrix_of(file.header.get("ORIGIN", [0.0] * 3), spacing, np.eye(3), [0, 0, 0])
    return open_image(Image(path, points, matrix, file.arrays), dataset)


def _check_kind(file: _File) -> None:
    words = file.line() or []
    kind = words[1].upper() if len(words) > 1 and words[0].upper() == "DATASET" else "no"
    if kind != "STRUCTURED_POINTS":
        named = kind[:40].lower().replace("_", " ")
        raise LeaflightError(
            f"{file.path}: the file holds {named} data, but a volume needs structured points; "
            "apply Resample To Image in ParaView, and save as .vti."
        )


def _read(file: _File, words: list[str]) -> bool:
    """Reads the section of a line. Returns False if its length is unknown."""
    key = words[0].upper()
    if key in ("DIMENSIONS", "ORIGIN", "SPACING", "ASPECT_RATIO"):
        numbers = numbers_of(" ".join(words[1:4]))
        if len(numbers) != 3:
            raise ValueError(key)
        file.header[key] = numbers
    elif key in ("POINT_DATA", "CELL_DATA"):
        file.of_cells, file.count = key == "CELL_DATA", int(words[1])
    elif key == "FIELD":
        return all(_read_of_field(file) for _ in range(_count(file, words[2])))
    elif key == "METADATA":
        # Skip the text up to an empty line.
        file.go_to(_EMPTY_LINE)
    elif key == "LOOKUP_TABLE":
        _skip(file, np.dtype(np.uint8 if file.binary else np.float32), 4 * int(words[2]))
    elif key == "COLOR_SCALARS":
        dtype = np.dtype(np.uint8 if file.binary else np.float32)
        _add(file, key, words[1], dtype, int(words[2]), file.count)
    elif key in _ATTRIBUTES:
        return _read_attribute(file, key, words)
    else:
        return False
    return True


def _read_attribute(file: _File, key: str, words: list[str]) -> bool:
    numbers = [int(word) for word in words[2:] if word.isdecimal()]
    kind = words[3] if key == "TEXTURE_COORDINATES" else words[2]
    channels = _ATTRIBUTES[key] or (numbers[0] if numbers else 1)
    if key == "SCALARS":
        before = file.place
        following = file.line()
        # Skip the name of a color table.
        if not following or following[0].upper() != "LOOKUP_TABLE":
            file.place = before
    return _add_typed(file, key, words[1], kind, channels, file.count)


def _read_of_field(file: _File) -> bool:
    """Reads one array of a field: name, number of components, number of tuples, type."""
    words = file.line()
    while words and words[0] == "METADATA":
        _read(file, words)
        words = file.line()
    if not words:
        return False
    return _add_typed(file, "FIELD", words[0], words[3], int(words[1]), int(words[2]))


def _add_typed(file: _File, key: str, name: str, kind: str, channels: int, count: int) -> bool:
    """Adds the array that begins here. Returns False for an unknown type."""
    type_of = _TYPES.get(kind.lower().replace("_", " "))
    if type_of is not None:
        dtype = np.dtype((">" if file.binary else "=") + type_of)
        _add(file, key, name, dtype, channels, count)
    return type_of is not None


def _add(file: _File, key: str, name: str, dtype: np.dtype[Any], channels: int, count: int) -> None:
    """Adds the array that begins here, if it belongs to the image, and skips it."""
    start = file.place
    _skip(file, dtype, channels * count)
    points = [int(n) for n in file.header.get("DIMENSIONS", (0, 0, 0))]
    expected = prod(max(1, n - 1) for n in points) if file.of_cells else prod(points)
    if not file.count or count != expected or channels < 1:
        return

    # In text files colors are shares of 255.
    is_color = key == "COLOR_SCALARS" and not file.binary
    end = file.place

    def read(
        channel: int, dims: tuple[int, ...], progress: Progress
    ) -> tuple[Array, Sequence[str]]:
        begin(progress, STAGE, 1)
        # Read instead of mapping the file, because it might change.
        content, shape = file.data[start:end], (*dims[::-1], channels)
        if file.binary:
            return np.frombuffer(content, dtype, prod(shape)).reshape(shape)[..., channel], ()
        numbers = read_numbers(io.BytesIO(content), prod(shape), dtype, progress)
        values = numbers.reshape(shape)[..., channel]
        return (values * 255).round().clip(0, 255).astype(np.uint8) if is_color else values, ()

    kept = np.dtype(np.uint8) if is_color else dtype
    file.arrays.append(ImageArray(unquote(name), file.of_cells, kept, channels, read))


def _skip(file: _File, dtype: np.dtype[Any], count: int) -> None:
    """Skips `count` values. Raises LeaflightError if the file ends before."""
    if count < 0:
        raise ValueError("the number of values")
    if file.binary:
        check_size(file.path, (count,), dtype.itemsize, len(file.data) - file.place)
        file.place += count * dtype.itemsize
        return
    check_count(file.path, (count,), packed=False)
    file.go_to(_WORD)


def _count(file: _File, word: str) -> int:
    """Returns the number of arrays that a field claims."""
    count = int(word)
    if count > len(file.data):
        raise truncated(file.path, (count,))
    return count
