# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of VTK for ParaView: a lit isosurface as polygons (.vtp), and a bake as an image (.vti).

A state of ParaView beside the image shows its lit isosurface.
"""

import errno
import os
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkDataArray, vtkObject, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataObject, vtkImageData, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter, vtkXMLPolyDataWriter, vtkXMLWriter

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Bake, Surface
from ..io.images import display_colors
from ..io.output import check_writable, replaced, replaced_together
from ..paths import AnyPath
from ..scene.volume_texture import identifiers
from ..stills.first_view import camera_around_bake, default_isovalue_of
from .point_grid import point_grid

_STATE = """\
# The lit isosurface of {name} in ParaView: File > Load State, or pvpython SCRIPT.
# Then change the isovalue of the filter "Isosurface".
import os

from paraview.simple import *

folder = os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else {folder}
image = XMLImageDataReader(registrationName="Volume", FileName=[os.path.join(folder, {name})])
isosurface = Contour(registrationName="Isosurface", Input=image)
isosurface.ContourBy = ["POINTS", "value"]
isosurface.Isosurfaces = [{isovalue!r}]
view = GetActiveViewOrCreate("RenderView")
shown = Show(isosurface, view)
ColorBy(shown, ("POINTS", "color"))
shown.MapScalars = 0
shown.Ambient, shown.Diffuse, shown.Specular = 1.0, 0.0, 0.0
Render()  # The first picture moves the camera.
view.CameraPosition = {camera.position}
view.CameraFocalPoint = view.CenterOfRotation = {camera.target}
view.CameraViewUp = {camera.up}
view.CameraViewAngle = {camera.angle}
Render()
"""


def _state_path(path: Path) -> Path:
    """Returns the path of the state beside a .vti."""
    return path.with_name(f"{path.stem}_paraview.py")


def _paraview_state(path: Path, bake: Bake, volume: int) -> str:
    """Returns the state for the .vti of a volume, with the camera of still()."""
    isovalue = default_isovalue_of(bake, volume)
    return _STATE.format(
        name=repr(path.name),
        folder=repr(str(path.resolve().parent)),
        isovalue=float(bake.isovalue_of(volume, isovalue)),
        camera=camera_around_bake(bake, isovalue=isovalue),
    )


def polygons(surface: Surface, exposure: float) -> vtkPolyData:
    """Returns a Surface as VTK's polygons, in world coordinates.

    Point data: radiance (W/(m^2 sr), linear RGB), color (uchar, sRGB at the exposure) and normals.
    Volumes that color it add their values (float). A value is NaN where they have none.
    """
    mesh = vtkPolyData()
    points = vtkPoints()
    points.SetData(numpy_to_vtk(surface.vertices, deep=True))
    mesh.SetPoints(points)
    corners = np.ascontiguousarray(surface.triangles, np.int64).ravel()
    ends = np.arange(0, len(corners) + 1, 3, dtype=np.int64)
    cells = vtkCellArray()
    cells.SetData(*(numpy_to_vtkIdTypeArray(numbers, deep=True) for numbers in (ends, corners)))
    mesh.SetPolys(cells)
    arrays = {
        "radiance": surface.radiance,
        "color": display_colors(surface.radiance, exposure),
    }
    arrays |= identifiers(surface.values, [*arrays, "normals"])
    for name, values in arrays.items():
        mesh.GetPointData().AddArray(_named(name, values))
    mesh.GetPointData().SetNormals(_named("normals", surface.normals))
    return mesh


def write_vtp(path: AnyPath, surface: Surface, exposure: float, isovalue: float) -> None:
    """Writes the polygons of a Surface. Field data: isovalue, exposure, unit (of lengths).

    Raises LeaflightError.
    """
    check_writable(path, ".vtp")
    mesh = polygons(surface, exposure)
    _add_text_and_numbers(mesh, isovalue=isovalue, exposure=exposure, unit=surface.unit)
    with replaced(path) as temporary:
        _write(vtkXMLPolyDataWriter(), mesh, temporary)


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
    color = display_colors(grid.radiance, exposure)
    for name, values in grid.arrays(color=color).items():
        rows = np.ascontiguousarray(values).reshape(nx * ny * nz, -1)
        image.GetPointData().AddArray(_named(name, rows))
    image.GetPointData().SetActiveScalars("value")
    _add_text_and_numbers(
        image, isovalues=bake.isovalues, exposure=exposure, bake_id=bake.id, unit=bake.unit
    )
    with replaced_together(path, _state_path(path)) as (data, state):
        _write(vtkXMLImageDataWriter(), image, data)
        state.write_text(_paraview_state(path, bake, volume), encoding="utf-8")


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


def _named(name: str, values: Array) -> vtkDataArray:
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def _add_text_and_numbers(data: vtkDataObject, **named: str | ArrayLike) -> None:
    """Adds field data by name: texts, numbers or lists of numbers."""
    for name, value in named.items():
        if isinstance(value, str):
            array = vtkStringArray()
            array.InsertNextValue(value)
            array.SetName(name)
        else:
            array = _named(name, np.atleast_1d(np.asarray(value, np.float64)))
        data.GetFieldData().AddArray(array)


def _write(writer: vtkXMLWriter, data: vtkDataObject, path: Path) -> None:
    """Writes a data set by one of VTK's XML writers, compressed. Raises OSError."""
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    # Append raw bytes to the XML, as ParaView does: smaller and faster than base64.
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    # Suppress VTK's text about a full disk; the error below replaces it.
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.SetGlobalWarningDisplay(False)
    try:
        written = writer.Write()
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    # VTK does not notice if the disk is full at the last bytes.
    if not written or not _end(path).endswith(b"</VTKFile>"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _end(path: Path) -> bytes:
    with open(path, "rb") as file:
        file.seek(max(0, path.stat().st_size - 64))
        return file.read().rstrip()
