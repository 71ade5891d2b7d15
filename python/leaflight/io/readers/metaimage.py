# SPDX-License-Identifier: GPL-3.0-or-later
"""MetaImage: a header of text, and values behind it (.mha) or in a file of their own (.mhd).

https://itk.org/Wiki/ITK/MetaIO/Documentation
"""

import zlib
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from ...volume.voxels import bytes_of, new_voxels
from .checks import (
    DEFLATE_MOST,
    check_matrix,
    check_scalar,
    check_shape,
    check_size,
    data_file,
    truncated,
)
from .stored import StoredVolume, lengths
from .watched import open_watched

_TYPES = {
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "i2",
    "MET_USHORT": "u2",
    "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8",
    "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}
# Where a header ends, at the latest.
_MOST = 1 << 16
# Packed bytes that are read at once.
_PIECE = 1 << 20
# ITK's world is left-posterior-superior, ours right-anterior-superior.
_FROM_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def open_volume(path: Path) -> StoredVolume:
    """Compressed or not, 3D or 4D; the last of four axes is the frame."""
    header, end = _header(path)
    shape = tuple(int(n) for n in header["DimSize"].split())
    check_shape(path, shape)
    if int(header.get("ElementNumberOfChannels", 1)) != 1:
        raise LeaflightError(
            f"{path}: it has several values a voxel, as colors have, but a volume needs one real "
            "number; convert the file first."
        )
    if header["ElementType"] not in _TYPES:
        raise LeaflightError(
            f"{path}: the type {header['ElementType'][:40]} is not known; convert the file first."
        )
    big = _true(header, "BinaryDataByteOrderMSB") or _true(header, "ElementByteOrderMSB")
    dtype = np.dtype((">" if big else "<") + _TYPES[header["ElementType"]])
    check_scalar(path, dtype)
    matrix = _matrix(path, header)
    data, offset = _data_file(path, header, end)
    compressed = _true(header, "CompressedData")
    stored = data.stat().st_size - offset
    check_size(data, shape, dtype.itemsize, stored, DEFLATE_MOST if compressed else 1)

    def load(frame: int, _channel: int, progress: Progress) -> Volume:
        if compressed:
            values = _inflated(data, offset, shape, dtype, progress)
        else:
            values = np.memmap(data, dtype, "r", offset, shape[::-1])
        return Volume(values[frame] if len(shape) == 4 else values, matrix, path.stem)

    frames = shape[3] if len(shape) == 4 else 1
    orientation = header.get("AnatomicalOrientation", "?")
    # ITK writes ??? for an unknown orientation.
    patient = "?" not in orientation
    return StoredVolume(shape[:3], dtype, load, lengths(matrix), "mm", frames, patient=patient)


def _header(path: Path) -> tuple[dict[str, str], int]:
    """(the fields, where the data begin if they follow)."""
    with open(path, "rb") as file:
        text = file.read(_MOST)
    fields, place = {}, 0
    while place < len(text):
        end = text.find(b"\n", place)
        end = len(text) if end < 0 else end
        key, equals, value = text[place:end].decode("latin-1").partition("=")
        place = end + 1
        if equals:
            fields[key.strip()] = value.strip()
        # By the format's rule the last one.
        if key.strip() == "ElementDataFile":
            break
    if not {"DimSize", "ElementType", "ElementDataFile"} <= fields.keys():
        raise LeaflightError(
            f"{path}: this is not a readable MetaImage header, or it is damaged; fetch it again."
        )
    return fields, place


def _data_file(path: Path, header: dict[str, str], end: int) -> tuple[Path, int]:
    """(the file that holds the values, where in it they begin)."""
    name, skip = header["ElementDataFile"], int(header.get("HeaderSize", 0))
    if name.upper() == "LOCAL":
        return path, end
    # -1 says that the values are the end of the file.
    return data_file(path, name), max(skip, 0)


def _inflated(
    path: Path, offset: int, shape: tuple[int, ...], dtype: np.dtype[Any], progress: Progress
) -> Array:
    """zlib, or gzip where the first bytes say so; not a byte more than asked for."""
    inflate = zlib.decompressobj(zlib.MAX_WBITS | 32)
    values = new_voxels(shape[::-1], dtype)
    left = bytes_of(values)
    with open_watched(path, progress, unpacked=False) as file:
        file.seek(offset)
        try:
            while left and (piece := file.read(_PIECE)):
                part = inflate.decompress(piece, len(left))
                left[: len(part)] = part
                left = left[len(part) :]
        except zlib.error:
            raise truncated(path, shape) from None
    if left:
        raise truncated(path, shape)
    return values


def _matrix(path: Path, header: dict[str, str]) -> Array:
    spacing = header.get("ElementSpacing", header.get("ElementSize", "1 1 1")).split()[:3]
    count = len(header["DimSize"].split())
    axes = np.eye(count)
    for key in ("TransformMatrix", "Rotation", "Orientation"):
        if key in header:
            axes = np.array(header[key].split(), np.float64).reshape(count, count)
            break
    origin = next((header[k] for k in ("Offset", "Position", "Origin") if k in header), "0 0 0")
    matrix = np.eye(4)
    # Row i is the direction of axis i.
    matrix[:3, :3] = axes[:3, :3].T * np.array(spacing, np.float64)
    matrix[:3, 3] = np.array(origin.split()[:3], np.float64)
    check_matrix(path, matrix)
    return _FROM_LPS @ matrix


def _true(header: dict[str, str], key: str) -> bool:
    return header.get(key, "False").lower() == "true"
