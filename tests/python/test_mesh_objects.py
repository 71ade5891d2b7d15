# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests isosurfaces as meshes of VTK, PyVista and trimesh."""

import sys

import leaflight
import numpy as np
import pytest
from leaflight.io.images import display_colors

EXPOSURE = 2.0


@pytest.fixture(scope="module")
def surface():
    bake = leaflight.bake(leaflight.bump_box(16), error=20, progress=False)
    return bake.surface(47.0)


def test_vtk(surface):
    pytest.importorskip("vtkmodules", reason="VTK (python3-vtk9) is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    mesh = surface.to_vtk(EXPOSURE)
    data = mesh.GetPointData()
    np.testing.assert_array_equal(vtk_to_numpy(mesh.GetPoints().GetData()), surface.vertices)
    np.testing.assert_array_equal(vtk_to_numpy(data.GetNormals()), surface.normals)
    colors = display_colors(surface.radiance, EXPOSURE)
    np.testing.assert_array_equal(vtk_to_numpy(data.GetArray("color")), colors)


def test_pyvista(surface):
    pytest.importorskip("pyvista", reason="PyVista of PyPI is not installed")
    mesh = surface.to_pyvista(EXPOSURE)
    np.testing.assert_array_equal(mesh.points, surface.vertices)
    np.testing.assert_array_equal(mesh.regular_faces, surface.triangles)
    np.testing.assert_array_equal(mesh.point_data["radiance"], surface.radiance)


def test_trimesh(surface):
    pytest.importorskip("trimesh", reason="trimesh of PyPI is not installed")
    mesh = surface.to_trimesh(EXPOSURE)
    np.testing.assert_array_equal(mesh.faces, surface.triangles)
    np.testing.assert_array_equal(mesh.vertex_attributes["radiance"], surface.radiance)
    colors = display_colors(surface.radiance, EXPOSURE)
    np.testing.assert_array_equal(mesh.visual.vertex_colors[:, :3], colors)


@pytest.mark.parametrize("package", ["vtkmodules", "pyvista", "trimesh"])
def test_a_missing_package_is_one_sentence(surface, package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    method = surface.to_vtk if package == "vtkmodules" else getattr(surface, f"to_{package}")
    with pytest.raises(leaflight.LeaflightError, match="pip install"):
        method()
