# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the stored numbers of the pixels of a DICOM page."""

from collections.abc import Callable
from dataclasses import asdict
from hashlib import sha256

import numpy as np
import pydicom

from ...._core import LeaflightError
from ....arrays import Array
from ...reader_process import decoded
from .header import Pixels
from .planes import Plane

# The type of a function that returns the numbers of a page, [row, column].
Pages = Callable[[int], Array]
# Upper bound on the bytes of a decoded number.
_MOST_BYTES = 8


def open_pages(pixels: Pixels) -> Pages:
    """Returns the reader of a file's pages. Raises LeaflightError, as does the reader.

    Unused bits, such as overlays, are removed, and signs are correct.
    """
    if pixels.compressed:
        # Decoded numbers start at the lowest bit.
        return lambda page: _counted(_decoded(pixels, page), pixels, 0)
    if pixels.start < 0:
        data = bytes(pydicom.dcmread(pixels.file, force=True)[pixels.element].value)
        return lambda page: _native(pixels, page, lambda start, count: data[start : start + count])

    def part(start: int, count: int) -> bytes:
        with open(pixels.file, "rb") as file:
            file.seek(pixels.start + start)
            return file.read(count)

    return lambda page: _native(pixels, page, part)


def values_of(plane: Plane, pages: Pages) -> Array:
    """Returns the values of a plane: slope and intercept applied to the stored numbers."""
    numbers = pages(plane.page)
    if plane.slope == 1 and plane.intercept == 0:
        return numbers
    rescaled: Array = numbers * plane.slope + plane.intercept
    return rescaled


def digest(plane: Plane) -> bytes:
    """Returns a hash that is equal for planes with equal values."""
    values = np.ascontiguousarray(values_of(plane, open_pages(plane.pixels)), np.float64)
    return sha256(values.tobytes()).digest()


def _decoded(pixels: Pixels, page: int) -> Array:
    """Returns a compressed page, from the subprocess with the decoders."""
    facts = {**asdict(pixels), "file": str(pixels.file)}
    function = f"{__package__}.compressed", "decoded_pages"
    most = pixels.shape[0] * pixels.shape[1] * _MOST_BYTES
    return decoded(pixels.file, "DICOM file", function, most, facts, page)


def _native(pixels: Pixels, page: int, part: Callable[[int, int], bytes]) -> Array:
    """Returns an uncompressed page. part(start, count) returns bytes of the pixels."""
    count = pixels.shape[0] * pixels.shape[1]
    if pixels.allocated == 1:
        # A page may begin within a byte.
        begin, end = page * count, (page + 1) * count
        raw = np.frombuffer(part(begin // 8, (end + 7) // 8 - begin // 8), np.uint8)
        bits = np.unpackbits(raw, bitorder="little")[begin % 8 :][:count]
        return _shaped(pixels, bits)
    size = pixels.allocated // 8
    if pixels.allocated not in ((32, 64) if pixels.floats else (8, 16, 32)):
        raise LeaflightError(
            f"{pixels.file}: {pixels.allocated} bits per pixel are not supported; save the series "
            "with 16."
        )
    if size == 1 and pixels.words and not pixels.little:
        # Two pixels are a word; its first byte is the second pixel.
        begin, end = page * count // 2 * 2, (page + 1) * count
        raw = np.frombuffer(part(begin, (end - begin + 1) // 2 * 2), "<u2").byteswap()
        numbers = _shaped(pixels, raw.view(np.uint8)[page * count - begin :])
        return _counted(numbers, pixels, _lowest(numbers, pixels))
    kind = np.dtype(f"{'<' if pixels.little else '>'}{'f' if pixels.floats else 'u'}{size}")
    numbers = _shaped(pixels, np.frombuffer(part(page * count * size, count * size), kind))
    return numbers if pixels.floats else _counted(numbers, pixels, _lowest(numbers, pixels))


def _shaped(pixels: Pixels, numbers: Array) -> Array:
    """Returns the page of these numbers. Raises LeaflightError if some are missing."""
    count = pixels.shape[0] * pixels.shape[1]
    if numbers.size < count:
        raise LeaflightError(
            f"{pixels.file}: the file ends before its pixels do: it is truncated, fetch it again."
        )
    return numbers[:count].reshape(pixels.shape)


def _counted(numbers: Array, pixels: Pixels, lowest: int) -> Array:
    """Returns integers of the used bits from the lowest on, with their signs."""
    stored = pixels.stored
    if not pixels.signed and lowest == 0 and stored == 8 * numbers.dtype.itemsize:
        return numbers
    integers = numbers.astype(np.int64 if stored > 16 else np.int32)
    counted: Array = np.right_shift(integers, lowest) & ((1 << stored) - 1)
    if pixels.signed:
        sign = 1 << (stored - 1)
        counted = (counted ^ sign) - sign
    return counted


def _lowest(numbers: Array, pixels: Pixels) -> int:
    """Returns the lowest used bit: that in the header, unless the numbers contradict it.

    Many writers leave High Bit at 15 although they store 12 bits from the lowest on.
    """
    lowest = pixels.high + 1 - pixels.stored
    if not 0 < lowest <= pixels.allocated - pixels.stored:
        return 0
    if not np.bitwise_and(numbers, (1 << lowest) - 1).any():
        return lowest
    if pixels.signed:
        half = 1 << (pixels.stored - 1)
        signed = numbers.astype(numbers.dtype.newbyteorder("=")).view(f"i{numbers.dtype.itemsize}")
        return 0 if -half <= signed.min() and signed.max() < half else lowest
    return 0 if numbers.max() < 1 << pixels.stored else lowest
