# SPDX-License-Identifier: GPL-3.0-or-later
"""MetaImage: a text header, with values behind it (.mha) or in other files (.mhd).

https://docs.itk.org/en/latest/learn/metaio.html
"""

from collections.abc import Sequence
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.axes import FROM_LPS
from ...volume.units import unit_of
from ...volume.volume import Volume
from .checks import check_shape, matrix_at
from .encodings import NUMBERS
from .stored import StoredVolume, lengths
from .value_files import Index, ValueFiles, data_files

# MET_LONG has four bytes on every machine, as in ITK.
_TYPES = NUMBERS | {"ascii char": "i1", "long": "i4", "ulong": "u4", "ulong long": "u8"}
_WIDE = (
    "Values of type MET_LONG are read with eight bytes each, because that fits the size of the "
    "file."
)
# Upper bound on the bytes of a header, including file names.
_MOST = 1 << 20


def open_volume(path: Path) -> StoredVolume:
    """Opens a 3D or 4D image, compressed, text or raw. The last of four axes is the frame."""
    header, listed, end = _header(path)
    dims = tuple(int(n) for n in header["DimSize"].split())
    check_shape(path, dims)
    channels = int(header.get("ElementNumberOfChannels", 1))
    if not 0 < channels < 1 << 16:
        raise LeaflightError(
            f"{path}: the header claims {channels} values per voxel; correct the header."
        )
    shape = (*dims[::-1], channels) if channels > 1 else dims[::-1]
    matrix = _matrix(path, header)
    stored = _value_files(path, header, listed, end, dims)
    dtype, notes = _type(path, header, stored, shape)
    stored.check(shape, dtype)

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        index: Index = (slice(None),) * 3
        index = (frame, *index) if len(dims) == 4 else index
        index = (*index, channel) if channels > 1 else index
        return Volume(stored.read(shape, dtype, index, progress), matrix, path.stem)

    return StoredVolume(
        dims=dims[:3],
        dtype=dtype,
        load=load,
        voxel_size=lengths(matrix),
        unit=unit_of(header.get("DistanceUnits")) or "mm",
        frames=dims[3] if len(dims) == 4 else 1,
        channels=channels,
        # ??? is ITK's unknown orientation.
        patient="?" not in header.get("AnatomicalOrientation", "?"),
        notes=notes,
    )


def _header(path: Path) -> tuple[dict[str, str], list[str], int]:
    """Returns (fields, file names after them if any, start of the data if they follow)."""
    with open(path, "rb") as file:
        text = file.read(_MOST)
    fields, place = {}, 0
    while place < len(text) and "ElementDataFile" not in fields:
        end = text.find(b"\n", place)
        end = len(text) if end < 0 else end
        line = text[place:end].decode("latin-1")
        place = end + 1
        # The name of the data is the last field, by the format's rule.
        cut = min((i for i in map(line.find, "=:") if i >= 0), default=-1)
        if cut >= 0:
            fields[line[:cut].strip()] = line[cut + 1 :].strip()
    if not {"DimSize", "ElementType", "ElementDataFile"} <= fields.keys():
        raise ValueError("the fields")
    listed = text[place:].decode("latin-1").splitlines()
    return fields, listed if fields["ElementDataFile"][:4].upper() == "LIST" else [], place


def _value_files(
    path: Path, header: dict[str, str], listed: list[str], end: int, dims: tuple[int, ...]
) -> ValueFiles:
    name, skip = header["ElementDataFile"], int(header.get("HeaderSize", 0))
    text = not _true(header.get("BinaryData", "True"))
    packed = _true(header.get("CompressedData", "False")) and not text
    local = name.upper() == "LOCAL"
    if local:
        files: tuple[Path, ...] = (path,)
    elif not (path.parent / name).exists() and (path.parent / f"{name}.gz").exists():
        # The file was compressed by gzip, which ITK reads, too.
        files, packed, text = data_files(path, f"{name}.gz", listed, dims), True, False
    else:
        files = data_files(path, name, listed, dims)
    # HeaderSize counts from the first byte of the file, even if values follow the header.
    start = skip if skip > 0 else end if local else 0
    encoding = "text" if text else "gzip" if packed else "raw"
    return ValueFiles(files, encoding, start, skip=-1 if skip < 0 and not packed else 0)


def _type(
    path: Path, header: dict[str, str], stored: ValueFiles, shape: Sequence[int]
) -> tuple[np.dtype[Any], tuple[str, ...]]:
    """Returns (type of the values, notes about it)."""
    name = header["ElementType"].lower().removeprefix("met_").removesuffix("_array")
    name = name.replace("_", " ")
    if name not in _TYPES:
        raise LeaflightError(
            f"{path}: the type {header['ElementType'][:40]} is unknown; convert the file first."
        )
    orders = [header.get(f"{key}ByteOrderMSB", "False") for key in ("BinaryData", "Element")]
    dtype = np.dtype((">" if any(map(_true, orders)) else "<") + _TYPES[name])
    count = prod(shape)
    if name in ("long", "ulong") and stored.holds(8 * count):
        return np.dtype(f"{dtype.byteorder}{dtype.kind}8"), (_WIDE,)
    return dtype, ()


def _matrix(path: Path, header: dict[str, str]) -> Array:
    count = len(header["DimSize"].split())
    spacing = _numbers(header, "1 " * count, "ElementSpacing", "ElementSize")
    identity = " ".join(map(str, np.eye(count).ravel()))
    names = ("TransformMatrix", "Rotation", "Orientation", "ElementDirection")
    axes = _numbers(header, identity, *names).reshape(count, count)
    origin = _numbers(header, "0 0 0", "Offset", "Position", "Origin", "ElementOrigin")[:3]
    # Row i is the direction of axis i.
    return FROM_LPS @ matrix_at(path, axes[:3, :3].T * spacing[:3], origin)


def _numbers(header: dict[str, str], default: str, *keys: str) -> Array:
    """Returns the numbers of the first key that the header has. Older files have other keys."""
    words = next((header[key] for key in keys if key in header), default)
    return np.array(words.split(), np.float64)


def _true(word: str) -> bool:
    """Returns the truth of a word as ITK does: by its first letter, or 1."""
    return word[:1].lower() in ("t", "y", "1")
