# SPDX-License-Identifier: GPL-3.0-or-later
"""Encodings of values in files: raw, compressed, or text."""

import bz2
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from .checks import DEFLATE_MOST

# Types of numbers by their names in headers.
NUMBERS = {
    **dict.fromkeys(("char", "signed char", "int8", "int8_t"), "i1"),
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
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
# Bytes that are read at once, and bytes that are unpacked at once.
_PIECE = 1 << 20
# Upper bound on the characters of a number.
_MOST_DIGITS = 400


class _File(Protocol):
    def read(self, size: int, /) -> bytes: ...


@dataclass(frozen=True)
class Encoding:
    """An encoding of values as bytes of a file.

    pieces: pieces(file, dtype, size) yields the bytes of the following values, at least `size` if
        there are as many. It raises EOFError or ValueError if they are damaged.
    least: least(dtype) is the smallest number of bytes of a value in the file.
    most: Upper bound on the bytes of values that one byte of the file expands to.
    packed: True for a compression.
    """

    pieces: Callable[[_File, np.dtype[Any], int], Iterator[bytes]]
    least: Callable[[np.dtype[Any]], int] = lambda dtype: dtype.itemsize
    most: int = 1
    packed: bool = False


class _Decompressor(Protocol):
    @property
    def eof(self) -> bool: ...
    @property
    def unused_data(self) -> bytes: ...
    def decompress(self, data: bytes, max_length: int, /) -> bytes: ...


def _raw(file: _File, _dtype: np.dtype[Any], _size: int) -> Iterator[bytes]:
    while piece := file.read(_PIECE):
        yield piece


def _text(file: _File, dtype: np.dtype[Any], size: int) -> Iterator[bytes]:
    """Yields numbers separated by spaces, line ends or commas."""
    left, rest, more = size // dtype.itemsize, b"", True
    while more and left > 0:
        piece = file.read(_PIECE)
        more = bool(piece)
        words = (rest + piece).replace(b",", b" ").split()
        # The last number may continue in the next piece.
        goes_on = more and not piece[-1:].isspace() and bool(words)
        rest = words.pop() if goes_on else b""
        if len(rest) > _MOST_DIGITS:
            raise ValueError("It is no number.")
        words = words[:left]
        left -= len(words)
        yield _parsed(words, dtype).tobytes()


def _parsed(words: list[bytes], dtype: np.dtype[Any]) -> "np.ndarray[Any, np.dtype[Any]]":
    if dtype.kind == "f":
        return np.array([float(word) for word in words], np.float64).astype(dtype)
    try:
        numbers = [int(word) for word in words]
    except ValueError:
        # Some programs write every number as a float, such as 1e3.
        numbers = [int(float(word)) for word in words]
    limits = np.iinfo(dtype)
    if numbers and not limits.min <= min(numbers) <= max(numbers) <= limits.max:
        raise ValueError("A number does not fit into the type.")
    return np.array(numbers, dtype)


def _hex(file: _File, _dtype: np.dtype[Any], size: int) -> Iterator[bytes]:
    left, rest = 2 * size, b""
    while left > 0 and (piece := file.read(_PIECE)):
        digits = (rest + b"".join(piece.split()))[:left]
        even = len(digits) // 2 * 2
        rest = digits[even:]
        left -= even
        yield bytes.fromhex(digits[:even].decode("ascii"))


def _unpacked(
    make: Callable[[], _Decompressor],
) -> Callable[[_File, np.dtype[Any], int], Iterator[bytes]]:
    """Returns pieces() for a compression.

    A file may hold several streams, and other data after them.
    """

    def pieces(file: _File, _dtype: np.dtype[Any], size: int) -> Iterator[bytes]:
        inflate, begun, found = make(), False, 0
        packed = file.read(_PIECE)
        while found < size:
            most = min(_PIECE, size - found)
            try:
                piece = inflate.decompress(packed, most)
            except (zlib.error, OSError):
                if begun or not found:
                    raise EOFError from None
                return
            begun, found = begun or bool(piece), found + len(piece)
            yield piece
            if inflate.eof:
                inflate, begun, packed = make(), False, inflate.unused_data
                more = not packed
            else:
                packed = getattr(inflate, "unconsumed_tail", b"")
                # After a full piece there may be more output without further input.
                more = not packed and len(piece) < most
            if more and not (packed := file.read(_PIECE)):
                return

    return pieces


def _byte_rle(file: _File, _dtype: np.dtype[Any], _size: int) -> Iterator[bytes]:
    """Yields bytes of amira's run-length encoding.

    Each run starts with a count. A count n above 128 precedes n - 128 bytes. Any other count
    precedes one byte to repeat.
    """
    packed = b""
    while piece := file.read(_PIECE):
        packed, place, unpacked = packed + piece, 0, bytearray()
        # Continue while the longest possible run is complete.
        while place + 1 < len(packed):
            count = packed[place]
            run = count - 128 if count > 128 else 1
            if place + 1 + run > len(packed):
                break
            part = packed[place + 1 : place + 1 + run]
            unpacked += part if count > 128 else part * count
            place += 1 + run
        packed = packed[place:]
        yield bytes(unpacked)


# zlib may also be gzip, as its first bytes show.
_deflated = _unpacked(lambda: zlib.decompressobj(zlib.MAX_WBITS | 32))
ENCODINGS = {
    "raw": Encoding(_raw),
    # A number takes a digit and a separator; the last one may end with the file.
    "text": Encoding(_text, least=lambda dtype: 2),
    "hex": Encoding(_hex, least=lambda dtype: 2 * dtype.itemsize),
    "gzip": Encoding(_deflated, most=DEFLATE_MOST, packed=True),
    "byte-rle": Encoding(_byte_rle, most=64, packed=True),
    "bzip2": Encoding(_unpacked(bz2.BZ2Decompressor), most=100_000, packed=True),
}
