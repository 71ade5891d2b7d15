# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads millions of numbers from text, as C, Fortran and Python write them."""

import io
import re
from collections.abc import Sequence
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from ..._core import Progress
from ...arrays import Array
from ...volume.memory import new_voxels
from .checks import DEFLATE_MOST, truncated
from .watched import is_packed, open_watched

# Bytes of text that are converted at once.
_PIECE = 1 << 20
# Upper bound on the characters of a line without spaces.
_LONGEST = 1 << 16
# Least number of characters of a number, with the space before it.
_SHORTEST = 2

# Fortran writes 0.5D+01, and omits the letter before three digits: 0.5-100.
_WITHOUT_LETTER = re.compile(rb"(\d\.\d*|\.\d+)([-+]\d{3})(?![\d.])")
_NUMBER = rb"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?"
_ONE = re.compile(rb"\s*[-+]?" + _NUMBER + rb"\s*")
# Numbers that fill their columns touch. A sign shows the start of the next one.
_GLUED = re.compile(rb"[-+]?" + _NUMBER + rb"(?:[-+]" + _NUMBER + rb")*")
_SIGNED = re.compile(rb"[-+]?" + _NUMBER)


def read_numbers(
    file: io.BufferedIOBase,
    count: int,
    dtype: DTypeLike,
    progress: Progress,
    width: int | None = None,
) -> Array:
    """Reads the array of the next `count` numbers in a text file.

    width: Width of a column, if the format has one.
    Raises EOFError if the file ends before, and ValueError for other text.
    """
    values = new_voxels((count,), dtype)
    filled, rest = 0, b""
    while filled < count:
        progress.check()
        piece = file.read(_PIECE)
        text = rest + piece
        # The last line, or the last number of a long line, may continue in the next piece.
        end = _end(text) if piece else len(text)
        text, rest = text[:end], text[end:]
        if len(rest) > _LONGEST or (not piece and not text):
            raise EOFError
        numbers = _parsed(text, count - filled, width)
        _check_range(numbers, values.dtype)
        values[filled : filled + len(numbers)] = numbers
        filled += len(numbers)
    return values


def numbers_at(
    path: Path,
    start: int,
    shape: Sequence[int],
    dtype: DTypeLike,
    progress: Progress,
    width: int | None = None,
) -> Array:
    """Returns the array of this shape from byte `start` of a file on. Raises as read_numbers()."""
    with open_watched(path, progress) as file:
        file.seek(start)
        return read_numbers(file, prod(shape), dtype, progress, width).reshape(shape)


def numbers_of(line: str | bytes) -> list[float]:
    """Returns all numbers of a line. Raises ValueError for anything else."""
    text = line if isinstance(line, bytes) else line.encode("latin-1", "replace")
    return [float(number) for number in _parsed(text, len(text), None)]


def check_count(path: Path, shape: Sequence[int], packed: bool | None = None) -> None:
    """Raises LeaflightError if a text file is too short for these numbers."""
    packed = is_packed(path) if packed is None else packed
    claimed = np.prod([float(n) for n in shape]) * _SHORTEST
    if claimed > (path.stat().st_size + 1) * (DEFLATE_MOST if packed else 1):
        raise truncated(path, shape)


def _end(text: bytes) -> int:
    """Returns the end of the last complete line of a text; of a long line, the last number."""
    line = text.rfind(b"\n", max(0, len(text) - _LONGEST))
    if line < 0 and len(text) > _LONGEST:
        line = max(map(text.rfind, (b" ", b"\t", b"\r", b"\n")))
    return line + 1


def _parsed(text: bytes, most: int, width: int | None) -> Array:
    """Returns the first `most` numbers of a text."""
    words = text.split(None, most)[:most]
    try:
        return np.fromiter(map(float, words), np.float64, len(words))
    except ValueError:
        pass
    text = _WITHOUT_LETTER.sub(rb"\1E\2", text.replace(b"D", b"E").replace(b"d", b"e"))
    words = text.split(None, most)[:most]
    try:
        return np.fromiter(map(float, words), np.float64, len(words))
    except ValueError:
        pass
    numbers: list[float] = []
    for line in text.splitlines():
        if len(numbers) >= most:
            break
        numbers += _of_line(line, most - len(numbers), width)
    return np.array(numbers[:most], np.float64)


def _of_line(line: bytes, most: int, width: int | None) -> list[float]:
    """Returns the numbers of a line. Some may touch."""
    words = line.split(None, most)[:most]
    try:
        return [float(word) for word in words]
    except ValueError:
        pass
    columns = [line[at : at + width] for at in range(0, len(line), width)] if width else []
    if columns and all(map(_ONE.fullmatch, columns)):
        return [float(column) for column in columns]
    numbers: list[float] = []
    for word in words:
        if _GLUED.fullmatch(word):
            numbers += map(float, _SIGNED.findall(word))
        else:
            numbers.append(float(word))
    return numbers


def _check_range(numbers: Array, dtype: np.dtype[Any]) -> None:
    """Raises ValueError for numbers outside the range of an integer type."""
    if dtype.kind in "iu" and len(numbers):
        limits = np.iinfo(dtype)
        finite = np.isfinite(numbers).all()
        if not (finite and limits.min <= int(numbers.min()) and int(numbers.max()) <= limits.max):
            raise ValueError("a number that its type does not hold")
