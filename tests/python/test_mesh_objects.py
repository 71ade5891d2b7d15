# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests isosurfaces as meshes of VTK, PyVista and trimesh, and bakes as datasets of xarray."""

import sys

import leaflight
import numpy as np
import pytest
from leaflight.io.images import display_colors
from outcomes import refused

EXPOSURE = 2.0


@pytest.fixture(scope="module")
def bake():
    return leaflight.bake(leaflight.bump_box(16), error=20, progress=False, both_sides=True)


@pytest.fixture(scope="module")
def surface(bake):
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


def test_xarray(bake, tmp_path):
    xarray = pytest.importorskip("xarray", reason="xarray (python3-xarray) is not installed")
    data = bake.to_xarray()
    assert dict(data.sizes) == dict(zip("zyx", data.value.shape)) | {"channel": 3}
    assert data.attrs["bake_id"] == bake.id and data.radiance.attrs["units"] == "W m-2 sr-1"
    point = {"x": 0.3, "y": 0.6, "z": 0.5}
    near = data.sel(point, method="nearest")
    places = [[float(near[axis]) for axis in "xyz"]]
    assert np.allclose(places, list(point.values()), atol=0.04)
    field = bake.volume.field()
    np.testing.assert_allclose(near.value, field.sample(np.array(places))[0], rtol=1e-5)
    assert float(data.radiance.sel(channel="r").max()) > 0.1
    assert data.radiance_back.shape == data.radiance.shape
    again = leaflight.as_volume(data.value)
    corner = np.array([[0.0, 0.0, 0.0]])
    np.testing.assert_allclose(again.field().sample(corner), field.sample(corner), rtol=1e-5)
    np.testing.assert_allclose(again.field().bounds, field.bounds, atol=1e-6)
    assert xarray.Dataset.from_dict(data.to_dict()).identical(data)


def test_xarray_of_a_rotated_volume_has_the_matrix_alone():
    pytest.importorskip("xarray", reason="xarray (python3-xarray) is not installed")
    turned = np.array([[0, -0.1, 0, 0], [0.1, 0, 0, 0], [0, 0, 0.1, 0], [0, 0, 0, 1.0]])
    values = leaflight.bump_box(12).values
    bake = leaflight.bake(leaflight.Volume(values, index_to_world=turned), error=50, progress=False)
    data = bake.to_xarray()
    assert set(data.coords) == {"channel"}
    step = np.linalg.norm(np.reshape(data.attrs["index_to_world"], (4, 4))[:3, 0])
    assert step * (data.sizes["x"] - 1) == pytest.approx(1.1)


@pytest.mark.parametrize("package", ["vtkmodules", "pyvista", "trimesh", "xarray"])
def test_a_missing_package_is_one_sentence(bake, surface, package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    owner = bake if package == "xarray" else surface
    method = surface.to_vtk if package == "vtkmodules" else getattr(owner, f"to_{package}")
    refused("pip install", method)
