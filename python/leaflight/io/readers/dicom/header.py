# SPDX-License-Identifier: GPL-3.0-or-later
"""The header of a DICOM file, and the position of its pixels."""

import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import pydicom
from pydicom.dataset import FileDataset
from pydicom.filereader import read_dataset, read_partial, read_preamble

from ...._core import LeaflightError
from ..checks import DEFLATE_MOST, check_size

# Tags with pixels, by the tag number.
_ELEMENTS = {
    0x7FE00008: "FloatPixelData",
    0x7FE00009: "DoubleFloatPixelData",
    0x7FE00010: "PixelData",
}
_RECORDS = 0x00041220  # the records of a DICOMDIR
_DEFLATED = "1.2.840.10008.1.2.1.99"
_BIG_ENDIAN = "1.2.840.10008.1.2.2"
_IMPLICIT = "1.2.840.10008.1.2"
_UNDEFINED = 0xFFFFFFFF
# Upper bounds on the size of decompressed pixels: bytes for any file, and the ratio for larger
# files. A blank slice takes no bytes in JPEG 2000.
MOST_BLANK = 1 << 28
# Smallest size of a compressed page: the tag and the length of its item.
_LEAST_PAGE = 8
# Upper bounds on the size of a deflated header, which is decompressed at once: bytes, and ratio.
_MOST_UNPACKED, _MOST_TIMES, _PIECE = 1 << 28, 100, 1 << 20


@dataclass(frozen=True)
class Pixels:
    """The pixels of a file: encoding and position.

    element: Name of the tag.
    start: First byte in the file; -1 in a deflated file.
    length: Bytes in the file; -1 for compressed pages.
    pages: Number of planes.
    shape: Rows and columns of a plane.
    allocated: Bits of a stored number.
    stored: Bits of it that are used.
    high: Highest of the used bits.
    """

    file: Path
    element: str
    start: int
    length: int
    pages: int
    shape: tuple[int, int]
    allocated: int
    stored: int
    high: int
    signed: bool
    syntax: str
    little: bool
    words: bool

    @property
    def compressed(self) -> bool:
        return self.length < 0

    @property
    def floats(self) -> bool:
        return self.element != "PixelData"


class _IsDirectory(Exception):
    pass


@dataclass(frozen=True)
class Header:
    """The tags before the pixels, and the pixels' element, value type, start and length."""

    file: Path
    tags: pydicom.Dataset
    found: tuple[str, str, int, int] | None


def read_header(file: Path) -> Header:
    """Reads the header in front of a file's pixels. Raises LeaflightError if it is no DICOM."""
    found: list[tuple[str, str, int, int]] = []
    try:
        with open(file, "rb") as stream:
            _check_deflated(file, stream)

            def at_pixels(tag: Any, kind: str | None, length: int) -> bool:
                if int(tag) == _RECORDS:
                    raise _IsDirectory
                element = _ELEMENTS.get(int(tag))
                if element is not None:
                    found.append((element, kind or "OW", stream.tell(), length))
                return element is not None

            try:
                tags: pydicom.Dataset = read_partial(stream, stop_when=at_pixels, force=True)
            except _IsDirectory:
                tags = _read_directory(stream)
        return Header(file, tags, found[-1] if found else None)
    except (LeaflightError, OSError):
        raise
    except Exception as error:
        # On damaged files pydicom raises many types of exceptions.
        raise damaged_header(file) from error


def _read_directory(stream: BinaryIO) -> pydicom.Dataset:
    """Reads a DICOMDIR without the tree of its records.

    pydicom makes that tree before version 3.0. It does not end if the records form a circle.
    """
    stream.seek(0)
    preamble = read_preamble(stream, True)
    meta = read_dataset(stream, False, True, stop_when=lambda tag, *_: tag.group != 2)
    implicit = str(meta.get("TransferSyntaxUID", "")) == _IMPLICIT
    tags = read_dataset(stream, implicit, True)
    return FileDataset(stream, tags, preamble, meta, implicit, True)


def damaged_header(file: Path) -> LeaflightError:
    return LeaflightError(
        f"{file}: its DICOM header is damaged; fetch the file again, or leave it out."
    )


def pixels_of(header: Header) -> Pixels:
    """Returns the Pixels of a picture. Raises LeaflightError, or any exception of pydicom."""
    assert header.found is not None
    file, tags, (element, kind, start, length) = header.file, header.tags, header.found
    syntax = str(tags.file_meta.get("TransferSyntaxUID", "") or _IMPLICIT)
    if syntax == _DEFLATED:
        start, held = -1, length
    else:
        held = min(length, file.stat().st_size - start)
    allocated = int(tags.BitsAllocated)
    stored = int(tags.get("BitsStored", None) or allocated)
    high = tags.get("HighBit", None)
    pixels = Pixels(
        file=file,
        element=element,
        start=start,
        length=-1 if length == _UNDEFINED else held,
        pages=int(tags.get("NumberOfFrames", None) or 1),
        shape=(int(tags.Rows), int(tags.Columns)),
        allocated=allocated,
        stored=stored if 0 < stored <= allocated else allocated,
        high=int(high) if high is not None else stored - 1,
        signed=bool(tags.get("PixelRepresentation", 0)),
        syntax=syntax,
        little=_is_little(tags, syntax),
        words=kind == "OW",
    )
    _check(pixels)
    return pixels


def _is_little(tags: pydicom.Dataset, syntax: str) -> bool:
    if "TransferSyntaxUID" in tags.file_meta:
        return syntax != _BIG_ENDIAN
    # pydicom guesses the encoding from the first bytes if it is missing. Version 2 has no
    # original_encoding.
    encoding = getattr(tags, "original_encoding", None)
    return bool(tags.read_little_endian if encoding is None else encoding[1])


def _check(pixels: Pixels) -> None:
    """Raises LeaflightError if the header claims more than the file can hold."""
    file, pages = pixels.file, pixels.pages
    size = file.stat().st_size
    if pages < 1 or min(pixels.shape) < 1:
        raise LeaflightError(
            f"{file}: the header claims {pages} pages of {pixels.shape[0]} x {pixels.shape[1]} "
            "pixels: it is damaged, fetch it again."
        )
    shape = (pages, *pixels.shape)
    if pixels.compressed:
        check_size(file, (pages,), _LEAST_PAGE, size)
        most = max(size * DEFLATE_MOST, MOST_BLANK)
        check_size(file, shape, (pixels.allocated + 7) // 8, most)
    elif pixels.allocated % 8:
        bits = pages * pixels.shape[0] * pixels.shape[1] * pixels.allocated
        check_size(file, ((bits + 7) // 8,), 1, pixels.length)
    else:
        check_size(file, shape, pixels.allocated // 8, pixels.length)


def _check_deflated(file: Path, stream: BinaryIO) -> None:
    """Raises LeaflightError if pydicom would decompress far more than a file can hold."""
    if _DEFLATED.encode() not in stream.read(1024):
        stream.seek(0)
        return
    stream.seek(132)
    meta = pydicom.filereader.read_file_meta_info(file)
    stream.seek(144 + int(meta.FileMetaInformationGroupLength))
    most = max(_MOST_UNPACKED, _MOST_TIMES * file.stat().st_size)
    unpacker, count = zlib.decompressobj(-zlib.MAX_WBITS), 0
    packed = stream.read(_PIECE)
    while packed and not unpacker.eof:
        count += len(unpacker.decompress(packed, _PIECE))
        if count > most:
            raise LeaflightError(
                f"{file}: the deflated data would take more than {most} bytes; save it "
                "uncompressed."
            )
        packed = unpacker.unconsumed_tail or stream.read(_PIECE)
    stream.seek(0)
