# SPDX-License-Identifier: GPL-3.0-or-later
"""Values whose position a header gives: behind it, in another file, or in several files.

Several files are a list in the header, or a pattern with a number.
"""

import io
from collections.abc import Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.memory import bytes_of, new_voxels
from .checks import check_size, truncated
from .encodings import ENCODINGS
from .watched import open_watched, read_into, read_values, watched

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer
import re

from .checks import data_file, text

# Index along each axis, slowest first; a slice for all of them.
Index = tuple[int | slice, ...]
# Bytes that are skipped at once, and upper bound on the bytes before values at the end of a file.
_PIECE, _MOST_BEFORE = 1 << 20, 1 << 30


@dataclass(frozen=True)
class ValueFiles:
    """The positions of the values of an array, x fastest.

    files: Files in the order of the values, with equal shares.
    encoding: A key of ENCODINGS.
    start: First byte of each file that is used.
    lines: Text lines to skip after it.
    skip: Bytes to skip after decompression. -1 means that the values are the end of the file, -2
        that one byte follows them, and so on.
    """

    files: tuple[Path, ...]
    encoding: str = "raw"
    start: int = 0
    lines: int = 0
    skip: int = 0

    def check(self, shape: Sequence[int], dtype: np.dtype[Any]) -> None:
        """Raises LeaflightError if the files cannot hold an array of this shape, slowest first."""
        encoding = ENCODINGS[self.encoding]
        if self.skip < 0 and self.encoding in ("text", "hex"):
            raise LeaflightError(
                f"{self.files[0]}: values in {self.encoding} cannot be located from the end of "
                "the file; give the number of bytes before them."
            )
        shape = shape[::-1] if len(self.files) == 1 else (prod(shape) // len(self.files),)
        size = prod(shape) * dtype.itemsize
        for file in self.files:
            behind = 0 if encoding.packed else max(0, -self.skip - 1)
            stored = file.stat().st_size - self._begin(file, size) - behind
            # The last number of a text needs no separator.
            stored = max(0, stored) + (self.encoding == "text")
            check_size(file, shape, encoding.least(dtype), stored, encoding.most)

    def surplus(self, size: int) -> int:
        """Returns the number of bytes in a file beyond `size`, 0 where that is not known."""
        if self.encoding not in ("raw", "gzip") or len(self.files) != 1 or self.skip < 0:
            return 0
        file = self.files[0]
        length = file.stat().st_size
        if self.encoding == "raw":
            return max(0, length - self._begin(file, size) - size)
        # A gzip file ends with the length of its data, which is exact below 4 GiB.
        with open(file, "rb") as opened:
            opened.seek(max(0, length - 4))
            unpacked = int.from_bytes(opened.read(4), "little") - self.skip
        return unpacked - size if size < unpacked <= size + _MOST_BEFORE else 0

    def holds(self, size: int) -> bool:
        """Returns True if exactly `size` bytes remain in a single raw file."""
        if self.encoding != "raw" or len(self.files) != 1 or self.skip < 0:
            return False
        return self.files[0].stat().st_size - self._begin(self.files[0], size) == size

    def read(
        self, shape: Sequence[int], dtype: np.dtype[Any], index: Index, progress: Progress
    ) -> Array:
        """Reads the part `index` of the array of this shape, [z, y, x]; both are slowest first.

        Raises LeaflightError if the files end before.
        """
        size = prod(shape) * dtype.itemsize
        if self.encoding == "raw" and len(self.files) == 1:
            begin = self._begin(self.files[0], size)
            return np.memmap(self.files[0], dtype, "r", begin, tuple(shape))[index]
        try:
            with closing(self._pieces(size // len(self.files), dtype, progress)) as pieces:
                return picked(_Stream(pieces), shape, dtype, index)
        except (EOFError, OverflowError, ValueError):
            raise truncated(self.files[0], reversed(shape)) from None

    def _begin(self, file: Path, size: int) -> int:
        """Returns the first byte of the values in a file, raw or compressed."""
        length = file.stat().st_size
        with open(file, "rb") as opened:
            begin = opened.seek(self.start)
            for _ in range(self.lines):
                # Lines may have any length, so do not hold them in memory.
                while (part := opened.readline(_PIECE)) and not part.endswith(b"\n"):
                    pass
                if not part:
                    break
                begin = opened.tell()
        if ENCODINGS[self.encoding].packed:
            return begin
        return begin + self.skip if self.skip >= 0 else max(begin, length - size + self.skip + 1)

    def _pieces(
        self, size: int, dtype: np.dtype[Any], progress: Progress
    ) -> Generator[memoryview, None, None]:
        """Yields `size` bytes of each file. Raises EOFError if one ends before."""
        if len(self.files) == 1:
            with open_watched(self.files[0], progress, unpacked=False) as opened:
                yield from self._part(opened, self.files[0], size, dtype, progress)
            return
        for file in watched(progress, self.files):
            with open(file, "rb") as opened:
                yield from self._part(opened, file, size, dtype, progress)

    def _part(
        self,
        opened: io.BufferedIOBase,
        file: Path,
        size: int,
        dtype: np.dtype[Any],
        progress: Progress,
    ) -> Iterator[memoryview]:
        encoding, begin = ENCODINGS[self.encoding], self._begin(file, size)
        opened.seek(begin)
        skip = max(0, self.skip) if encoding.packed else 0
        if encoding.packed and self.skip < 0:
            length, most = 0, size + _MOST_BEFORE
            for piece in encoding.pieces(opened, dtype, most):
                length += len(piece)
                progress.check()
            if length >= most:
                raise LeaflightError(
                    f"{file}: more than {_MOST_BEFORE} bytes precede the values; decompress the "
                    "file."
                )
            skip = length - size + self.skip + 1
            opened.seek(begin)
        if skip < 0:
            raise EOFError
        left = skip + size
        for piece in encoding.pieces(opened, dtype, left):
            progress.check()
            wanted = memoryview(piece)[:left]
            left -= len(wanted)
            # Keep the last `size` bytes.
            if left < size:
                yield wanted[max(0, len(wanted) - (size - left)) :]
            if not left:
                return
        raise EOFError


def picked(
    file: io.RawIOBase | io.BufferedIOBase, shape: Sequence[int], dtype: np.dtype[Any], index: Index
) -> Array:
    """Reads the part `index` of the next array of this shape in a file.

    Holds at most one plane of it in memory in addition to the result. Raises EOFError if the file
    ends.
    """
    first = next(axis for axis, place in enumerate(index) if isinstance(place, slice))
    before = 0
    for size, place in zip(shape[:first], index):
        assert isinstance(place, int)
        before = before * size + place
    _skip(file, before * prod(shape[first:]) * dtype.itemsize)
    rest = index[first + 1 :]
    if all(isinstance(place, slice) for place in rest):
        return read_values(file, shape[first:], dtype)
    kept = [size for size, place in zip(shape, index) if isinstance(place, slice)]
    values, plane = new_voxels(kept, dtype), np.empty(shape[first + 1 :], dtype)
    for k in range(kept[0]):
        read_into(file, bytes_of(plane))
        values[k] = plane[rest]
    return values


def _skip(file: io.RawIOBase | io.BufferedIOBase, count: int) -> None:
    dropped = bytearray(min(count, _PIECE))
    while count:
        part = memoryview(dropped)[:count]
        read_into(file, part)
        count -= len(part)


class _Stream(io.RawIOBase):
    """A binary file made of pieces."""

    def __init__(self, pieces: Iterator[memoryview]) -> None:
        super().__init__()
        self._pieces, self._left = pieces, memoryview(b"")

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: "WriteableBuffer") -> int:
        if not self._left:
            self._left = next(self._pieces, memoryview(b""))
        target = memoryview(buffer).cast("B")
        count = min(len(target), len(self._left))
        target[:count] = self._left[:count]
        self._left = self._left[count:]
        return count


# A pattern with one number, such as slice%03d.raw, followed by first, last and step.
_PATTERN = re.compile(r"([^%]*%0?\d{0,2}[diu][^%]*?)((?:\s+-?\d{1,9}){0,4})")
_LIST = re.compile(r"LIST(?:\s+(\d{1,2})D?)?", re.IGNORECASE)
# Upper bound on the files, more than any volume has planes.
_MOST_FILES = 1 << 16


def data_files(
    path: Path, field: str, listed: Sequence[str], shape: Sequence[int]
) -> tuple[Path, ...]:
    """Returns the files that share the values of an array evenly, in order. Raises LeaflightError.

    field: The header's text about the files.
    listed: Lines after the header.
    shape: Sizes of the axes, fastest first. By default a file has all but the slowest.
    """
    if found := _LIST.fullmatch(field):
        axes = int(found[1] or 0) or len(shape) - 1
        names = [line.strip() for line in listed if line.strip()]
        _check_count(path, len(names), shape, axes)
    elif (found := _PATTERN.fullmatch(field)) and not (path.parent / field).is_file():
        numbers = [int(word) for word in found[2].split()]
        axes = numbers.pop() if len(numbers) == 4 else len(shape) - 1
        steps = _numbers(path, numbers, shape[-1])
        _check_count(path, len(steps), shape, axes)
        names = [found[1] % number for number in steps]
    else:
        return (data_file(path, field),)
    return tuple(data_file(path, name) for name in names)


def _numbers(path: Path, given: Sequence[int], count: int) -> Sequence[int]:
    """Returns the numbers of a pattern's files. given: None, the first, the last, the step."""
    first = given[0] if given else 1
    if len(given) < 2:
        return range(first, first + count)
    last = given[1]
    evenly = (last - first) // max(count - 1, 1)
    step = given[2] if len(given) > 2 else evenly or (1 if last >= first else -1)
    if not step:
        raise LeaflightError(
            f"{path}: the header numbers the data files in steps of 0; correct the header."
        )
    return range(first, last + (1 if step > 0 else -1), step)


def _check_count(path: Path, count: int, shape: Sequence[int], axes: int) -> None:
    """Raises LeaflightError unless the array can be split into this many files of `axes` axes."""
    wanted = 1
    for size in shape[axes:]:
        wanted *= size
    # Files with all axes are slabs along the slowest.
    right = shape[-1] % max(count, 1) == 0 if axes == len(shape) else count == wanted
    if not 0 < axes <= len(shape) or not right or not 0 < count <= _MOST_FILES:
        raise LeaflightError(
            f"{path}: the header names {count} data files, which do not match {text(shape)} "
            "values; correct the header."
        )
