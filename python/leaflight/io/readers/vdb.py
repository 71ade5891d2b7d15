# SPDX-License-Identifier: GPL-3.0-or-later
"""Scalar grids of OpenVDB files. The core makes them dense in a subprocess."""

import math
from pathlib import Path
from typing import Any

import numpy as np

import leaflight._core as _core

from ..._core import Progress
from ...arrays import Array
from ...volume.memory import new_voxels
from ...volume.volume import Volume
from ..reader_process import ReaderProcess
from .stored import StoredVolume

_MOST_VOXELS = 2**31 - 1


def open_volume(path: Path, grid: str = "") -> StoredVolume:
    """Opens a grid. Its size is unknown before it is read."""

    def load(_frame: int, _channel: int, _progress: Progress) -> Volume:
        with ReaderProcess(path, "OpenVDB file", __name__, "read_grid", grid) as process:
            answer = process.answer()
            shape = tuple(answer["shape"])
            if len(shape) != 3 or not 0 < math.prod(shape) <= _MOST_VOXELS:
                raise process.died()
            values = new_voxels(shape, np.float32)
            process.fill(values)
        return Volume(values, np.array(answer["index_to_world"]), answer["name"] or path.stem)

    return StoredVolume(None, np.dtype(np.float32), load)


def read_grid(path: Path, grid: str) -> tuple[dict[str, Any], list[Array]]:
    """Yields a scalar grid, [z, y, x]. Runs in the subprocess."""
    values, index_to_world, name = _core.read_vdb_volume(path, grid)
    answer = {"shape": values.shape, "index_to_world": index_to_world.tolist(), "name": name}
    return answer, [values]
