# SPDX-License-Identifier: GPL-3.0-or-later
"""Decodes compressed pages, such as JPEG, through imagecodecs or packages that pydicom finds.

Only subprocesses import this module.
"""

import zlib
from collections.abc import Callable, Iterator
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from struct import unpack

import numpy as np
import pydicom
from pydicom import encaps
from pydicom.uid import UID

from ...._core import LeaflightError
from ....arrays import Array
from ...reader_process import requests
from .header import Pixels

# Number of files that are open at once. Each time of a series may be a file with several planes.
_OPEN = 4
_DEFLATED_PAGES = "1.2.840.10008.1.2.8.1"
# Functions of imagecodecs, by the last digits of the transfer syntaxes that they decode.
_JPEG = "1.2.840.10008.1.2.4."
_OF_IMAGECODECS = {
    **dict.fromkeys(("50", "51", "57", "70"), "jpeg8_decode"),
    **dict.fromkeys(("80", "81"), "jpegls_decode"),
    **dict.fromkeys(("90", "91"), "jpeg2k_decode"),
    **dict.fromkeys(("110", "111", "112"), "jpegxl_decode"),
    **dict.fromkeys(("201", "202", "203"), "htj2k_decode"),
}
# First bytes of JPEG 2000, and markers of other JPEGs that precede the size of the picture.
_JPEG_2000 = b"\xff\x4f\xff\x51"
_SIZES = {*range(0xC0, 0xD0), 0xF7} - {0xC4, 0xC8, 0xCC}
# The type of a function that decodes the bytes of a page in a file with this header.
_Decode = Callable[[bytes, pydicom.Dataset], Array]


def decoded_pages(_path: Path) -> tuple[None, Iterator[Array]]:
    """Yields the pages of requests(). Runs in the subprocess."""
    opened = lru_cache(maxsize=_OPEN)(_decoder)

    def pages() -> Iterator[Array]:
        for _, facts, number in requests():
            shape, file = tuple(facts["shape"]), Path(facts["file"])
            pixels = Pixels(**{**facts, "shape": shape, "file": file})
            yield np.ascontiguousarray(opened(pixels)(number))

    return None, pages()


def _decoder(pixels: Pixels) -> Callable[[int], Array]:
    """Returns the decoder of a file's pages. Raises LeaflightError, as does the decoder."""
    data = pydicom.dcmread(pixels.file, force=True)
    decoders = _decoders(pixels)
    frames = _frames(pixels, data)

    def page(number: int) -> Array:
        _check_size(pixels, frames[number])
        for decode in decoders:
            try:
                numbers = np.asarray(decode(frames[number], data))
            except Exception:
                # Decoders raise various errors, even for files that another decoder reads.
                continue
            if numbers.size == pixels.shape[0] * pixels.shape[1] and numbers.dtype.kind in "iu":
                return numbers.reshape(pixels.shape)
        raise _damaged(pixels)

    return page


def _frames(pixels: Pixels, data: pydicom.Dataset) -> list[bytes]:
    """Returns the bytes of each page."""
    try:
        if hasattr(encaps, "generate_frames"):
            found = encaps.generate_frames(data.PixelData, number_of_frames=pixels.pages)
        else:
            # pydicom 2.
            found = encaps.generate_pixel_data_frame(data.PixelData, pixels.pages)
        frames = list(found)
    except Exception as error:
        raise _damaged(pixels) from error
    if len(frames) < pixels.pages:
        raise LeaflightError(
            f"{pixels.file}: the header claims {pixels.pages} pages, but there are {len(frames)}: "
            "it is truncated or damaged, fetch it again."
        )
    return frames


def _decoders(pixels: Pixels) -> list[_Decode]:
    """Returns the decoders of a file's transfer syntax. Raises ImportError if there is none."""
    if pixels.syntax == _DEFLATED_PAGES:
        return [lambda frame, _data: _inflated(frame, pixels)]
    found: list[_Decode] = []
    name = _OF_IMAGECODECS.get(pixels.syntax.removeprefix(_JPEG))
    if name is not None:
        try:
            decode: Callable[[bytes], Array] = getattr(import_module("imagecodecs"), name)
            found.append(lambda frame, _data: decode(frame))
        except ImportError:
            pass
    if _pydicom_decodes(UID(pixels.syntax)):
        found.append(_by_pydicom)
    if not found and name is not None:
        raise ModuleNotFoundError(name="imagecodecs")
    if not found:
        raise LeaflightError(
            f"{pixels.file}: its compression ({UID(pixels.syntax).name}) is not supported; save "
            "the series uncompressed."
        )
    return found


def _pydicom_decodes(syntax: UID) -> bool:
    """Returns True if pydicom has the packages for a transfer syntax."""
    try:
        pixels = import_module("pydicom.pixels")
    except ImportError:
        # pydicom 2.
        handlers = pydicom.config.pixel_data_handlers
        return any(one.is_available() and one.supports_transfer_syntax(syntax) for one in handlers)
    try:
        return bool(pixels.get_decoder(syntax).is_available)
    except NotImplementedError:
        return False


def _by_pydicom(frame: bytes, data: pydicom.Dataset) -> Array:
    one = data.group_dataset(0x0028)
    one.NumberOfFrames = 1
    one.file_meta = data.file_meta
    one.is_implicit_VR, one.is_little_endian = False, True
    one.add_new(0x7FE00010, "OB", encaps.encapsulate([frame]))
    one["PixelData"].is_undefined_length = True
    numbers: Array = one.pixel_array
    return numbers


def _inflated(frame: bytes, pixels: Pixels) -> Array:
    count = pixels.shape[0] * pixels.shape[1]
    size = count * pixels.allocated
    data = zlib.decompressobj(-zlib.MAX_WBITS).decompress(frame, (size + 7) // 8)
    if pixels.allocated == 1:
        return np.unpackbits(np.frombuffer(data, np.uint8), bitorder="little")[:count]
    return np.frombuffer(data, f"<u{pixels.allocated // 8}")


def _check_size(pixels: Pixels, frame: bytes) -> None:
    """Raises LeaflightError if a compressed picture and its header have different sizes.

    A decoder would allocate memory for any size that the picture claims.
    """
    size = _size(frame)
    if size is not None and size != pixels.shape:
        raise LeaflightError(
            f"{pixels.file}: the compressed picture is {size[1]} x {size[0]}, but the header says "
            f"{pixels.shape[1]} x {pixels.shape[0]}: it is damaged, fetch it again."
        )


def _size(frame: bytes) -> tuple[int, int] | None:
    """Returns rows and columns in the header of a JPEG; None if it has none."""
    start = frame[:4096].find(_JPEG_2000)
    if start >= 0:
        right, bottom, left, top = unpack(">4I", frame[start + 8 : start + 24])
        return bottom - top, right - left
    place = 2 if frame[:2] == b"\xff\xd8" else len(frame)
    while place + 9 <= len(frame):
        marker, length = unpack(">xBH", frame[place : place + 4])
        if marker in _SIZES:
            rows, columns = unpack(">HH", frame[place + 5 : place + 9])
            return rows, columns
        place += 1 if marker == 0xFF else 2 + length
    return None


def _damaged(pixels: Pixels) -> LeaflightError:
    return LeaflightError(
        f"{pixels.file}: the compressed pixels ({UID(pixels.syntax).name}) cannot be decoded: the "
        "file is truncated or damaged, fetch it again."
    )
