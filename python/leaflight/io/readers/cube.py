# SPDX-License-Identifier: GPL-3.0-or-later
"""Gaussian's cubes of densities and orbitals, plain or gzipped: https://gaussian.com/cubegen"""

import gzip
import zlib
from pathlib import Path
from typing import TextIO

import numpy as np

from ..._core import LeaflightError, Progress
from ...volume.volume import Volume
from .checks import check_matrix, text, truncated
from .stored import StoredVolume, lengths

# A number takes at least so many characters, with the space before it.
_SHORTEST = 2


def open_volume(path: Path) -> StoredVolume:
    """Several orbitals in one file are channels; lengths are in bohr, or in angstrom if it says."""
    with _opened(path) as file:
        lines = [file.readline() for _ in range(6)]
        try:
            atoms, *origin = _numbers(lines[2])[:4]
            axes = np.array([_numbers(line)[:4] for line in lines[3:6]])
            orbitals = _orbitals(file, lines[2], int(atoms))
        except (IndexError, ValueError, EOFError, zlib.error):
            raise LeaflightError(
                f"{path}: this is not a readable Gaussian cube, or it is damaged; fetch it again."
            ) from None
    dims = tuple(abs(int(n)) for n in axes[:, 0])
    if min(dims) < 1 or orbitals < 1:
        raise LeaflightError(f"{path}: the header claims {text(dims)} voxels; it is damaged.")
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes[:, 1:].T, origin[:3]
    check_matrix(path, matrix)
    _check_claim(path, dims, orbitals)
    # A negative number of voxels says angstrom.
    unit = "Å" if axes[0, 0] < 0 else "bohr"

    def load(_frame: int, channel: int, _progress: Progress) -> Volume:
        with _opened(path) as file:
            _skip(file, 6 + abs(int(atoms)))
            if atoms < 0:
                _orbitals(file, lines[2], int(atoms), at_list=True)
            values = np.array(file.read().replace("D", "E").split(), np.float32)
        if values.size < np.prod(dims) * orbitals:
            raise truncated(path, dims)
        values = values[: np.prod(dims) * orbitals].reshape(*dims, orbitals)
        return Volume(values[..., channel].transpose(2, 1, 0), matrix, path.name.partition(".")[0])

    return StoredVolume(dims, np.dtype(np.float32), load, lengths(matrix), unit, channels=orbitals)


def _opened(path: Path) -> TextIO:
    if path.suffix.lower() == ".gz":
        return gzip.open(path, "rt", encoding="latin-1")
    return open(path, "rt", encoding="latin-1")


def _orbitals(file: TextIO, line: str, atoms: int, at_list: bool = False) -> int:
    """How many values a voxel has; reads the list of orbitals, which a negative count announces."""
    if atoms >= 0:
        fields = line.split()
        return int(fields[4]) if len(fields) > 4 else 1
    _skip(file, 0 if at_list else -atoms)
    numbers = _numbers(file.readline())
    count = int(numbers[0])
    # The list goes on over as many lines as it needs.
    while len(numbers) < 1 + count:
        more = _numbers(file.readline())
        if not more:
            raise ValueError("the list of orbitals")
        numbers += more
    return count


def _skip(file: TextIO, count: int) -> None:
    """So many lines, of which a damaged file may claim billions."""
    for _ in range(count):
        if not file.readline():
            raise EOFError


def _numbers(line: str) -> list[float]:
    return [float(number) for number in line.split()]


def _check_claim(path: Path, dims: tuple[int, ...], orbitals: int) -> None:
    most = 1032 if path.suffix.lower() == ".gz" else 1
    claimed = int(np.prod(dims, dtype=np.float64)) * orbitals * _SHORTEST
    if claimed > path.stat().st_size * most:
        raise truncated(path, dims)
