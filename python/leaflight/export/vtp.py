# SPDX-License-Identifier: GPL-3.0-or-later
"""A lit isosurface as VTK's polygons (.vtp), for ParaView."""

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from ..bake.baked import Surface
from ..io.images import display_colors
from ..io.output import check_writable, replaced
from ..paths import AnyPath
from ..scene.volume_texture import identifiers
from .vtk_arrays import add_text_and_numbers, write


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
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        mesh.GetPointData().AddArray(array)
    normals = numpy_to_vtk(np.ascontiguousarray(surface.normals), deep=True)
    normals.SetName("normals")
    mesh.GetPointData().SetNormals(normals)
    return mesh


def write_vtp(path: AnyPath, surface: Surface, exposure: float, isovalue: float) -> None:
    """Writes the polygons of a Surface. Field data: isovalue, exposure, unit (of lengths).

    Raises LeaflightError.
    """
    check_writable(path, ".vtp")
    mesh = polygons(surface, exposure)
    add_text_and_numbers(mesh, isovalue=isovalue, exposure=exposure, unit=surface.unit)
    with replaced(path) as temporary:
        write(vtkXMLPolyDataWriter(), mesh, temporary)
