# SPDX-License-Identifier: GPL-3.0-or-later
"""Stores texels in a texture of bricks, without bricks that hold no light.

A brick of n^3 texels covers n - 1 cells along each axis. Neighbors share a layer of texels, so that
a graphics card interpolates within one brick. web/src/bricks.ts makes the texture.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

# Candidate widths of bricks, in texels. All texels as a single brick is the third candidate.
SIDES = (8, 16)
# Largest side of a texture in browsers.
LARGEST_SIDE = 2048


@dataclass(frozen=True, eq=False)
class LightBricks:
    """The layout of a texture of bricks.

    brick: Texels (x, y, z) of each brick.
    table: Position (x, y, z) of each brick in the texture, in bricks, and 1; zeros for a brick
        without light. The array is uint8 (nz, ny, nx, 4).
    shape: Bricks (x, y, z) of the texture.
    """

    brick: tuple[int, int, int]
    table: Array
    shape: tuple[int, int, int]


def light_bricks(lit: Array, layers: int = 1) -> LightBricks:
    """Returns the LightBricks that take the least memory.

    lit: True for texels with light, bool [z, y, x].
    layers: Number of textures of this shape, stacked along z.
    """
    sides = (*SIDES, None) if layers * len(lit) <= LARGEST_SIDE else SIDES
    return min((_bricks(lit, side, layers) for side in sides), key=_texels)


def _bricks(lit: Array, side: int | None, layers: int) -> LightBricks:
    nz, ny, nx = lit.shape
    resolution = nx, ny, nz
    brick = resolution if side is None else (side, side, side)
    counts = tuple(max(1, -(-(n - 1) // (b - 1))) for n, b in zip(resolution, brick))
    is_used = lit
    for axis, (count, b) in enumerate(zip(counts[::-1], brick[::-1])):
        parts = [
            is_used.take(range(k * (b - 1), min(k * (b - 1) + b, lit.shape[axis])), axis).any(axis)
            for k in range(count)
        ]
        is_used = np.stack(parts, axis)
    places = np.argwhere(is_used)
    across = max(1, min(len(places), round((layers * len(places)) ** (1 / 3))))
    down = max(1, min(-(-len(places) // across), across))
    shape = (across, down, max(1, -(-len(places) // (across * down))))
    table = np.zeros((*counts[::-1], 4), np.uint8)
    number = np.arange(len(places))
    x, y, z = number % across, number // across % down, number // (across * down)
    table[tuple(places.T)] = np.stack([x, y, z, np.ones_like(x)], axis=1)
    return LightBricks(brick, table, shape)


def _texels(bricks: LightBricks) -> int:
    return int(np.prod(bricks.brick, dtype=np.int64) * np.prod(bricks.shape, dtype=np.int64))
