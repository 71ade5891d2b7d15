# SPDX-License-Identifier: GPL-3.0-or-later
"""Scalar grids of OpenVDB files, made dense by the core, in a process of its own."""

import numpy as np

from ...volume.volume import Volume
from ..apart import read_vdb_volume
from .stored import StoredVolume


def open_volume(path, grid=""):
    """How many voxels are active only the grid itself tells."""

    def load(_frame, _channel, _progress):
        values, index_to_world, name = read_vdb_volume(path, grid)
        return Volume(values, index_to_world, name or path.stem)

    return StoredVolume(None, np.dtype(np.float32), load)
