# SPDX-License-Identifier: GPL-3.0-or-later
"""The targets of libFuzzer in the C++ core: core/*.cpp, and seeds for each.

Some targets unpack their input with core/bytes.h. Their seeds are packed here in the same order.
"""

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import numpy as np
import targets


@dataclass(frozen=True)
class CoreTarget:
    """A target of the core. name: on the command line; file: of core/; seeds: seeds(folder) returns
    bytes.
    """

    name: str
    file: str
    seeds: Callable[[Path], list]
    suffix: str = ""


def _headers(folder):
    bakes = targets._bake(folder)
    return [*bakes, *(data[:2000] for data in bakes)]


def _sealed(_folder):
    texts = [b"", b"x" * 30, b"Leaflight\x1ae1" * 3]
    return [*texts, *(data + targets._seal(data) for data in texts)]


def _checkpoints(_folder):
    text = b'{"volume": "box.npy"}'
    state = struct.pack("<i3Q", 7, 2, 0, 1) + bytes(200)
    data = b"Leaflight checkpoint 1\n" + struct.pack("<Q", len(text)) + text + state
    return [data, data + targets._seal(data)]


def _fields(axes):
    def seeds(_folder):
        random = np.random.default_rng(3)
        found = []
        for type, of in enumerate((np.float32, np.uint8, np.int16, np.uint16)):
            values = random.integers(0, 100, 5**axes).astype(of).tobytes()
            rays = random.normal(2, 2, (4, 2 * axes)).astype(np.float32).tobytes()
            placed = random.normal(0, 1, axes * (axes + 1)).astype(np.float32).tobytes()
            for place in (b"\0", b"\1" + placed):
                begin = struct.pack("<fB", 47.5, type) + bytes([5] * axes) + place
                found.append(begin + values + rays)
        return found

    return seeds


def _bake_of_grids(_folder):
    """Returns bakes of fields with 2^3 voxels, and texels at each."""
    corners = [(x, y, z) for z in range(2) for y in range(2) for x in range(2)]

    def number(n):
        return bytes((1, n))

    def grid(name, size, colors, texels):
        dims = b"".join(map(number, (size, size, size)))
        value = struct.pack("<f", 0.5) * (3 if colors else 1)
        data = bytes((name, 1)) + value + bytes((len(texels),))
        for at, texel in enumerate(texels):
            place = b"".join(map(number, texel))
            data += place + struct.pack("<f", at) * (3 if colors else 1)
        # Metadata: dims, floats, no tile, no transform.
        return data + b"\1" + dims + bytes((1, 0, 1, 1, 1))

    coarse = grid(0, 2, False, corners)
    coarse += grid(1, 2, True, corners) + grid(2, 2, True, corners) + grid(3, 2, False, corners)
    back = grid(4, 2, True, corners) + grid(6, 2, True, corners)
    return [coarse, coarse + back, coarse + grid(7, 2, True, corners)]


CORE_TARGETS = (
    CoreTarget("core-vdb-header", "vdb_header", _headers, ".vdb"),
    CoreTarget("core-seal", "seal", _sealed),
    CoreTarget("core-checkpoint", "checkpoint", _checkpoints, ".checkpoint"),
    CoreTarget("core-bake", "grids_of_bake", _bake_of_grids),
    CoreTarget("core-exr", "exr", targets._exr, ".exr"),
    CoreTarget("core-field", "field", _fields(3)),
    CoreTarget("core-flat-field", "flat_field", _fields(2)),
)
