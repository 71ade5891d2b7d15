# SPDX-License-Identifier: GPL-3.0-or-later
"""Electron densities from the structure factors of .mtz files, through gemmi.

https://gemmi.readthedocs.io/en/latest/hkl.html
It runs in a subprocess, which alone imports gemmi, because damaged files may request any amount of
memory.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.memory import new_voxels
from ...volume.volume import Volume
from ..reader_process import ReaderProcess
from .checks import cell_axes, choose_named, listed, matrix_at
from .stored import StoredVolume, lengths
from .watched import STAGE, begin

# Voxels per shortest wavelength, gemmi's default for maps.
_SAMPLES = 3.0
# Upper bound on the waves along an edge of the cell.
_MOST_WAVES = 1 << 14
# Columns of amplitudes that refinement programs write for display, the most common first.
_BEST = ("FWT", "2FOFCWT", "2FOFCWT_fill", "2FOFCWT_no_fill")


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """Opens one cell of the crystal. Pairs of amplitudes and phases are datasets.

    The grid is periodic: after its last voxel comes the first one of the next cell.
    """
    with _reader(path, "list_maps") as process:
        found = process.answer()
    names = tuple(found["maps"])
    if not names:
        raise LeaflightError(
            f"{path}: the file holds no phases, which a map needs; open the .mtz of a refinement "
            "program, with columns such as FWT and PHWT."
        )
    amplitudes = {name.partition("/")[0]: name for name in reversed(names)}
    best = next((amplitudes[best] for best in _BEST if best in amplitudes), None)
    name = choose_named(path, names, amplitudes.get(dataset, dataset) if dataset else best)
    notes: tuple[str, ...] = ()
    if dataset is None and len(names) > 1:
        others = listed([other for other in names if other != name])
        notes = (f"The map of {name} is computed; other datasets are {others}.",)
    dims = tuple(int(n) for n in found["dims"])
    matrix = matrix_at(path, cell_axes(found["cell"][:3], found["cell"][3:]) / dims)

    def load(_frame: int, _channel: int, progress: Progress) -> Volume:
        values = new_voxels(dims[::-1], np.float32)
        begin(progress, STAGE, values.nbytes)
        with _reader(path, "compute_map", *name.split("/")) as process:
            if process.answer() != list(dims):
                raise process.died()
            process.fill(values, progress)
        return Volume(values, matrix, path.name.partition(".")[0])

    size = lengths(matrix)
    return StoredVolume(dims, np.dtype(np.float32), load, size, "Å", datasets=names, notes=notes)


def _reader(path: Path, function: str, *options: object) -> ReaderProcess:
    return ReaderProcess(path, "MTZ file", __name__, function, *options)


def list_maps(path: Path) -> tuple[dict[str, Any], tuple[()]]:
    """Returns the maps that can be computed, their dims and the cell. Runs in the subprocess."""
    import gemmi

    mtz = gemmi.read_mtz_file(str(path))
    maps = _pairs([(column.label, column.type) for column in mtz.columns])
    if not maps:
        return {"maps": ()}, ()
    # gemmi never ends for other cells.
    waves = np.asarray(mtz)[:, :3]
    if not (len(waves) and np.isfinite(waves).all() and np.abs(waves).max() < _MOST_WAVES):
        raise ValueError("the indices of the waves")
    cell, dims = mtz.cell, list(mtz.get_size_for_hkl(sample_rate=_SAMPLES))
    sides = [cell.a, cell.b, cell.c, cell.alpha, cell.beta, cell.gamma]
    return {"maps": maps, "dims": dims, "cell": sides}, ()


def _pairs(columns: Sequence[tuple[str, str]]) -> list[str]:
    """Returns each column of phases with the last column of amplitudes before it."""
    pairs, amplitudes = [], None
    for label, kind in columns:
        if kind == "F":
            amplitudes = label
        elif kind == "P" and amplitudes is not None:
            pairs.append(f"{amplitudes}/{label}")
            amplitudes = None
    return pairs


def compute_map(path: Path, amplitudes: str, phases: str) -> tuple[list[int], Iterable[Array]]:
    """Returns the density [z, y, x] of a whole cell. Runs in the subprocess."""
    import gemmi

    mtz = gemmi.read_mtz_file(str(path))
    grid = mtz.transform_f_phi_to_map(amplitudes, phases, sample_rate=_SAMPLES)
    values = np.ascontiguousarray(np.array(grid, np.float32).transpose(2, 1, 0))
    return [grid.nu, grid.nv, grid.nw], [values]
