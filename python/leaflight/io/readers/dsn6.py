# SPDX-License-Identifier: GPL-3.0-or-later
"""Electron densities in DSN6 and BRIX files of the program O, one byte a value.

http://www.uoxray.uoregon.edu/tnt/manual/node104.html
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..._core import Progress
from ...volume.volume import Volume
from .checks import DEFLATE_MOST, cell_axes, check_shape, check_size, matrix_at
from .stored import StoredVolume, lengths
from .watched import is_packed, open_watched, read_values

_HEADER = 512
# Number of values of a brick along each axis.
_SIDE = 8
_BRIX = b":-)"
_NUMBERS = r"\s+([-+.\deE]+)"
_FIELDS = {"origin": 3, "extent": 3, "grid": 3, "cell": 6, "prod": 1, "plus": 1}


@dataclass(frozen=True)
class _Header:
    """The header of a map. A density is (byte - plus) / prod.

    start, dims: First point and number of points.
    grid: Steps along the edges of the cell.
    swapped: True if each pair of bytes is swapped.
    """

    start: tuple[int, ...]
    dims: tuple[int, ...]
    grid: tuple[int, ...]
    cell: tuple[float, ...]
    prod: float
    plus: float
    swapped: bool


def open_volume(path: Path) -> StoredVolume:
    """Opens the part of the cell that the file covers, in angstrom."""
    with open_watched(path, Progress()) as file:
        head = file.read(_HEADER)
    header = _of_brix(head) if head.startswith(_BRIX) else _of_dsn6(head)
    dims = header.dims
    check_shape(path, dims)
    if min(header.grid) < 1 or not header.prod:
        raise ValueError("the grid of the cell")
    axes = cell_axes(header.cell[:3], header.cell[3:]) / header.grid
    matrix = matrix_at(path, axes, axes @ header.start)
    bricks = tuple(-(-n // _SIDE) for n in dims)[::-1]
    packed = is_packed(path)
    stored = path.stat().st_size - (0 if packed else _HEADER)
    check_size(path, (*bricks, _SIDE**3), 1, max(0, stored), DEFLATE_MOST if packed else 1)

    def load(_frame: int, _channel: int, progress: Progress) -> Volume:
        with open_watched(path, progress) as file:
            file.seek(_HEADER)
            values = read_values(file, (*bricks, _SIDE, _SIDE, _SIDE), np.uint8)
        if header.swapped:
            values = values.reshape(-1, 2)[:, ::-1].reshape(values.shape)
        joined = values.transpose(0, 3, 1, 4, 2, 5).reshape([n * _SIDE for n in bricks])
        kept = joined[tuple(slice(n) for n in dims[::-1])].astype(np.float32)
        kept = (kept - np.float32(header.plus)) / np.float32(header.prod)
        return Volume(kept, matrix, path.name.partition(".")[0])

    return StoredVolume(dims, np.dtype(np.float32), load, lengths(matrix), "Å")


def _of_brix(head: bytes) -> _Header:
    """Reads a header of words, each followed by its numbers."""
    line, found = head.decode("latin-1"), {}
    for word, count in _FIELDS.items():
        match = re.search(word + _NUMBERS * count, line, re.IGNORECASE)
        found[word] = [float(number) for number in match.groups()] if match else []
    start, dims, grid = (tuple(map(int, found[word])) for word in ("origin", "extent", "grid"))
    (product,), (plus,) = found["prod"], found["plus"]
    return _Header(start, dims, grid, tuple(found["cell"]), product, plus, False)


def _of_dsn6(head: bytes) -> _Header:
    """Reads a header of 16-bit integers. The number 100 shows their byte order."""
    for order in "<>":
        words = [int(word) for word in np.frombuffer(head, order + "i2", 19)]
        if words[18] == 100:
            break
    else:
        raise ValueError("the byte order")
    start, dims, grid = (tuple(words[at : at + 3]) for at in (0, 3, 6))
    cell = tuple(word / words[17] for word in words[9:15])
    return _Header(start, dims, grid, cell, words[15] / 100, float(words[16]), order == ">")
