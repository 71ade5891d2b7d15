# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading of files with progress and cancelling, by a Progress of the core."""

import gzip
import io
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from numpy.typing import DTypeLike

from ..._core import Progress
from ...arrays import Array
from ...volume.memory import bytes_of, new_voxels

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

T = TypeVar("T")
# Bytes per read: few, because compressed bytes may expand by a factor of 1000.
_MOST = 1 << 16
_MOST_VALUES = 1 << 22
STAGE = "Reading"
_GZIP = b"\x1f\x8b\x08"


def watched(progress: Progress, things: Iterable[T], stage: str = STAGE) -> Iterator[T]:
    """Yields the things, and reports each one when it is done. Raises Cancelled."""
    things = list(things)
    begin(progress, stage, len(things))
    for thing in things:
        progress.check()
        yield thing
        progress.advance(1)


@contextmanager
def open_watched(
    path: Path, progress: Progress, unpacked: bool = True
) -> Iterator[io.BufferedIOBase]:
    """Opens a binary file, decompressed if it is gzip, unless `unpacked` is False."""
    begin(progress, STAGE, path.stat().st_size)
    with io.BufferedReader(_Watched(path, progress), _MOST) as file:
        yield gzip.GzipFile(fileobj=file) if unpacked and is_packed(path) else file


def is_packed(path: Path) -> bool:
    """Returns True if a file is gzip, by its first bytes, because names are often wrong."""
    with open(path, "rb") as file:
        return file.read(len(_GZIP)) == _GZIP


def open_head(path: Path) -> io.BufferedIOBase:
    """Opens a binary file, decompressed, to read only its beginning."""
    return gzip.open(path) if is_packed(path) else open(path, "rb")


def read_values(
    file: io.RawIOBase | io.BufferedIOBase, shape: Iterable[int], dtype: DTypeLike
) -> Array:
    """Reads the next array of this shape in a binary file. Raises EOFError if it ends."""
    values = new_voxels(shape, dtype)
    read_into(file, bytes_of(values))
    return values


def read_into(file: io.RawIOBase | io.BufferedIOBase, left: memoryview) -> None:
    """Fills bytes with the next ones of a binary file. Raises EOFError if it ends."""
    while left:
        count = file.readinto(left[:_MOST_VALUES])
        if not count:
            raise EOFError
        left = left[count:]


def begin(progress: Progress, stage: str, total: float) -> None:
    """Begins a stage of this much work, which progress.advance() counts."""
    progress.begin(stage)
    # Reading is nearly all of the work.
    if progress.fraction < 1:
        progress.expect(total)


class _Watched(io.RawIOBase):
    """A file that is read in pieces, so that it can be cancelled between them."""

    def __init__(self, path: Path, progress: Progress) -> None:
        super().__init__()
        self._file = open(path, "rb", buffering=0)
        self._progress = progress

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def readinto(self, buffer: "WriteableBuffer") -> int:
        self._progress.check()
        count = self._file.readinto(memoryview(buffer)[:_MOST])
        self._progress.advance(count)
        return count

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        return self._file.seek(offset, whence)

    def close(self) -> None:
        self._file.close()
        super().close()
