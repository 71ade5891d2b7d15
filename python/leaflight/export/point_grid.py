# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples a bake, values and radiance, at the points of one regular grid."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from .._core import Field
from ..arrays import Array
from ..bake.baked import Bake
from ..scene.volume_texture import identifiers, named_values


@dataclass(frozen=True, eq=False)
class PointGrid:
    """The values and light of one volume of a bake, at points evenly spaced along three axes.

    index_to_world: Matrix from the point (i, j, k, 1) to world coordinates, float64 (4, 4).
    values: Values in data units, NaN where data are missing, float32 (nz, ny, nx).
    radiance: Radiance of the isosurface through each point, W/(m^2 sr), linear RGB, float32 (nz,
        ny, nx, 3). It is 0 outside the isovalue range.
    error: Standard error of the mean of radiance over the channels, float32 (nz, ny, nx).
    radiance_back: Radiance of the backs. None if they were not baked.
    of_texture: Values of the volumes that color the isosurfaces, by name, float32 (nz, ny, nx)
        each; NaN where there are none.
    """

    index_to_world: Array
    values: Array
    radiance: Array
    error: Array
    radiance_back: Array | None
    of_texture: dict[str, Array]

    def arrays(self, **added: Array) -> dict[str, Array]:
        """Returns all values and light by name, the added arrays, and the values of_texture."""
        found = {"value": self.values, "radiance": self.radiance, "radiance_error": self.error}
        found |= added
        if self.radiance_back is not None:
            found["radiance_back"] = self.radiance_back
        return found | identifiers(self.of_texture, found)


def point_grid(bake: Bake, volume: int = 0) -> PointGrid:
    """Returns the PointGrid of a volume (its number) of a Bake: its voxels, or finer texels."""
    bake.check_volume(volume)
    field, grid = bake.volumes[volume].field(), bake.grids[volume]
    voxels, texels = np.array(field.dims), np.array(grid.resolution)
    values = np.asarray(bake.volumes[volume].values, np.float32)
    if np.all(texels >= voxels):
        step = (voxels - 1) / (texels - 1)
        names = ["radiance", "radiance_error", *(["radiance_back"] if grid.has_back else [])]
        radiance, error, *back = (grid.dense(name) for name in names)
        values = _between_voxels(values, texels)
    else:
        step = np.ones(3)
        radiance = _looked_up(field, grid.lookup)
        error = _looked_up(field, grid.lookup_error)
        back = [_looked_up(field, grid.lookup, True)] if grid.has_back else []
    index_to_world = np.asarray(bake.volumes[volume].index_to_world) @ np.diag([*step, 1.0])
    planes = [
        named_values(bake.scene.isosurfaces[volume].texture, points)
        for points in _planes(index_to_world, values.shape)
    ]
    of_texture = {
        name: np.stack([plane[name] for plane in planes]).reshape(values.shape)
        for name in planes[0]
    }
    return PointGrid(index_to_world, values, radiance, error, back[0] if back else None, of_texture)


def _between_voxels(values: Array, texels: Array) -> Array:
    """Returns the trilinear interpolant at points (x, y, z) between the first and last voxels."""
    for axis, count in zip((2, 1, 0), texels):
        n = values.shape[axis]
        if count == n:
            continue
        position = np.arange(count) * ((n - 1) / (count - 1))
        cell = np.minimum(position.astype(int), n - 2)
        shape = [1, 1, 1]
        shape[axis] = count
        share = (position - cell).astype(np.float32).reshape(shape)
        low, high = values.take(cell, axis), values.take(cell + 1, axis)
        values = low + share * (high - low)
    return values


def _looked_up(field: Field, lookup: Callable[..., Array], *options: bool) -> Array:
    """Looks up all voxels plane by plane, which bounds the memory of their coordinates."""
    shape = field.dims[::-1]
    planes = _planes(field.index_to_world, shape)
    found = np.stack([lookup(field, points, *options) for points in planes])
    return found.reshape(*shape, *found.shape[2:])


def _planes(index_to_world: Array, shape: Sequence[int]) -> Iterator[Array]:
    """Yields the world points (ny * nx, 3) of each plane of a grid (nz, ny, nx)."""
    nz, ny, nx = shape
    y, x = np.mgrid[:ny, :nx]
    for z in range(nz):
        index = np.stack([x, y, np.full_like(x, z), np.ones_like(x)], axis=-1).reshape(-1, 4)
        yield (index @ index_to_world.T)[:, :3]
