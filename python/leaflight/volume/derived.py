# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes that are computed from another one, to color its isosurfaces."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from .cuts import trimmed
from .memory import new_voxels
from .regions import capped_cuts
from .volume import Volume

# Distances into a cut, in voxels, of nodes next to its face. It lies at 0 to 1, and a node at most
# the diagonal of a voxel away.
_NEXT_TO_CUT = (-1.75, 2.75)


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


def slices_of(volume: Volume, regions: Iterable[Any]) -> Volume:
    """Returns the values of an uncut volume next to the faces of its capped cuts, NaN elsewhere.

    regions: As for read_volume(). Raises LeaflightError without a capped cut.
    """
    cuts = capped_cuts(volume, regions)
    if cuts is None:
        raise LeaflightError(
            f"{volume.name}: no capped cut shows a slice: cut the volume, or choose other colors."
        )
    values = new_voxels(volume.values.shape, np.float32)
    for k, plane in enumerate(values):
        distances = cuts.distances(k, values.shape)
        is_next = (distances > _NEXT_TO_CUT[0]) & (distances < _NEXT_TO_CUT[1])
        plane[...] = np.where(is_next, volume.values[k], np.float32(np.nan))
    if not np.isfinite(values).any():
        raise LeaflightError(
            f"{volume.name}: its cuts lie outside, so no face shows a slice: choose other colors."
        )
    found = replace(volume, name=f"slices of {volume.name}")
    return found.cropped(*trimmed(values, -np.inf))


def _slope(before: Array, at: Array, after: Array) -> Array:
    """Returns the mean of both differences, or the one that is known."""
    forward, backward = after - at, at - before
    known = np.where(np.isnan(forward), backward, forward)
    return np.asarray(0.5 * (known + np.where(np.isnan(backward), known, backward)))


def _without_layer(volume: Volume) -> Volume:
    """Returns the volume without the layer that capped() added."""
    return volume.cropped(volume.data(), (1, 1, 1)) if volume.layers else volume
