# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices of amira and Avizo (AmiraMesh, .am): a text header, then the values of each array."""

import mmap
import re
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.units import unit_of
from ...volume.volume import Volume
from .checks import check_matrix, check_shape, choose_named
from .encodings import NUMBERS
from .stored import StoredVolume, lengths
from .value_files import Index, ValueFiles

_TYPES = NUMBERS | dict.fromkeys(("byte", "ubyte"), "u1")
_FIRST = re.compile(
    rb"#\s*(?:AmiraMesh|Avizo|HyperMesh)\b.*?\b(ASCII|BINARY(?:-LITTLE-ENDIAN)?)\b.*", re.IGNORECASE
)
# The declaration of an array: location, type, components, name, number, compression.
_ARRAY = re.compile(
    r"^[ \t]*(\w+)\s*\{\s*(\w+)\s*(?:\[\s*(\d{1,4})\s*\])?\s+([\w-]+)\s*\}\s*=?\s*@(\d{1,4})"
    r"(?:\s*\(\s*(\w+)\s*,\s*(\d{1,15})\s*\))?",
    re.MULTILINE,
)
_MARK, _LINE_MARK = (re.compile(begin + rb"@(\d{1,4})[^\n]*\n") for begin in (rb"\s*", rb"\n"))
_ENCODINGS = {"HxZip": "gzip", "HxByteRLE": "byte-rle"}
# Upper bound on the bytes of a header, with the materials of all its labels.
_MOST, _MARK_MOST = 1 << 22, 200


@dataclass(frozen=True)
class _Lattice:
    """An array of the lattice: type, number of values of a point, and start of the values."""

    dtype: np.dtype[Any]
    components: int
    stored: ValueFiles


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """Opens arrays on uniform points. Components of vectors are channels."""
    order, header, end = _header(path)
    sizes = re.search(r"^[ \t]*define\s+Lattice\s+(\d{1,9})\s+(\d{1,9})\s+(\d{1,9})", header, re.M)
    kind = re.search(r'CoordType\s+"([^"]*)"', header)
    if not sizes:
        raise LeaflightError(
            f"{path}: the file holds no lattice, so it is not a volume; save the volume itself."
        )
    if kind and kind[1] != "uniform":
        raise LeaflightError(
            f"{path}: the points of the lattice are not evenly spaced; resample the volume in "
            "amira first."
        )
    dims = tuple(map(int, sizes.groups()))
    check_shape(path, dims)
    matrix = _matrix(path, header, dims)
    arrays = _arrays(path, header, order, end, dims)
    name = choose_named(path, tuple(arrays), dataset)
    lattice = arrays[name]
    count = lattice.components
    shape = (*dims[::-1], count) if count > 1 else dims[::-1]
    lattice.stored.check(shape, lattice.dtype)

    def load_array(_frame: int, channel: int, progress: Progress) -> Volume:
        index: Index = (slice(None),) * 3
        index = (*index, channel) if count > 1 else index
        values = lattice.stored.read(shape, lattice.dtype, index, progress)
        return Volume(values, matrix, path.stem)

    unit = re.search(r'Units\s*\{[^}]{0,999}?Coordinates\s+"([^"]*)"', header)
    return StoredVolume(
        dims=dims,
        dtype=lattice.dtype,
        load=load_array,
        voxel_size=lengths(matrix),
        unit=unit_of(unit[1]) if unit else "",
        channels=count,
        datasets=tuple(arrays),
    )


def _header(path: Path) -> tuple[str, str, int]:
    """Returns (byte order, "" for text; the header; first byte of the data section)."""
    with open(path, "rb") as file:
        text = file.read(_MOST)
    first = _FIRST.match(text)
    found = re.search(rb"\n# Data section follows[^\n]*\n", text) or re.search(rb"\n(?=@\d)", text)
    if not first or not found:
        raise ValueError("the first line")
    order = {b"ASCII": "", b"BINARY": ">"}.get(first[1].upper(), "<")
    return order, text[: found.start()].decode("utf-8", "replace"), found.end()


def _arrays(
    path: Path, header: str, order: str, end: int, dims: tuple[int, ...]
) -> dict[str, _Lattice]:
    """Returns the numeric arrays on the lattice, by name."""
    counts = {
        found[1]: prod(map(int, found[2].split()))
        for found in re.finditer(r"^[ \t]*define\s+(\w+)\s+(\d[\d ]{0,60})\s*$", header, re.M)
    }
    declared = [found for found in _ARRAY.finditer(header) if found[2] in _TYPES]
    bytes_of = {}
    for found in declared:
        size = int(found[3] or 1) * np.dtype(_TYPES[found[2]]).itemsize
        bytes_of[int(found[5])] = int(found[7] or size * counts.get(found[1], 0))
    begins = _begins(path, end, None if not order else bytes_of)
    arrays = {}
    for found in declared:
        if found[1] != "Lattice" or int(found[5]) not in begins:
            continue
        if (found[6] or "HxZip") not in _ENCODINGS:
            raise LeaflightError(
                f"{path}: the compression {found[6][:40]} is unknown; save the file uncompressed."
            )
        encoding = _ENCODINGS[found[6]] if found[6] else "raw" if order else "text"
        stored = ValueFiles((path,), encoding, start=begins[int(found[5])])
        dtype = np.dtype(order + _TYPES[found[2]])
        arrays[found[4]] = _Lattice(dtype, int(found[3] or 1), stored)
    return arrays


def _begins(path: Path, end: int, sizes: dict[int, int] | None) -> dict[int, int]:
    """Returns the first byte of the values of each number.

    sizes: Bytes of binary values, None for text.
    """
    begins: dict[int, int] = {}
    with open(path, "rb") as file:
        if sizes is None:
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as text:
                for found in _LINE_MARK.finditer(text, max(0, end - 1)):
                    begins[int(found[1])] = found.end()
            return begins
        while True:
            file.seek(end)
            mark = _MARK.match(file.read(_MARK_MOST))
            if not mark or int(mark[1]) in begins:
                return begins
            begins[int(mark[1])] = end + mark.end()
            end += mark.end() + sizes.get(int(mark[1]), 0)


def _matrix(path: Path, header: str, dims: tuple[int, ...]) -> Array:
    """Returns the matrix of the box, which spans the first to the last point, and a rotation."""
    matrix = np.eye(4)
    box = _numbers(header, "BoundingBox", 6)
    if box is not None:
        low, high = box.reshape(3, 2).T
        steps = (high - low) / np.maximum(1, np.array(dims) - 1)
        matrix[:3, :3] = np.diag(np.where(steps > 0, steps, 1.0))
        matrix[:3, 3] = low
    turn = _numbers(header, "TransformationMatrix", 16)
    if turn is not None:
        # Matrices are column by column, as in OpenGL.
        matrix = turn.reshape(4, 4).T @ matrix
    check_matrix(path, matrix)
    return matrix


def _numbers(header: str, name: str, count: int) -> Array | None:
    found = re.search(rf"\b{name}\s+((?:[-+.\deE]+\s*){{{count}}})", header)
    if not found:
        return None
    numbers = np.array(found[1].split()[:count], np.float64)
    return numbers if numbers.shape == (count,) else None
