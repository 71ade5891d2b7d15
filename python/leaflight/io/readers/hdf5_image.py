# SPDX-License-Identifier: GPL-3.0-or-later
"""A volume of an HDF5 file: in which arrays its values lie, and how. All of it JSON can hold."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .axes import Axis, grid_of
from .packing import Packing

# The path of an array for each frame and channel: one where they are axes of the array itself.
Paths = list[list[str]]


@dataclass(frozen=True)
class Level:
    """One resolution: voxels (nz, ny, nx), of which its arrays may have more; index to world."""

    dims: list[int]
    matrix: list[list[float]]
    paths: Paths


@dataclass(frozen=True)
class Image:
    """levels: the finest first; letters: of the arrays' axes, as of a Grid.

    dtype: of the numbers as they are stored; packing: how they are values; frames, channels, unit,
    notes: as of StoredVolume.
    absent_filter: (code, name) of a filter that the values are packed by and that is not at hand.
    """

    levels: list[Level]
    letters: str
    dtype: str
    packing: Packing
    frames: int
    channels: int
    unit: str
    notes: list[str]
    absent_filter: tuple[int, str] | None = None

    def part(self, path: str) -> "Image | None":
        """The Image of one of its arrays, None if it is none of them."""
        for level in self.levels:
            if any(path in channels for channels in level.paths):
                only = replace(level, paths=[[path]])
                whole = len(level.paths) == len(level.paths[0]) == 1
                counts = (self.frames, self.channels) if whole else (1, 1)
                return replace(self, levels=[only], frames=counts[0], channels=counts[1])
        return None

    def json(self) -> dict[str, Any]:
        return asdict(self)


def image_of_json(facts: dict[str, Any]) -> Image:
    levels = [Level(**level) for level in facts["levels"]]
    packing = Packing(**{**facts["packing"], "fills": tuple(facts["packing"]["fills"])})
    return Image(**{**facts, "levels": levels, "packing": packing})


def image_of(
    levels: Sequence[tuple[Sequence[Axis], Paths]],
    dtype: np.dtype[Any],
    packing: Packing | None = None,
) -> Image | None:
    """The Image of these levels, each by its arrays' axes; None where they hold no volume."""
    found: list[Level] = []
    for axes, paths in levels:
        grid = grid_of(axes)
        if grid is None:
            # Coarse levels may be flat.
            break
        sizes = {letter: int(axis.size) for letter, axis in zip(grid.letters, axes)}
        dims = [sizes[letter] for letter in "zyx"]
        found.append(Level(dims, grid.matrix.tolist(), paths))
        if len(found) == 1:
            finest = grid
            frames, channels = sizes.get("t", len(paths)), sizes.get("c", len(paths[0]))
    if not found:
        return None
    return Image(
        found,
        finest.letters,
        dtype.str,
        packing or Packing(),
        frames,
        channels,
        finest.unit,
        list(finest.notes),
    )
