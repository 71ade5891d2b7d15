# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes as files of the same bytes in every run, for damage to do the same to them."""

from dataclasses import replace
from uuid import UUID

# Where OpenVDB writes an identifier that it draws anew for each file.
_IDENTIFIER = slice(21, 57)
# Of the statistics, what the clock and the memory have told.
_MEASURED = ("seconds", "rays_per_second", "peak_memory_bytes")


def saved_alike(bake, path):
    """The bytes of the file of a bake, without the seal that would tell every change."""
    statistics = {**bake.statistics, **dict.fromkeys(_MEASURED, 1)}
    replace(bake, statistics=statistics).save(path)
    data = bytearray(path.read_bytes()[:-24])
    assert data[_IDENTIFIER].count(b"-") == 4
    data[_IDENTIFIER] = str(UUID(int=0)).encode()
    return bytes(data)
