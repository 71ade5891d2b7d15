# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids in XCrySDen's .xsf files, which Quantum ESPRESSO, SIESTA and others write.

http://www.xcrysden.org/doc/XSF.html
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from .checks import check_matrix, choose_named, text
from .stored import StoredVolume, lengths
from .text_numbers import check_count, numbers_at, numbers_of
from .watched import open_watched

# Upper bound on the characters of a line.
_MOST_LINE = 1 << 16
_WORDS = ("BEGIN_DATAGRID_3D", "DATAGRID_3D")


@dataclass(frozen=True)
class _Grid:
    """A grid of a file. start: First byte of its numbers, x fastest."""

    dims: tuple[int, ...]
    matrix: Array
    start: int


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """Opens a grid. Several are datasets. The last points may repeat the first ones."""
    found = _grids(path)
    names = tuple(found)
    if not names:
        raise LeaflightError(
            f"{path}: the file holds no three-dimensional grid (DATAGRID_3D); choose another file."
        )
    name = choose_named(path, names, dataset)
    grid = found[name]
    if min(grid.dims) < 2:
        raise LeaflightError(
            f"{path}: the grid has {text(grid.dims)} points, which are too few; choose another "
            "file."
        )
    check_matrix(path, grid.matrix)

    def load(_frame: int, _channel: int, progress: Progress) -> Volume:
        values = numbers_at(path, grid.start, grid.dims[::-1], np.float32, progress)
        return Volume(values, grid.matrix, path.name.partition(".")[0])

    size = lengths(grid.matrix)
    return StoredVolume(grid.dims, np.dtype(np.float32), load, size, "Å", datasets=names)


def _grids(path: Path) -> dict[str, _Grid]:
    """Returns the grids of a file, by name. Raises ValueError."""
    found: dict[str, _Grid] = {}
    with open_watched(path, Progress()) as file:
        lines = iter(lambda: file.readline(_MOST_LINE), b"")
        for line in lines:
            # Skip lines of numbers quickly.
            if b"DATAGRID_3D" not in line:
                continue
            word = line.decode("latin-1").split()[0]
            key = next((key for key in _WORDS if word.upper().startswith(key)), None)
            if key is None:
                continue
            dims, matrix = _placed(path, lines)
            name = word[len(key) :].lstrip("_") or "grid"
            while name in found:
                name += "'"
            found[name] = _Grid(dims, matrix, file.tell())
    return found


def _placed(path: Path, lines: Iterator[bytes]) -> tuple[tuple[int, ...], Array]:
    """Returns (dims, matrix) from the number of points, the origin and three spanning vectors."""
    numbers: list[float] = []
    while len(numbers) < 15:
        numbers += numbers_of(next(lines, b"end"))
    if len(numbers) != 15:
        raise ValueError("the header of a grid")
    dims = tuple(int(n) for n in numbers[:3])
    if min(dims) < 1:
        raise ValueError("the number of points")
    check_count(path, dims)
    matrix = np.eye(4)
    steps = np.maximum(1, np.array(dims) - 1)
    matrix[:3, :3], matrix[:3, 3] = np.reshape(numbers[6:], (3, 3)).T / steps, numbers[3:6]
    return dims, matrix
