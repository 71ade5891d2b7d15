# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading that reports its progress and can be cancelled, by the core's Progress."""

import gzip
import io
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from numpy.typing import DTypeLike

from ..._core import Progress
from ...arrays import Array
from ...volume.voxels import bytes_of, new_voxels

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

T = TypeVar("T")
# Bytes per read: few, because compressed bytes may expand a thousand times.
_MOST = 1 << 16
_MOST_VALUES = 1 << 22
STAGE = "Reading"
_GZIP = b"\x1f\x8b\x08"


def watched(progress: Progress, things: Iterable[T], stage: str = STAGE) -> Iterator[T]:
    """Yields the things, and reports each when it is done. Raises Cancelled."""
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
    """A binary file; what it holds where it is one of gzip, unless `unpacked` is False."""
    begin(progress, STAGE, path.stat().st_size)
    with io.BufferedReader(_Watched(path, progress), _MOST) as file:
        yield gzip.GzipFile(fileobj=file) if unpacked and is_packed(path) else file


def is_packed(path: Path) -> bool:
    """Whether gzip wrote a file, by its first bytes: names are often wrong."""
    with open(path, "rb") as file:
        return file.read(len(_GZIP)) == _GZIP


def open_head(path: Path) -> io.BufferedIOBase:
    """A binary file, unpacked, of which only the beginning is read."""
    return gzip.open(path) if is_packed(path) else open(path, "rb")


def read_values(
    file: io.RawIOBase | io.BufferedIOBase, shape: Iterable[int], dtype: DTypeLike
) -> Array:
    """The array of this shape that stands next in a binary file. Raises EOFError where it ends."""
    values = new_voxels(shape, dtype)
    read_into(file, bytes_of(values))
    return values


def read_into(file: io.RawIOBase | io.BufferedIOBase, left: memoryview) -> None:
    """Fills bytes with those that stand next in a binary file. Raises EOFError where it ends."""
    while left:
        count = file.readinto(left[:_MOST_VALUES])
        if not count:
            raise EOFError
        left = left[count:]


def begin(progress: Progress, stage: str, total: float) -> None:
    """Begins a stage with so much to do in it, which progress.advance() counts down."""
    progress.begin(stage)
    # Reading is nearly all there is to do.
    if progress.fraction < 1:
        progress.expect(total)


class _Watched(io.RawIOBase):
    """A file that is read in pieces, between which it can be cancelled."""

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
