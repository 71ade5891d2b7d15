# SPDX-License-Identifier: GPL-3.0-or-later
"""NRRD: a header of text, and values behind it (.nrrd) or in a file of their own (.nhdr).

https://teem.sourceforge.net/nrrd/format.html
"""

import bz2
import math
import re
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.units import unit_of
from ...volume.volume import Volume
from ...volume.voxels import bytes_of, new_voxels
from .checks import DEFLATE_MOST, check_matrix, check_shape, check_size, data_file, text, truncated
from .stored import StoredVolume, lengths
from .watched import open_watched


class _Decompressor(Protocol):
    @property
    def eof(self) -> bool: ...
    @property
    def unused_data(self) -> bytes: ...
    def decompress(self, data: bytes, max_length: int, /) -> bytes: ...


_TYPES = {
    **dict.fromkeys(("signed char", "int8", "int8_t"), "i1"),
    **dict.fromkeys(("uchar", "unsigned char", "uint8", "uint8_t"), "u1"),
    **dict.fromkeys(("short", "short int", "signed short", "signed short int"), "i2"),
    **dict.fromkeys(("int16", "int16_t"), "i2"),
    **dict.fromkeys(("ushort", "unsigned short", "unsigned short int"), "u2"),
    **dict.fromkeys(("uint16", "uint16_t"), "u2"),
    **dict.fromkeys(("int", "signed int", "int32", "int32_t"), "i4"),
    **dict.fromkeys(("uint", "unsigned int", "uint32", "uint32_t"), "u4"),
    **dict.fromkeys(("longlong", "long long", "long long int", "signed long long"), "i8"),
    **dict.fromkeys(("signed long long int", "int64", "int64_t"), "i8"),
    **dict.fromkeys(("ulonglong", "unsigned long long", "unsigned long long int"), "u8"),
    **dict.fromkeys(("uint64", "uint64_t"), "u8"),
    "float": "f4",
    "double": "f8",
}
# Name -> (how it is called here, how many bytes one byte of the file can become).
_ENCODINGS = {
    "raw": ("raw", 1),
    **dict.fromkeys(("text", "txt", "ascii"), ("text", 8)),
    "hex": ("hex", 1),
    **dict.fromkeys(("gzip", "gz"), ("gzip", DEFLATE_MOST)),
    **dict.fromkeys(("bzip2", "bz2"), ("bzip2", 100_000)),
}
_SPACES = {"ras": "right-anterior-superior", "las": "left-anterior-superior"}
_SPACES["lps"] = "left-posterior-superior"
# To right-anterior-superior.
_TURNED = {
    "left-posterior-superior": (-1.0, -1.0, 1.0, 1.0),
    "left-anterior-superior": (-1.0, 1.0, 1.0, 1.0),
}
# Where a header ends, at the latest; also of headers with many comments.
_MOST = 1 << 20
_LARGEST_SIDE = 1 << 16


def open_volume(path: Path) -> StoredVolume:
    fields, end = _header(path)
    shape = _sizes(path, fields)
    dtype = np.dtype(_TYPES.get(_need(path, fields, "type").lower(), "V"))
    if dtype.kind == "V":
        raise LeaflightError(
            f"{path}: the type {fields['type'][:40]} is not a number's; convert it to a scalar "
            "type first."
        )
    endian = fields.get("endian", "little").lower()
    dtype = dtype.newbyteorder(">" if endian == "big" else "<")
    encoding, most = _encoding(path, fields)
    space = fields.get("space", "").lower()
    space = _SPACES.get(space, space)
    matrix = _matrix(path, fields, space)
    data, offset = _data_file(path, fields, end)
    stored = data.stat().st_size - offset
    if encoding == "text":
        # Two characters a number at least.
        check_size(data, shape, 2, stored + 1)
    elif encoding == "hex":
        check_size(data, shape, 2 * dtype.itemsize, stored)
    else:
        check_size(data, shape, dtype.itemsize, stored, most)
    offset = _after_skips(path, fields, data, offset, encoding, math.prod(shape) * dtype.itemsize)

    def load(_frame: int, _channel: int, progress: Progress) -> Volume:
        read = _VALUES[encoding]
        values = read(data, offset, shape, dtype, _byte_skip(path, fields), progress)
        return Volume(values, matrix, path.stem)

    units = re.findall(r'"([^"]*)"', fields.get("space units", fields.get("units", "")))
    unit = unit_of(units[0]) if units else ""
    anatomical = "left" in space or "right" in space
    return StoredVolume(
        dims=shape,
        dtype=dtype,
        load=load,
        voxel_size=lengths(matrix),
        unit=unit or ("mm" if anatomical else ""),
        patient=anatomical,
    )


def _header(path: Path) -> tuple[dict[str, str], int]:
    """(the fields by their names, where the data begin if they follow)."""
    with open(path, "rb") as file:
        head = file.read(_MOST)
    if not re.match(rb"NRRD000\d\r?\n", head):
        raise LeaflightError(f"{path}: this is not a readable NRRD file; fetch it again.")
    fields, place, closed = {}, head.find(b"\n") + 1, False
    while place < len(head) and not closed:
        end = head.find(b"\n", place)
        end = len(head) if end < 0 else end
        line = head[place:end].rstrip(b"\r").decode("utf-8", "replace")
        place = end + 1
        closed = not line
        if line.startswith("#") or re.match(r"[^:]*:=", line):
            continue  # a comment, or a key and value, which is a note for others
        name, colon, value = line.partition(":")
        name = {"datafile": "data file"}.get(name.strip().lower(), name.strip().lower())
        if colon and name in fields:
            raise LeaflightError(
                f"{path}: the header says its {name[:40]} twice; remove one of them."
            )
        if colon:
            fields[name] = value.strip()
    if not closed and "data file" not in fields:
        raise LeaflightError(
            f"{path}: its header has no end, which is a blank line: it is truncated or damaged, "
            "fetch it again."
        )
    return fields, place


def _need(path: Path, fields: dict[str, str], name: str) -> str:
    if name not in fields:
        raise LeaflightError(f"{path}: its header does not say its {name}; fetch it again.")
    return fields[name]


def _sizes(path: Path, fields: dict[str, str]) -> tuple[int, ...]:
    words = _need(path, fields, "sizes").split()
    dimension = fields.get("dimension", str(len(words)))
    if not all(re.fullmatch(r"\d{1,9}", word) for word in words) or dimension != str(len(words)):
        raise LeaflightError(
            f"{path}: its header does not say how large each of its axes is; fetch it again."
        )
    shape = tuple(map(int, words))
    if len(shape) != 3:
        raise LeaflightError(
            f"{path}: it has the shape {text(shape[:16])}, but a scalar volume with three axes is "
            "needed; extract one component or frame."
        )
    check_shape(path, shape)
    if max(shape) > _LARGEST_SIDE:
        raise LeaflightError(
            f"{path}: the header claims the impossible size {text(shape)}; check that the file is "
            "complete."
        )
    return shape


def _encoding(path: Path, fields: dict[str, str]) -> tuple[str, int]:
    name = _need(path, fields, "encoding").lower()
    if name not in _ENCODINGS:
        raise LeaflightError(
            f"{path}: the encoding {name[:40]} is not known; save it as raw or gzip."
        )
    return _ENCODINGS[name]


def _data_file(path: Path, fields: dict[str, str], end: int) -> tuple[Path, int]:
    """(the file that holds the values, where in it they begin)."""
    name = fields.get("data file")
    if name is None:
        return path, end
    return data_file(path, name), 0


def _byte_skip(path: Path, fields: dict[str, str]) -> int:
    return _whole(path, fields, "byte skip", -1)


def _whole(path: Path, fields: dict[str, str], name: str, least: int) -> int:
    """A field that is a whole number, 0 where it is missing."""
    value = fields.get(name, fields.get(name.replace(" ", ""), "0"))
    if not re.fullmatch(r"-?\d{1,15}", value) or int(value) < least:
        raise LeaflightError(
            f"{path}: its {name} is {value[:40]!r}, but must be a whole number; repair the header."
        )
    return int(value)


def _after_skips(
    path: Path, fields: dict[str, str], data: Path, offset: int, encoding: str, size: int
) -> int:
    """Where the values begin, behind the lines and bytes that the header says are none of them."""
    lines, skip = _whole(path, fields, "line skip", 0), _byte_skip(path, fields)
    length = data.stat().st_size
    with open(data, "rb") as file:
        file.seek(offset)
        for _ in range(lines):
            if not file.readline():
                break
        offset = file.tell()
    # Bytes of compressed values are skipped once they are none.
    if encoding in ("gzip", "bzip2"):
        return offset
    # -1 says that the values are the end of the file.
    offset = length - size if skip < 0 and encoding == "raw" else offset + max(skip, 0)
    if offset < 0 or (encoding == "raw" and offset + size > length):
        raise LeaflightError(
            f"{path}: the header claims {size} bytes of values, but behind what it skips there are "
            f"only {max(0, length - offset)}: it is truncated or damaged, fetch it again."
        )
    return offset


def _raw(
    data: Path,
    offset: int,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    _skip: int,
    _progress: Progress,
) -> Array:
    return np.memmap(data, dtype, "r", offset, shape[::-1])


def _text(
    data: Path,
    offset: int,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    _skip: int,
    progress: Progress,
) -> Array:
    count = math.prod(shape)
    with open_watched(data, progress, unpacked=False) as file:
        file.seek(offset)
        words = re.split(rb"[\s,]+", file.read().strip(), maxsplit=count)[:count]
    try:
        values = np.array(words, dtype="S40").astype(np.float64 if dtype.kind == "f" else dtype)
    except (ValueError, OverflowError):
        raise truncated(data, shape) from None
    return _shaped(values.astype(dtype), data, shape)


def _hex(
    data: Path,
    offset: int,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    _skip: int,
    progress: Progress,
) -> Array:
    with open_watched(data, progress, unpacked=False) as file:
        file.seek(offset)
        digits = b"".join(file.read().split())[: 2 * math.prod(shape) * dtype.itemsize]
    try:
        return _shaped(np.frombuffer(bytes.fromhex(digits.decode("ascii")), dtype), data, shape)
    except ValueError:
        raise truncated(data, shape) from None


def _gzip(
    data: Path,
    offset: int,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    skip: int,
    progress: Progress,
) -> Array:
    def decompressor() -> _Decompressor:
        return zlib.decompressobj(zlib.MAX_WBITS | 16)

    return _inflated(decompressor, data, offset, shape, dtype, skip, progress)


def _bzip2(
    data: Path,
    offset: int,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    skip: int,
    progress: Progress,
) -> Array:
    return _inflated(bz2.BZ2Decompressor, data, offset, shape, dtype, skip, progress)


def _inflated(
    decompressor: Callable[[], _Decompressor],
    data: Path,
    offset: int,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    skip: int,
    progress: Progress,
) -> Array:
    """Not a byte more than asked for. Files may be several compressed ones behind each other."""
    size = math.prod(shape) * dtype.itemsize
    skip = max(skip, 0)
    values = new_voxels(shape[::-1], dtype)
    bytes_of_values = bytes_of(values)
    found, inflate = 0, decompressor()
    with open_watched(data, progress, unpacked=False) as file:
        file.seek(offset)
        try:
            compressed = file.read(1 << 20)
            while compressed and found < size + skip:
                part = inflate.decompress(compressed, size + skip - found)
                kept = part[max(0, skip - found) :]
                place = max(0, found - skip)
                bytes_of_values[place : place + len(kept)] = kept
                found += len(part)
                if inflate.eof:
                    compressed = inflate.unused_data or file.read(1 << 20)
                    inflate = decompressor()
                else:
                    compressed = getattr(inflate, "unconsumed_tail", b"") or file.read(1 << 20)
        except (zlib.error, OSError, EOFError):
            raise truncated(data, shape) from None
    if found != size + skip:
        raise truncated(data, shape)
    return values


def _shaped(values: Array, data: Path, shape: tuple[int, ...]) -> Array:
    if values.size != math.prod(shape):
        raise truncated(data, shape)
    return values.reshape(shape[::-1])


_VALUES = {"raw": _raw, "text": _text, "hex": _hex, "gzip": _gzip, "bzip2": _bzip2}


def _matrix(path: Path, fields: dict[str, str], space: str) -> Array:
    matrix = np.eye(4)
    directions = fields.get("space directions")
    if directions is not None:
        axes = [_vector(path, axis) for axis in re.findall(r"\([^)]*\)", directions)]
        if len(axes) != 3:
            raise LeaflightError(
                f"{path}: its space directions are not three vectors; repair the header."
            )
        matrix[:3, :3] = np.transpose(axes)
        if "space origin" in fields:
            matrix[:3, 3] = _vector(path, fields["space origin"])
    elif "spacings" in fields:
        sizes = [_number(word) for word in fields["spacings"].split()]
        # NaN stands for unknown.
        sizes = [abs(s) if math.isfinite(s) and s else 1.0 for s in sizes]
        if len(sizes) != 3:
            raise LeaflightError(f"{path}: its spacings are not three; repair the header.")
        matrix[:3, :3] = np.diag(sizes)
    check_matrix(path, matrix)
    return np.diag(_TURNED.get(space, (1.0,) * 4)) @ matrix


def _vector(path: Path, words: str) -> list[float]:
    numbers = [_number(word) for word in words.strip("() ").split(",")]
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise LeaflightError(
            f"{path}: {words[:60]} are not three numbers in brackets; repair the header."
        )
    return numbers


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return math.nan
