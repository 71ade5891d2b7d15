# SPDX-License-Identifier: GPL-3.0-or-later
"""MRC2014 and CCP4 maps through mrcfile: electron microscopy and crystallography, in angstrom.

https://www.ccpem.ac.uk/mrc_format/mrc2014.php
"""

import gzip
import io
from pathlib import Path
from typing import Any

import mrcfile
import numpy as np
from mrcfile.mrcinterpreter import MrcInterpreter

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from .checks import DEFLATE_MOST, check_matrix, check_scalar, check_size
from .stored import StoredVolume, lengths
from .unit_cell import cell_axes
from .watched import is_packed, open_watched, read_values

# Bytes of the header, and where the length of the text behind it stands.
_HEADER, _LENGTH = 1024, 92


def open_volume(path: Path) -> StoredVolume:
    """The axes of the file may run along x, y and z in any order; stacks of volumes are frames."""
    header = _header(path)
    dtype = mrcfile.utils.data_dtype_from_header(header)
    check_scalar(path, dtype)
    counts = [int(header[name]) for name in ("nx", "ny", "nz")]
    packed = is_packed(path)
    stored = path.stat().st_size - (0 if packed else _HEADER + int(header["nsymbt"]))
    check_size(path, counts, dtype.itemsize, max(0, stored), DEFLATE_MOST if packed else 1)
    if min(counts) < 1:
        raise LeaflightError(f"{path}: the header claims no voxels; the file is damaged.")
    # Columns, rows and sections run along these; x is 0. Old files leave them out.
    axes = [int(header[name]) - 1 for name in ("mapc", "mapr", "maps")]
    axes = axes if sorted(axes) == [0, 1, 2] else [0, 1, 2]
    frames, depth = 1, int(header["mz"])
    if int(header["ispg"]) >= 401 and 0 < depth < counts[2] and counts[2] % depth == 0:
        frames, counts[2] = counts[2] // depth, depth
    dims = [0, 0, 0]
    for axis, count in zip(axes, counts):
        dims[axis] = count
    matrix = _matrix(path, header, axes)
    # Of the array's axes, which are sections, rows, columns, those that run along z, y and x.
    order = [2 - axes.index(axis) for axis in (2, 1, 0)]

    def load(frame: int, _channel: int, progress: Progress) -> Volume:
        shape = (frames * counts[2], counts[1], counts[0])
        values = _values(path, header, dtype, shape, progress)
        return Volume(
            values[frame * counts[2] : (frame + 1) * counts[2]].transpose(order),
            matrix,
            path.name.partition(".")[0],
        )

    return StoredVolume(tuple(dims), dtype, load, lengths(matrix), "Å", frames)


def _header(path: Path) -> Array:
    """The fields of the header, in the byte order that mrcfile finds.

    It never sees the length of the text behind them, which it would believe.
    """
    packed = is_packed(path)
    with (gzip.open if packed else open)(path, "rb") as file:
        head = file.read(_HEADER)
    without = head[:_LENGTH] + bytes(4) + head[_LENGTH + 4 :]
    interpreter = MrcInterpreter(io.BytesIO(without), permissive=True, header_only=True)
    header: Array = interpreter.header.copy()
    header["nsymbt"] = np.frombuffer(head, header["nsymbt"].dtype, 1, _LENGTH)[0]
    length = int(header["nsymbt"])
    if length < 0:
        raise LeaflightError(f"{path}: the header claims {length} bytes of text; it is damaged.")
    check_size(path, (length,), 1, path.stat().st_size, DEFLATE_MOST if packed else 1)
    return header


def _values(
    path: Path, header: Array, dtype: np.dtype[Any], shape: tuple[int, ...], progress: Progress
) -> Array:
    offset = _HEADER + int(header["nsymbt"])
    if not is_packed(path):
        return np.memmap(path, dtype, "r", offset, shape)
    with open_watched(path, progress) as file:
        file.seek(offset)
        return read_values(file, shape, dtype)


def _matrix(path: Path, header: Array, axes: list[int]) -> Array:
    """From the cell, whose angles need not be right ones."""
    sizes = [float(header["cella"][name]) for name in "xyz"]
    angles = [float(header["cellb"][name]) for name in ("alpha", "beta", "gamma")]
    cell = cell_axes(np.ones(3), angles)
    samples = [max(1, int(header[name])) for name in ("mx", "my", "mz")]
    # Without a cell a voxel has the size 1.
    steps = np.array([size / n if size > 0 else 1.0 for size, n in zip(sizes, samples)])
    matrix = np.eye(4)
    matrix[:3, :3] = cell * steps
    starts = [0, 0, 0]
    for axis, name in zip(axes, ("nxstart", "nystart", "nzstart")):
        starts[axis] = int(header[name])
    # Microscopists give the origin, crystallographers the first index.
    origin = np.array([float(header["origin"][name]) for name in "xyz"])
    matrix[:3, 3] = origin if np.isfinite(origin).all() and origin.any() else cell * steps @ starts
    check_matrix(path, matrix)
    return matrix
