# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake as a Dataset of xarray: the method to_xarray() of Bake."""

from typing import Any

import numpy as np

from ..arrays import Array
from ..bake.baked import Bake
from .mesh_objects import needed
from .point_grid import point_grid


def to_xarray(bake: Bake, volume: int = 0) -> Any:
    """Returns a volume (its number) with the light of all isosurfaces as an xarray.Dataset.

    The points (z, y, x) are the voxels, or the texels if these are finer. Variables are value,
    radiance, radiance_error, and radiance_back if it was baked; and the values of volumes that
    color it. Radiance has a dimension channel (r, g, b). It is 0 outside the isovalue range.
    Coordinates x, y, z are world coordinates. They are absent if the volume is rotated or sheared;
    the attribute index_to_world always has the matrix. Raises LeaflightError without xarray.
    """
    xarray = needed("xarray")
    grid = point_grid(bake, volume)
    space = ("z", "y", "x")
    units = {"radiance": "W m-2 sr-1", "radiance_error": "W m-2 sr-1"}
    units["radiance_back"] = units["radiance"]
    return xarray.Dataset(
        {
            name: (
                (*space, "channel")[: values.ndim],
                values,
                {"units": units[name]} if name in units else {},
            )
            for name, values in grid.arrays().items()
        },
        coords={"channel": ["r", "g", "b"], **_coordinates(grid.index_to_world, grid, bake.unit)},
        attrs={
            "isovalues": list(bake.isovalues),
            "exposure": bake.scene.exposure,
            "bake_id": bake.id,
            "index_to_world": grid.index_to_world.ravel().tolist(),
        },
    )


def _coordinates(matrix: Array, grid: Any, unit: str) -> dict[str, Any]:
    """Returns the coordinates along x, y and z; none for rotated axes."""
    axes = matrix[:3, :3]
    steps = np.diag(axes)
    if np.abs(axes - np.diag(steps)).max() > 1e-6 * np.abs(steps).max():
        return {}
    counts = grid.values.shape[::-1]
    attributes = {"units": unit} if unit else {}
    return {
        name: (name, matrix[axis, 3] + steps[axis] * np.arange(counts[axis]), attributes)
        for axis, name in enumerate("xyz")
    }
