# SPDX-License-Identifier: GPL-3.0-or-later
"""Helpers that compare files of bakes bit by bit."""

from dataclasses import replace
from uuid import UUID

import leaflight
import numpy as np
from leaflight import _core

GRIDS = ("radiance", "radiance_indirect", "radiance_error")

# Position of a random identifier that OpenVDB writes into each file.
_IDENTIFIER = slice(21, 57)
# Statistics of time and memory, which differ from run to run.
_MEASURED = ("seconds", "peak_memory_bytes")


def saved_alike(bake, path):
    """Returns the bytes of a bake's file, without the seal, which would detect every change."""
    statistics = replace(bake.statistics, **dict.fromkeys(_MEASURED, 1))
    replace(bake, statistics=statistics).save(path)
    data = bytearray(path.read_bytes()[:-24])
    assert data[_IDENTIFIER].count(b"-") == 4
    data[_IDENTIFIER] = str(UUID(int=0)).encode()
    return bytes(data)


def assert_same_bake(path, other):
    """Compares values and light bit by bit, and the metadata without the statistics."""
    one, two = map(leaflight.load_bake, (path, other))
    for volume, other_volume in zip(one.volumes, two.volumes, strict=True):
        np.testing.assert_array_equal(volume.values, other_volume.values)
    assert_same_light(one, two)
    *_, metadata = _core.read_bake(str(path))
    *_, other_metadata = _core.read_bake(str(other))
    # Ignore the statistics, which contain times.
    metadata.pop("statistics"), other_metadata.pop("statistics")
    assert metadata == other_metadata


def assert_same_light(one, other):
    """Compares provenance, grids and walls of two bakes bit by bit."""
    assert one.id == other.id and one.provenance == other.provenance
    for mine, theirs in zip(one.grids, other.grids, strict=True):
        assert mine.has_back == theirs.has_back
        back = ("radiance_back", "radiance_back_indirect") if mine.has_back else ()
        for name in (*GRIDS, *back):
            np.testing.assert_array_equal(mine.dense(name), theirs.dense(name), err_msg=name)
    assert (one.walls is None) == (other.walls is None)
    middle = sum(one.isovalues) / 2
    for mesh in range(one.walls.count if one.walls else 0):
        for back in (False, True):
            mine, theirs = (bake.walls.radiance(mesh, middle, back) for bake in (one, other))
            np.testing.assert_array_equal(mine, theirs)
