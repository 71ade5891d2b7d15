# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenDX maps of APBS, VMD, MDAnalysis and fpocket, plain or gzipped.

https://apbs.readthedocs.io/en/latest/formats/opendx.html
"""

import io
import re
from dataclasses import dataclass, field
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from .checks import DEFLATE_MOST, check_size, data_file, matrix_at, text
from .encodings import NUMBERS
from .stored import StoredVolume, lengths
from .text_numbers import check_count, numbers_at, numbers_of
from .watched import is_packed, open_watched, read_values

_TYPES = NUMBERS | {"byte": "i1", "signed byte": "i1", "unsigned byte": "u1"}
# Upper bounds on the characters of a line of the header, and on its lines.
_MOST_LINE, _MOST_LINES = 1 << 12, 1 << 12
# Name of another file with the values, and their start in it.
_ELSEWHERE = re.compile(r'data file "?([^",]+)"?(?:,(\d+))?', re.IGNORECASE)


@dataclass
class _Map:
    """The grid of a file and its array. start: First byte of the numbers in the file `data`."""

    counts: list[int] = field(default_factory=list)
    origin: list[float] = field(default_factory=lambda: [0.0] * 3)
    deltas: list[list[float]] = field(default_factory=list)
    data: Path = Path()
    start: int = 0
    items: int = 0
    channels: int = 1
    dtype: np.dtype[Any] = np.dtype(np.float32)
    binary: bool = False


def open_volume(path: Path) -> StoredVolume:
    """Opens the first array over a regular grid; components of vectors are channels."""
    with open_watched(path, Progress()) as file:
        grid = _header(path, file)
    matrix = matrix_at(path, np.array(grid.deltas).T, grid.origin)
    dims = points = tuple(grid.counts)
    if len(points) != 3 or min(points) < 1:
        raise ValueError("counts")
    cells = tuple(max(1, n - 1) for n in points)
    if grid.items == prod(cells) != prod(points):
        # Values belong to connections (cells), in the middle of eight positions.
        dims = cells
        matrix[:3, 3] += matrix[:3, :3] @ [0.5, 0.5, 0.5]
    if grid.items != prod(dims):
        raise LeaflightError(
            f"{path}: the header claims {text([grid.items])} values for {text(points)} positions, "
            "so it is damaged; fetch the file again."
        )
    shape = (*dims, grid.channels)
    if grid.binary:
        most = DEFLATE_MOST if is_packed(grid.data) else 1
        check_size(path, shape, grid.dtype.itemsize, grid.data.stat().st_size, most)
    else:
        check_count(grid.data, shape)

    def load(_frame: int, channel: int, progress: Progress) -> Volume:
        values = _values(grid, shape, progress)[..., channel]
        return Volume(values.transpose(2, 1, 0), matrix, path.name.partition(".")[0])

    note = "The file has no unit; lengths are read as angstrom, as in maps of molecules."
    return StoredVolume(
        dims, grid.dtype, load, lengths(matrix), "Å", channels=grid.channels, notes=(note,)
    )


def _header(path: Path, file: io.BufferedIOBase) -> _Map:
    """Reads the header of the first array. Raises ValueError if there is none."""
    grid = _Map(data=path)
    for _ in range(_MOST_LINES):
        line = file.readline(_MOST_LINE)
        if not line:
            break
        words = line.decode("latin-1").split()
        lowered = " ".join(words).lower()
        if lowered.startswith("#"):
            continue
        if lowered.startswith("origin"):
            grid.origin = numbers_of(" ".join(words[1:4]))
        elif lowered.startswith("delta"):
            grid.deltas.append(numbers_of(" ".join(words[1:4])))
        elif "class gridpositions" in lowered:
            grid.counts = [int(n) for n in words[words.index("counts") + 1 :][:3]]
        elif "class array" in lowered and grid.counts:
            _read_array(grid, " ".join(words), file)
            return grid
    raise ValueError("no array")


def _read_array(grid: _Map, line: str, file: io.BufferedIOBase) -> None:
    """Reads the line about the values, which follow it or are in another file."""
    words = line.lower().replace('"', "").split()
    kind = _after(words, "type", "float")
    if kind in ("signed", "unsigned"):
        kind += " " + _after(words, kind, "")
    order = ">" if "msb" in words or "xdr" in words else "<"
    grid.dtype = np.dtype(order + _TYPES[kind])
    grid.items = int(_after(words, "items", "0"))
    grid.channels = int(_after(words, "shape", "1")) if _after(words, "rank", "0") != "0" else 1
    grid.binary = bool({"ieee", "binary", "xdr"} & set(words))
    if words[-1] == "follows":
        grid.start = file.tell()
        return
    found = _ELSEWHERE.search(line)
    if not found:
        raise ValueError("data")
    grid.data, grid.start = data_file(grid.data, found[1].strip()), int(found[2] or 0)


def _after(words: list[str], key: str, default: str) -> str:
    return words[words.index(key) + 1] if key in words else default


def _values(grid: _Map, shape: tuple[int, ...], progress: Progress) -> Array:
    if not grid.binary:
        return numbers_at(grid.data, grid.start, shape, grid.dtype, progress)
    with open_watched(grid.data, progress) as file:
        file.seek(grid.start)
        return read_values(file, shape, grid.dtype)
