# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in VTK's XML: raw, base64 or text, plain or compressed by zlib, LZ4 or LZMA.

https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import base64
import io
import lzma
import mmap
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, fromstring

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from .checks import DEFLATE_MOST, check_size, listed, truncated
from .encodings import NUMBERS
from .text_numbers import read_numbers

_ORDERS = {"LittleEndian": "<", "BigEndian": ">"}
_HEADERS = {"UInt32": "u4", "UInt64": "u8"}


def _inflate(data: bytes, most: int) -> bytes:
    return zlib.decompressobj().decompress(data, most)


def _lzma(data: bytes, most: int) -> bytes:
    return lzma.LZMADecompressor().decompress(data, most)


def _lz4(data: bytes, most: int) -> bytes:
    import lz4.block

    try:
        unpacked: bytes = lz4.block.decompress(data, uncompressed_size=most)
    except lz4.block.LZ4BlockError as error:
        raise ValueError(str(error)) from None
    return unpacked


# Decompressors of a block, with an upper bound on its bytes.
_COMPRESSORS: dict[str | None, Callable[[bytes, int], bytes] | None] = {
    None: None,
    "vtkZLibDataCompressor": _inflate,
    "vtkLZ4DataCompressor": _lz4,
    "vtkLZMADataCompressor": _lzma,
}


@dataclass(frozen=True)
class Document:
    """A VTK XML file.

    root: Its XML.
    data: The file itself. Its appended part begins at `appended`.
    order: Byte order.
    header: Type of the numbers that give lengths of data.
    unpack: Decompressor of a block, if blocks are compressed.
    is_base64: True if the appended part is base64.
    """

    path: Path
    root: Element
    order: str
    header: np.dtype[Any]
    unpack: Callable[[bytes, int], bytes] | None
    data: mmap.mmap
    appended: int
    is_base64: bool


def open_document(path: Path) -> Document:
    """Reads the file without its appended data, which are not XML."""
    with open(path, "rb") as file:
        data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    end = data.find(b"<AppendedData")
    root = fromstring(data[:] if end < 0 else data[:end] + b"</VTKFile>")
    order = _ORDERS[root.get("byte_order", "LittleEndian")]
    header = np.dtype(order + _HEADERS[root.get("header_type", "UInt32")])
    compressor = root.get("compressor")
    if compressor not in _COMPRESSORS:
        known = listed([name for name in _COMPRESSORS if name])
        raise LeaflightError(
            f"{path}: the compression {str(compressor)[:40]} is not supported; save the file "
            f"uncompressed, or with one of {known}."
        )
    opening = data.find(b"_", end) if end >= 0 else -1
    is_base64 = end >= 0 and b"base64" in data[end:opening]
    unpack = _COMPRESSORS[compressor]
    return Document(path, root, order, header, unpack, data, opening + 1, is_base64)


def dtype_of(document: Document, array: Element) -> np.dtype[Any]:
    return np.dtype(document.order + NUMBERS[array.attrib["type"].lower()])


def check_claim(document: Document, shape: tuple[int, ...], itemsize: int) -> None:
    """Raises LeaflightError if the file cannot hold an array of this shape."""
    most = 1 if document.unpack is None else DEFLATE_MOST**2
    check_size(document.path, shape, itemsize, document.path.stat().st_size, most)


def values_of(
    document: Document, array: Element, shape: tuple[int, ...], progress: Progress
) -> Array:
    """Reads the array of a DataArray element. Raises LeaflightError if it is incomplete."""
    dtype, form = dtype_of(document, array), array.get("format")
    size = prod(shape) * dtype.itemsize
    try:
        if form == "ascii":
            file = io.BytesIO((array.text or "").encode("latin-1", "replace"))
            return read_numbers(file, prod(shape), dtype, progress).reshape(shape)
        if form == "appended":
            start = document.appended + int(array.attrib["offset"])
            run = _Run(document.data, document.is_base64)
        else:
            text = "".join((array.text or "").split())
            start, run = 0, _Run(text.encode("latin-1", "replace"), True)
        if document.unpack is None:
            # The length precedes the bytes.
            data = run.read(start, document.header.itemsize + size)[document.header.itemsize :]
        else:
            data = b"".join(_unpacked(document, run, start, size, progress))
    except (KeyError, ValueError, IndexError, EOFError, zlib.error, lzma.LZMAError):
        raise truncated(document.path, shape) from None
    if len(data) != size:
        raise truncated(document.path, shape)
    return np.frombuffer(data, dtype).reshape(shape)


@dataclass(frozen=True)
class _Run:
    """A run of bytes, or of base64 with padding after each part that was encoded separately."""

    source: bytes | mmap.mmap
    is_base64: bool

    def length(self, count: int) -> int:
        """Returns the encoded length of `count` bytes."""
        return -(-count // 3) * 4 if self.is_base64 else count

    def read(self, start: int, count: int) -> bytes:
        coded = self.source[start : start + self.length(count)]
        return base64.b64decode(coded)[:count] if self.is_base64 else coded


def _unpacked(
    document: Document, run: _Run, start: int, size: int, progress: Progress
) -> Iterator[bytes]:
    """Yields decompressed blocks, after their number, two sizes, and each compressed size.

    In base64 the header and the blocks are encoded separately.
    """
    assert document.unpack is not None
    number, total = document.header.itemsize, len(run.source)
    count = int(np.frombuffer(run.read(start, number), document.header, 1)[0])
    if count * number > total:
        raise ValueError("the number of blocks")
    length = (3 + count) * number
    numbers = np.frombuffer(run.read(start, length), document.header, 3 + count).tolist()
    largest, sizes = max(numbers[1:3]), numbers[3:]
    if sum(sizes) > total:
        raise ValueError("the sizes of the blocks")
    packed, place = run.read(start + run.length(length), sum(sizes)), 0
    for block in sizes:
        progress.check()
        part = document.unpack(packed[place : place + block], min(largest, size) or 1)
        place += block
        size -= len(part)
        if size < 0:
            raise ValueError("more values than there should be")
        yield part
        progress.advance(len(part))
