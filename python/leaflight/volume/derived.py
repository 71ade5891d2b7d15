# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes that are computed from another one, to color its isosurfaces."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from .volume import Volume


def gradient_of(volume: Volume) -> Volume:
    """Returns the length of the gradient at the nodes of a volume, in data units per world unit.

    Differences are central, and one-sided at the border and next to NaN. A node without a neighbor
    along an axis is NaN.
    """
    volume = _without_layer(volume)
    values = volume.values
    index_from_world = np.linalg.inv(np.asarray(volume.index_to_world, np.float64)[:3, :3])
    lengths = np.empty(values.shape, np.float32)
    unknown = np.full(values.shape[1:], np.nan)
    before, at = unknown, values[0].astype(np.float64)
    for z, length in enumerate(lengths):
        after = values[z + 1].astype(np.float64) if z + 1 < len(values) else unknown
        framed = np.pad(at, 1, constant_values=np.nan)
        along = np.stack(
            [
                _slope(framed[1:-1, :-2], at, framed[1:-1, 2:]),
                _slope(framed[:-2, 1:-1], at, framed[2:, 1:-1]),
                _slope(before, at, after),
            ]
        )
        length[...] = np.linalg.norm(np.tensordot(index_from_world, along, (0, 0)), axis=0)
        before, at = at, after
    per = f" per {volume.unit}" if volume.unit else ""
    return replace(volume, values=lengths, name=f"gradient of {volume.name}{per}")


def height_of(volume: Volume, up: Sequence[float] = (0.0, 0.0, 1.0)) -> Volume:
    """Returns the world coordinate along a unit vector, exact between its eight nodes.

    The nodes are the corners of the volume.
    """
    volume = _without_layer(volume)
    z, y, x = np.mgrid[:2, :2, :2]
    ends = np.array(volume.values.shape[::-1]) - 1.0
    matrix = np.asarray(volume.index_to_world, np.float64) @ np.diag([*ends, 1.0])
    corners = np.stack([x, y, z], axis=-1) @ matrix[:3, :3].T + matrix[:3, 3]
    heights = (corners @ np.asarray(up, np.float64)).astype(np.float32)
    unit = f" in {volume.unit}" if volume.unit else ""
    return replace(volume, values=heights, index_to_world=matrix, name=f"height{unit}")


def _slope(before: Array, at: Array, after: Array) -> Array:
    """Returns the mean of both differences, or the one that is known."""
    forward, backward = after - at, at - before
    known = np.where(np.isnan(forward), backward, forward)
    return np.asarray(0.5 * (known + np.where(np.isnan(backward), known, backward)))


def _without_layer(volume: Volume) -> Volume:
    """Returns the volume without the layer that capped() added."""
    if not volume.layers:
        return volume
    matrix = np.array(volume.index_to_world, np.float64)
    matrix[:3, 3] += volume.layers * matrix[:3, :3].sum(axis=1)
    return replace(volume, values=volume.data(), index_to_world=matrix)
