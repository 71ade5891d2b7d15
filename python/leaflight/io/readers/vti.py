# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK's image data in XML: raw, base64 or text, plain or compressed by zlib or LZMA.

https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import base64
import lzma
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any, Protocol
from xml.etree import ElementTree

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from .checks import (
    DEFLATE_MOST,
    check_matrix,
    check_size,
    choose_named,
    listed,
    truncated,
    undecided,
)
from .stored import StoredVolume, lengths
from .watched import watched

_TYPES = {
    "Int8": "i1",
    "UInt8": "u1",
    "Int16": "i2",
    "UInt16": "u2",
    "Int32": "i4",
    "UInt32": "u4",
    "Int64": "i8",
    "UInt64": "u8",
    "Float32": "f4",
    "Float64": "f8",
}


class _Decompressor(Protocol):
    def decompress(self, data: bytes, max_length: int, /) -> bytes: ...


_COMPRESSORS: dict[str | None, Callable[[], _Decompressor] | None] = {
    None: None,
    "vtkZLibDataCompressor": lambda: zlib.decompressobj(),
    "vtkLZMADataCompressor": lambda: lzma.LZMADecompressor(),
}


@dataclass(frozen=True)
class _Encoding:
    """How the numbers of a file are written; data: of the appended part, if there is one."""

    order: str
    header: np.dtype[Any]
    decompressor: Callable[[], _Decompressor] | None
    data: bytes
    base64: bool


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """Point data, else cell data; components of vectors and colours are channels."""
    root, encoding = _document(path)
    image, pieces = root.find("ImageData"), root.findall("ImageData/Piece")
    assert image is not None
    if len(pieces) != 1:
        raise LeaflightError(
            f"{path}: its image is in {len(pieces)} pieces; save it from VTK or ParaView as one."
        )
    cells = pieces[0].find("PointData/DataArray") is None
    found = pieces[0].findall(("CellData" if cells else "PointData") + "/DataArray")
    arrays = {one.get("Name") or "unnamed": one for one in found if one.get("type") in _TYPES}
    name = choose_named(path, tuple(arrays), dataset)
    if name is None:
        ask = undecided(path, tuple(arrays))
        return StoredVolume(None, np.dtype(np.float32), ask, datasets=tuple(arrays))
    array = arrays[name]
    dtype = np.dtype(encoding.order + _TYPES[array.attrib["type"]])
    ends = np.array(image.attrib["WholeExtent"].split(), int).reshape(3, 2)
    dims = tuple(int(n) for n in ends[:, 1] - ends[:, 0] + (0 if cells else 1))
    if min(dims) < 1:
        raise LeaflightError(f"{path}: the header claims no voxels; the file is damaged.")
    channels = int(array.get("NumberOfComponents") or 1)
    shape = (*dims[::-1], channels)
    most = DEFLATE_MOST**2 if encoding.decompressor else 1
    check_size(path, shape, dtype.itemsize, path.stat().st_size, most)
    matrix = _matrix(image, ends[:, 0] + (0.5 if cells else 0.0))
    check_matrix(path, matrix)

    def load(_frame: int, channel: int, progress: Progress) -> Volume:
        values = _values(path, array, encoding, dtype, shape, progress)
        return Volume(values[..., channel], matrix, path.stem)

    return StoredVolume(
        dims, dtype, load, lengths(matrix), channels=channels, datasets=tuple(arrays)
    )


def _document(path: Path) -> tuple[ElementTree.Element, _Encoding]:
    """(the root of the XML, its _Encoding)."""
    content = path.read_bytes()
    xml, _, appended = content.partition(b"<AppendedData")
    try:
        root = ElementTree.fromstring(xml + b"</VTKFile>" if appended else xml)
    except ElementTree.ParseError:
        raise LeaflightError(
            f"{path}: this is not a readable VTK image, or it is truncated or damaged; fetch it "
            "again."
        ) from None
    if root.find("ImageData") is None:
        raise LeaflightError(
            f"{path}: it holds {root.get('type') or 'no'} data, but a volume needs ImageData."
        )
    if root.get("compressor") not in _COMPRESSORS:
        known = listed([name for name in _COMPRESSORS if name])
        raise LeaflightError(
            f"{path}: its compression {str(root.get('compressor'))[:40]} is not supported; save it "
            f"without, or with one of {known}."
        )
    order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    opening, _, data = appended.partition(b"_")
    return root, _Encoding(
        order,
        np.dtype(order + {"UInt32": "u4", "UInt64": "u8"}[root.get("header_type", "UInt32")]),
        _COMPRESSORS[root.get("compressor")],
        data,
        b"base64" in opening,
    )


def _values(
    path: Path,
    array: ElementTree.Element,
    encoding: _Encoding,
    dtype: np.dtype[Any],
    shape: tuple[int, ...],
    progress: Progress,
) -> Array:
    size, form = prod(shape) * dtype.itemsize, array.get("format")
    if form == "ascii":
        values = np.array((array.text or "").split(), dtype)
        if values.size != prod(shape):
            raise truncated(path, shape)
        return values.reshape(shape)
    if form == "appended":
        source, is_base64 = encoding.data[int(array.attrib["offset"]) :], encoding.base64
    else:
        source, is_base64 = (array.text or "").strip().encode(), True
    try:
        if encoding.decompressor is None:
            data = _plain(source, encoding.header, size, is_base64)
        else:
            data = _decompressed(source, encoding, size, is_base64, progress)
    except (ValueError, IndexError, zlib.error, lzma.LZMAError, EOFError):
        raise truncated(path, shape) from None
    if len(data) != size:
        raise truncated(path, shape)
    return np.frombuffer(data, dtype).reshape(shape)


def _plain(source: bytes, header: np.dtype[Any], size: int, is_base64: bool) -> bytes:
    """A number of bytes, and these."""
    end = header.itemsize + size
    if is_base64:
        source = base64.b64decode(source[: -(-end // 3) * 4])
    return source[header.itemsize : end]


def _decompressed(
    source: bytes, encoding: _Encoding, size: int, is_base64: bool, progress: Progress
) -> bytes:
    """Blocks: their number, two sizes, the compressed size of each, and then themselves.

    In base64 the header and the blocks are encoded one after the other.
    """
    assert encoding.decompressor is not None
    number = encoding.header.itemsize
    first = base64.b64decode(source[: -(-number // 3) * 4]) if is_base64 else source
    count = int(np.frombuffer(first, encoding.header, 1)[0])
    if count * number > len(source):
        raise ValueError("the number of blocks")
    end = (3 + count) * number
    if is_base64:
        length = -(-end // 3) * 4
        head, body = base64.b64decode(source[:length]), source[length:]
    else:
        head, body = source[:end], source[end:]
    ends = np.cumsum(np.frombuffer(head, encoding.header, count, 3 * number).astype(np.int64))
    if is_base64:
        body = base64.b64decode(body[: -(-int(ends[-1]) // 3) * 4] if count else b"")
    data = bytearray()
    for begin, end in watched(progress, zip([0, *ends[:-1]], ends)):
        data += encoding.decompressor().decompress(body[begin:end], size - len(data) or 1)
    return bytes(data)


def _matrix(image: ElementTree.Element, first: Array) -> Array:
    """From origin, spacing and direction; first: the index (x, y, z) that the values begin at."""
    numbers = {"Origin": "0 0 0", "Spacing": "1 1 1", "Direction": "1 0 0 0 1 0 0 0 1"}
    origin, spacing, axes = (
        np.array((image.get(key) or text).split(), np.float64) for key, text in numbers.items()
    )
    matrix = np.eye(4)
    matrix[:3, :3] = axes.reshape(3, 3) * spacing
    matrix[:3, 3] = origin + matrix[:3, :3] @ first
    return matrix
