# SPDX-License-Identifier: GPL-3.0-or-later
"""Scalar grids of OpenVDB files, made dense by the core."""

import leaflight._core as _core

from ...volume.volume import Volume


def read(path, grid=""):
    values, index_to_world, name = _core.read_vdb_volume(str(path), grid)
    return Volume(values, index_to_world, name or path.stem, str(path))
