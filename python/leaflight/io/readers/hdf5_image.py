# SPDX-License-Identifier: GPL-3.0-or-later
"""A volume of an HDF5 file: its arrays and the meaning of their values, as JSON data."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ...volume.axes import Axis, grid_of
from .channels import Channel, channel_of_json
from .packing import Packing

# Paths of the arrays by frame and channel; a single one if these are axes of the array.
Paths = list[list[str]]


@dataclass(frozen=True)
class Level:
    """One resolution: its voxels (nz, ny, nx) and its matrix. Its arrays may be larger."""

    dims: list[int]
    matrix: list[list[float]]
    paths: Paths


@dataclass(frozen=True)
class Image:
    """A volume of a file.

    levels: Resolutions, the finest first.
    letters: Axes of the arrays, as in a Grid.
    dtype: Type of the stored numbers.
    packing: Conversion of stored numbers to values.
    frames, channels, unit, notes, channel_list: As in StoredVolume.
    absent_filter: Code and name of an HDF5 filter that packs the values and is not installed.
    """

    levels: list[Level]
    letters: str
    dtype: str
    packing: Packing
    frames: int
    channels: int
    unit: str
    notes: list[str]
    channel_list: tuple[Channel, ...] = ()
    absent_filter: tuple[int, str] | None = None

    def part(self, path: str) -> "Image | None":
        """Returns the Image of one of its arrays, None for any other."""
        for level in self.levels:
            if any(path in paths for paths in level.paths):
                only = replace(level, paths=[[path]])
                is_single = len(level.paths) == len(level.paths[0]) == 1
                frames, channels = (self.frames, self.channels) if is_single else (1, 1)
                return replace(
                    self, levels=[only], frames=frames, channels=channels, channel_list=()
                )
        return None

    def json(self) -> dict[str, Any]:
        return asdict(self)


def image_of_json(facts: dict[str, Any]) -> Image:
    levels = [Level(**level) for level in facts["levels"]]
    packing = Packing(**{**facts["packing"], "fills": tuple(facts["packing"]["fills"])})
    channels = tuple(channel_of_json(**one) for one in facts["channel_list"])
    return Image(**{**facts, "levels": levels, "packing": packing, "channel_list": channels})


def image_of(
    levels: Sequence[tuple[Sequence[Axis], Paths]],
    dtype: np.dtype[Any],
    packing: Packing | None = None,
    channel_list: tuple[Channel, ...] = (),
) -> Image | None:
    """Returns the Image of these levels, each with its arrays' axes; None if it is no volume."""
    found: list[Level] = []
    for axes, paths in levels:
        grid = grid_of(axes)
        if grid is None:
            # A coarse level may have a single voxel along an axis.
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
        channel_list,
    )
