# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as PLY files."""

import meshio
import numpy as np
import pytest
from leaflight import LeaflightError, Surface
from leaflight.io.ply import display_colors, write_ply


@pytest.fixture
def tetrahedron():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int32)
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    radiance = np.array([[0, 0, 0], [0.25, 0.5, 1], [1, 2, 4], [9, 0, 1e-6]], dtype=np.float32)
    return Surface(vertices, normals, triangles, radiance, 0.1)


def test_round_trip(tmp_path, tetrahedron):
    path = tmp_path / "mesh.ply"
    write_ply(path, tetrahedron, exposure=0.5)
    mesh = meshio.read(path)
    np.testing.assert_array_equal(mesh.points, tetrahedron.vertices)
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], tetrahedron.triangles)
    data = mesh.point_data
    radiance = np.stack([data[f"radiance_{c}"] for c in "rgb"], axis=1)
    np.testing.assert_array_equal(radiance, tetrahedron.radiance)
    assert radiance.dtype == np.float32
    colors = np.stack([data[c] for c in ("red", "green", "blue")], axis=1)
    assert colors.dtype == np.uint8
    np.testing.assert_array_equal(colors, display_colors(tetrahedron.radiance, 0.5))
    np.testing.assert_array_equal(data["nz"], tetrahedron.normals[:, 2])
    assert list(tmp_path.iterdir()) == [path]


def test_display_colors():
    # 0.5 is sRGB 188, 0.001 on the linear part is 12.92 * 0.255 = 3.
    radiance = np.array([[0, 0.25, 0.5], [7.0, 0.0005, -1]])
    np.testing.assert_array_equal(display_colors(radiance, 2.0), [[0, 188, 255], [255, 3, 0]])


def test_errors_leave_nothing(tmp_path, tetrahedron):
    for path in (tmp_path / "mesh.obj", tmp_path / "nowhere" / "mesh.ply", tmp_path):
        with pytest.raises(LeaflightError):
            write_ply(path, tetrahedron, exposure=1)
    assert list(tmp_path.iterdir()) == []
