# SPDX-License-Identifier: GPL-3.0-or-later
"""VASP densities and potentials: CHGCAR, AECCAR, PARCHG, LOCPOT, ELFCAR; plain or gzipped.

https://www.vasp.at/wiki/index.php/CHGCAR
"""

import io
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from math import prod
from pathlib import Path

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from .checks import matrix_at
from .stored import StoredVolume, lengths
from .text_numbers import check_count, numbers_at, numbers_of
from .watched import open_watched

# Upper bounds on the characters of a line, and on lines between two grids, such as PAW spheres.
_MOST_LINE, _MOST_LINES = 1 << 16, 1 << 22
# Parts of file names. Densities are stored multiplied by the volume of the cell.
_DENSITIES, _OTHERS = ("CHG", "AECCAR"), ("LOCPOT", "ELF", "POT")
_SETS = {
    (True, 2): "channel 0 is the density of all electrons, 1 is spin up less spin down",
    (True, 4): "channel 0 is the density of all electrons, 1 to 3 are their magnetization",
    (False, 2): "channel 0 is spin up, 1 is spin down",
    (False, 4): "channel 0 is all electrons, 1 to 3 are their magnetization",
}


@dataclass
class _Grids:
    """The grids of a file.

    starts: First byte of the numbers of each grid.
    lattices: Lattice of each step of a run, vectors in rows.
    augmented: True if there are also values of PAW spheres.
    """

    dims: tuple[int, ...] = ()
    starts: list[int] = field(default_factory=list)
    lattices: list[Array] = field(default_factory=list)
    augmented: bool = False


def open_volume(path: Path) -> StoredVolume:
    """Opens a grid. Spins are channels, steps of a run frames. Densities are per cubic angstrom.

    The grid is periodic: after its last voxel comes the first one of the next cell.
    """
    with open_watched(path, Progress()) as file:
        grids = _grids(path, file)
    dims, frames = grids.dims, len(grids.lattices)
    channels = len(grids.starts) // frames
    matrices = [matrix_at(path, lattice.T / dims) for lattice in grids.lattices]
    is_density, notes = _quantity(path, grids)
    if (is_density, channels) in _SETS:
        notes += (f"The file holds {channels} grids: {_SETS[is_density, channels]}.",)

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        start = grids.starts[frame * channels + channel]
        values = numbers_at(path, start, dims[::-1], np.float32, progress)
        if is_density:
            values /= np.float32(abs(np.linalg.det(grids.lattices[frame])))
        return Volume(values, matrices[frame], path.name.partition(".")[0])

    sizes = lengths(matrices[0])
    return StoredVolume(dims, np.dtype(np.float32), load, sizes, "Å", frames, channels, notes=notes)


def _quantity(path: Path, grids: _Grids) -> tuple[bool, tuple[str, ...]]:
    """Returns (True if the values are a density, notes about guesses)."""
    name = path.name.upper()
    if grids.augmented or any(word in name for word in _DENSITIES):
        return True, ()
    if any(word in name for word in _OTHERS):
        return False, ()
    return True, (
        "The values are divided by the volume of the cell, as in CHGCAR, unless the file name "
        "contains LOCPOT or ELFCAR.",
    )


def _grids(path: Path, file: io.BufferedIOBase) -> _Grids:
    """Reads everything but the numbers. Raises ValueError, and LeaflightError without a grid."""
    grids, lines = _Grids(), iter(lambda: file.readline(_MOST_LINE), b"")
    title = next(lines, b"")
    grids.lattices.append(_structure(lines))
    counts, others = [b""], 0
    for line in lines:
        words, others = line.split(), others + 1
        if not grids.dims and len(words) == 3 and all(map(bytes.isdigit, words)):
            counts, grids.dims = words, tuple(map(int, words))
            check_count(path, grids.dims)
        if words == counts:
            grids.starts.append(file.tell())
            _skip(lines, prod(grids.dims))
            others = 0
        elif grids.dims and title.strip() and line == title:
            grids.lattices.append(_structure(lines))
        elif words[:1] == [b"augmentation"]:
            grids.augmented = True
        if others > _MOST_LINES:
            raise ValueError("no grid")
    if not grids.starts:
        raise LeaflightError(
            f"{path}: the file holds the structure of a crystal, but no values on a grid; open "
            "CHGCAR, LOCPOT or a similar file."
        )
    if min(grids.dims) < 1 or len(grids.starts) % len(grids.lattices):
        raise ValueError("grids")
    return grids


def _structure(lines: Iterator[bytes]) -> Array:
    """Returns the lattice in angstrom, vectors in rows, and skips the atoms."""
    scales = numbers_of(next(lines, b""))
    lattice = np.array([numbers_of(next(lines, b""))[:3] for _ in range(3)]).reshape(3, 3)
    words = next(lines, b"").split()
    if not words or not words[0].isdigit():
        # Skip the names of the elements.
        words = next(lines, b"").split()
    atoms = sum(int(word) for word in words if word.isdigit())
    # Skip the line of selective dynamics before the kind of coordinates.
    if next(lines, b"").strip()[:1].lower() == b"s":
        next(lines, b"")
    deque(islice(lines, atoms), maxlen=0)
    if len(scales) == 3:
        return lattice * scales
    # A negative scale is the volume of the cell.
    size = (-scales[0] / abs(np.linalg.det(lattice))) ** (1 / 3) if scales[0] < 0 else scales[0]
    return lattice * size


def _skip(lines: Iterator[bytes], count: int) -> None:
    """Skips `count` numbers. Each line but the last has as many numbers as the first."""
    first = len(next(lines, b"").split())
    if not first:
        raise ValueError("no numbers")
    deque(islice(lines, -(-count // first) - 1), maxlen=0)
