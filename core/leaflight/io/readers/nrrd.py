# SPDX-License-Identifier: GPL-3.0-or-later
"""NRRD, attached (.nrrd) and detached (.nhdr), through the core and Teem."""

import leaflight._core as _core

from ...volume.volume import Volume


def read(path):
    values, index_to_world, name = _core.read_nrrd(str(path))
    return Volume(values, index_to_world, name or path.stem, str(path))
