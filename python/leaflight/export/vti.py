# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake as a VTK image (.vti), for ParaView."""

from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Bake
from ..io.images import display_colors
from ..io.output import check_writable, replaced_together
from ..paths import AnyPath
from ..scene.volume_texture import identifiers
from .paraview_state import paraview_state, state_path
from .point_grid import point_grid
from .vtk_arrays import add_text_and_numbers, write


def write_vti(path: AnyPath, bake: Bake, volume: int = 0) -> None:
    """Writes a volume (its number) of a Bake with its radiance, and a state of ParaView beside it.

    Point data are value (float, data units), radiance (W/(m^2 sr), linear RGB), radiance_error and
    color (uchar, sRGB at the scene's exposure). Baked backs add radiance_back. Volumes that color
    it add their values (float), NaN where they have none. The radiance is that of the
    isosurface through the point, 0 outside the isovalue range. The error is the standard error of
    its mean over the channels. Field data are isovalues, exposure, bake_id and unit (of lengths).
    Raises LeaflightError.
    """
    path = Path(path)
    check_writable(path, ".vti")
    grid = point_grid(bake, volume)
    exposure = bake.scene.exposure
    image = vtkImageData()
    _place(path, image, grid.index_to_world)
    nz, ny, nx = grid.values.shape
    image.SetDimensions(nx, ny, nz)
    arrays = {
        "value": grid.values,
        "radiance": grid.radiance,
        "radiance_error": grid.error,
        "color": display_colors(grid.radiance, exposure),
    }
    if grid.radiance_back is not None:
        arrays["radiance_back"] = grid.radiance_back
    arrays |= identifiers(grid.of_texture, arrays)
    for name, values in arrays.items():
        rows = np.ascontiguousarray(values).reshape(nx * ny * nz, -1)
        array = numpy_to_vtk(rows, deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    image.GetPointData().SetActiveScalars("value")
    add_text_and_numbers(
        image, isovalues=bake.isovalues, exposure=exposure, bake_id=bake.id, unit=bake.unit
    )
    with replaced_together(path, state_path(path)) as (data, state):
        write(vtkXMLImageDataWriter(), image, data)
        state.write_text(paraview_state(path, bake, volume), encoding="utf-8")


def _place(path: AnyPath, image: vtkImageData, index_to_world: Array) -> None:
    """Sets VTK's origin, spacing and rotation. Raises LeaflightError for other matrices."""
    axes = index_to_world[:3, :3]
    spacing = np.linalg.norm(axes, axis=0)
    directions = axes / spacing
    if np.abs(directions.T @ directions - np.eye(3)).max() > 1e-5:
        raise LeaflightError(
            f"{path}: the volume is sheared, which .vti cannot hold: write an isosurface as .vtp, "
            "or bake the volume unsheared."
        )
    image.SetOrigin(index_to_world[:3, 3])
    image.SetSpacing(spacing)
    image.SetDirectionMatrix(directions.ravel())
