# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaussian cubes of densities and orbitals, plain or gzipped: https://gaussian.com/cubegen"""

import io
from pathlib import Path

import numpy as np

from ..._core import Progress
from ...volume.volume import Volume
from .checks import check_shape, matrix_at
from .stored import StoredVolume, lengths
from .text_numbers import check_count, numbers_at, numbers_of
from .watched import open_watched

# Characters of a column of values. Numbers may fill it without a space.
_COLUMN = 13
# Upper bound on the characters of a line of the header.
_LINE = 1 << 12


def open_volume(path: Path) -> StoredVolume:
    """Opens a cube. Orbitals are channels. Lengths are in bohr, or in angstrom if it says so."""
    with open_watched(path, Progress()) as file:
        lines = [file.readline(_LINE) for _ in range(6)]
        atoms, *origin = numbers_of(lines[2])[:4]
        axes = np.array([numbers_of(line)[:4] for line in lines[3:6]])
        _skip(file, abs(int(atoms)))
        orbitals = _orbitals(file, lines[2], atoms)
        start = file.tell()
    dims = tuple(abs(int(n)) for n in axes[:, 0])
    check_shape(path, (*dims, orbitals))
    matrix = matrix_at(path, axes[:, 1:].T, origin)
    check_count(path, (*dims, orbitals))
    # A negative number of voxels means angstrom.
    unit = "Å" if axes[0, 0] < 0 else "bohr"

    def load(_frame: int, channel: int, progress: Progress) -> Volume:
        values = numbers_at(path, start, (*dims, orbitals), np.float32, progress, _COLUMN)
        name = path.name.partition(".")[0]
        return Volume(values[..., channel].transpose(2, 1, 0), matrix, name)

    return StoredVolume(dims, np.dtype(np.float32), load, lengths(matrix), unit, channels=orbitals)


def _orbitals(file: io.BufferedIOBase, line: bytes, atoms: float) -> int:
    """Returns the number of values of a voxel.

    A negative count of atoms precedes a list of orbitals.
    """
    if atoms >= 0:
        fields = numbers_of(line)
        return int(fields[4]) if len(fields) > 4 else 1
    numbers = numbers_of(file.readline(_LINE))
    count = int(numbers[0])
    # The list may continue on further lines.
    while len(numbers) < 1 + count:
        more = numbers_of(file.readline(_LINE))
        if not more:
            raise ValueError("the list of orbitals")
        numbers += more
    return count


def _skip(file: io.BufferedIOBase, count: int) -> None:
    """Skips lines. A damaged file may claim billions of them."""
    for _ in range(count):
        if not file.readline():
            raise EOFError
