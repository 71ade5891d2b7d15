# SPDX-License-Identifier: GPL-3.0-or-later
"""Cuts of a volume by planes, boxes and balls, in index coordinates (x, y, z).

A *capped* cut is a ramp of values. It has the lowest value of the data at the cut, and the highest
one voxel inside. The lesser of ramp and data is kept, so each isosurface is closed within a voxel
of the cut. A linear ramp keeps turned planes flat under trilinear interpolation. It goes on
downwards outside, where cells cross the cut, and is constant beyond.
An *open* cut has no values beyond it, so light enters. If it is a box along the axes of the voxels,
it is a crop: the values keep their type.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from .memory import VOXEL_TYPES, as_voxels, new_voxels

# Depth outside a cut at which values become constant, in voxels.
_DEPTH = 2.0
# Distance outside an open cut at which values end. The diagonal of a voxel is shorter, so every
# cell at the cut has its values.
_MARGIN = 1.75
# Distance from a box at which nothing depends on the distance, in voxels.
_FAR = 5.0
# Half of the width of a slab that replaces a half-space, in voxels. Single precision still resolves
# a thousandth of a voxel within it.
_WIDE = 4096.0
# Smallest angle between a box and the axes of the voxels, and smallest part of a voxel, that count.
_PARALLEL = 1e-6
# Least number of integer steps in a ramp, so that rounding bends its planes by less than 1/400 of a
# voxel.
_STEPS = 200

Rows = tuple[tuple[float, ...], ...]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Box:
    """A turned box.

    matrix: Four rows of the matrix from the cube of -1 to 1.
    keep: "inside" or "outside".
    cut: "capped" closes isosurfaces at the cut, "open" lets light in.
    """

    matrix: Rows
    keep: str = "inside"
    cut: str = "capped"

    @classmethod
    def between(cls, low: Array, high: Array, keep: str = "inside", cut: str = "capped") -> "Box":
        """Returns the box between two corners (x, y, z)."""
        matrix = np.diag([*(0.5 * (np.asarray(high) - low)), 1.0])
        matrix[:3, 3] = 0.5 * (np.asarray(low) + high)
        return cls(_rows(matrix), keep, cut)

    def moved(self, matrix: Array) -> "Box":
        return Box(_rows(matrix @ self.matrix), self.keep, self.cut)

    @cached_property
    def slabs(self) -> Array:
        """Rows of unit normal n (x, y, z), offset and half of the width of three slabs.

        Points p within the box have |n p + offset| of at most half the width of each.
        """
        matrix = np.asarray(self.matrix)
        normals = np.linalg.inv(matrix[:3, :3])
        lengths = np.linalg.norm(normals, axis=1)
        offsets = -(normals @ matrix[:3, 3]) / lengths
        return np.column_stack([normals / lengths[:, None], offsets, 1.0 / lengths])

    def distances(self, k: int, shape: Sequence[int]) -> Array:
        """Returns the distances into what is kept, in voxels, of the nodes (ny, nx) of plane k.

        They are +-_FAR in some places that are farther than that.
        """
        matrix = np.asarray(self.matrix)
        slabs = self.slabs
        normals, half = slabs[:, :3], slabs[:, 4]
        inside = np.full(shape[1:], -_FAR)
        z, y, x = _nodes_around(matrix, 1.0 + _FAR / half, shape)
        if k in z and y and x:
            middle = matrix[:3, 3]
            at = [np.subtract(nodes, origin) for nodes, origin in zip((x, y), middle)]
            found: Array = np.min(
                [
                    reach - abs(n[0] * at[0] + (n[1] * at[1] + n[2] * (k - middle[2]))[:, None])
                    for n, reach in zip(normals, half)
                ],
                axis=0,
            )
            inside[y.start : y.stop, x.start : x.stop] = found
        return inside if self.keep == "inside" else -inside


@dataclass(frozen=True)
class Ball:
    """A ball, or an ellipsoid. matrix: From the ball of radius 1. The others are as in Box."""

    matrix: Rows
    keep: str = "outside"
    cut: str = "capped"

    def moved(self, matrix: Array) -> "Ball":
        return Ball(_rows(matrix @ self.matrix), self.keep, self.cut)

    def distances(self, k: int, shape: Sequence[int]) -> Array:
        to_ball = np.linalg.inv(np.asarray(self.matrix))
        y, x = np.mgrid[: shape[1], : shape[2]]
        at = np.stack([x, y, np.full_like(x, k)], axis=-1) @ to_ball[:3, :3].T + to_ball[:3, 3]
        radius = np.maximum(np.linalg.norm(at, axis=-1), 1e-6)
        # To first order, which is exact on the surface.
        steepness = np.linalg.norm(at @ to_ball[:3, :3], axis=-1) / radius
        inside: Array = (1.0 - radius) / np.maximum(steepness, 1e-12)
        return inside if self.keep == "inside" else -inside


@dataclass(frozen=True)
class HalfSpace:
    """A plane. It removes the side to which its normal points. cut: As in Box."""

    point: Point
    normal: Point
    cut: str = "capped"

    def moved(self, matrix: Array) -> "HalfSpace":
        point = matrix[:3, :3] @ self.point + matrix[:3, 3]
        normal = np.linalg.inv(matrix[:3, :3]).T @ self.normal
        return HalfSpace(tuple(point.tolist()), tuple(normal.tolist()), self.cut)

    @property
    def slabs(self) -> Array:
        """A wide slab up to the plane, as Box.slabs, three times."""
        normal = np.asarray(self.normal) / np.linalg.norm(self.normal)
        slab = [*normal, _WIDE - normal @ self.point, _WIDE]
        return np.array([slab] * 3)

    def distances(self, k: int, shape: Sequence[int]) -> Array:
        nx, ny, nz = np.asarray(self.normal) / np.linalg.norm(self.normal)
        x, y, z = self.point
        rows = ny * (y - np.arange(shape[1]))[:, None]
        found: Array = rows + nx * (x - np.arange(shape[2])) + nz * (z - k)
        return found


Cut = Box | Ball | HalfSpace


@dataclass(frozen=True)
class Cuts:
    """The capped cuts of a volume. low, high: Range of the data before them."""

    low: float
    high: float
    cuts: tuple[Cut, ...]

    def moved(self, matrix: Array) -> "Cuts":
        return Cuts(self.low, self.high, tuple(cut.moved(matrix) for cut in self.cuts))

    def ramp(self, shape: Sequence[int]) -> Array:
        """Returns the values of the ramp at the nodes, float32 [z, y, x], not limited."""
        found = new_voxels(shape, np.float32)
        for k, plane in enumerate(found):
            plane[...] = self.low + (self.high - self.low) * self.distances(k, shape)
        return found

    def distances(self, k: int, shape: Sequence[int]) -> Array:
        """Returns the least distances of the cuts, as Box.distances()."""
        found: Array = np.min([cut.distances(k, shape) for cut in self.cuts], axis=0)
        return found


def _nodes_around(matrix: Array, scale: Array, shape: Sequence[int]) -> list[range]:
    """Returns the nodes [z, y, x] around the box of a matrix, whose axes are scaled."""
    reach = abs(matrix[:3, :3]) @ scale
    first = np.clip(np.floor(matrix[:3, 3] - reach), 0, shape[::-1]).astype(int)
    last = np.clip(np.ceil(matrix[:3, 3] + reach) + 1, 0, shape[::-1]).astype(int)
    return [range(a, b) for a, b in zip(first[::-1], last[::-1])]


def crop_of(cut: Cut) -> tuple[slice, ...] | None:
    """Returns the planes [z, y, x] that an open cut keeps if it is a crop, or None.

    Each cell that touches the box keeps its corners.
    """
    if not isinstance(cut, Box) or (cut.keep, cut.cut) != ("inside", "open"):
        return None
    sizes = abs(np.asarray(cut.matrix)[:3, :3])
    if np.count_nonzero(sizes > _PARALLEL * sizes.max()) > 3:
        return None
    middle, half = np.asarray(cut.matrix)[:3, 3], sizes.sum(axis=1)
    first = np.maximum(np.floor(middle - half + _PARALLEL), 0).astype(int)
    last = np.maximum(np.ceil(middle + half - _PARALLEL), -1).astype(int)
    return tuple(slice(a, b + 1) for a, b in zip(first[::-1], last[::-1]))


def cut_values(
    values: Array, cut: Cut, data_range: tuple[float, float], check: Callable[[], None]
) -> Array:
    """Returns the values [z, y, x] with a cut. They are in one of VOXEL_TYPES with enough room.

    check: Called for each plane; it may raise Cancelled.
    """
    low, high = data_range
    floor, is_open = low - _DEPTH * (high - low), cut.cut == "open"
    found = new_voxels(values.shape, _type_for(values, is_open, floor, high))
    for k, plane in enumerate(values):
        check()
        distances, plane = cut.distances(k, values.shape), as_voxels(plane)
        if is_open:
            found[k] = np.where(distances < -_MARGIN, np.float32(np.nan), plane)
            continue
        ramp = low + (high - low) * np.clip(distances, -_DEPTH, 1.0)
        if found.dtype.kind != "f":
            ramp = np.rint(ramp)
        found[k] = np.where(distances < 1.0, np.minimum(plane, ramp), plane)
    return found


def _type_for(values: Array, is_open: bool, floor: float, high: float) -> np.dtype[Any]:
    own = as_voxels(values[:1]).dtype
    if not is_open and own.kind != "f" and high - floor >= (1 + _DEPTH) * _STEPS:
        for kind in VOXEL_TYPES[:-1]:
            limits: Any = np.iinfo(kind)
            if limits.min <= floor and high <= limits.max:
                return np.dtype(kind)
    return np.dtype(np.float32)


def trimmed(values: Array, low: float) -> tuple[Array, tuple[int, int, int]]:
    """Returns values without planes at the ends that have no data, and the index of the first node.

    low: Least value of the data. Two planes outside it are kept, where values close isosurfaces.
    """
    in_x, in_y = np.zeros(values.shape[2], bool), np.zeros(values.shape[1], bool)
    in_z = np.zeros(values.shape[0], bool)
    for k, plane in enumerate(values):
        with_data = plane >= low
        in_z[k] = with_data.any()
        in_y |= with_data.any(axis=1)
        in_x |= with_data.any(axis=0)
    ends = [np.flatnonzero(filled)[[0, -1]] + [-2, 3] for filled in (in_z, in_y, in_x)]
    kept = values[tuple(slice(max(first, 0), last) for first, last in ends)]
    found = new_voxels(kept.shape, kept.dtype)
    found[...] = kept
    z, y, x = (max(int(first), 0) for first, _ in ends)
    return found, (x, y, z)


def _rows(matrix: Array) -> Rows:
    return tuple(map(tuple, np.asarray(matrix).tolist()))
