# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the fast way to fill meshes gives the same result as the portable way."""

import bpy
import leaflight
import numpy as np
import pytest
from leaflight_addon import versions
from leaflight_addon.show import fill

VALUES = {
    "vertices": {"co": 3, "select": 1, "hide": 1},
    "loops": {"vertex_index": 1},
    "polygons": {
        "loop_start": 1,
        "loop_total": 1,
        "use_smooth": 1,
        "material_index": 1,
        "normal": 3,
        "select": 1,
        "hide": 1,
    },
}
EDGES = ("select", "hide", "use_seam", "is_loose", "use_edge_sharp")


def _read(collection, name, width, dtype=np.float64):
    values = np.empty(width * len(collection), dtype)
    collection.foreach_get(name, values)
    return values.reshape(-1, width)


def _edges(mesh):
    """Returns vertices and flags of the edges, sorted, and the vertices of each loop's edge."""
    vertices = np.sort(_read(mesh.edges, "vertices", 2, np.int32), axis=1)
    flags = [_read(mesh.edges, name, 1) for name in EDGES]
    known = np.concatenate([vertices, *flags], axis=1)
    of_loops = vertices[_read(mesh.loops, "edge_index", 1, np.int32)[:, 0]]
    return known[np.lexsort(known.T[::-1])], of_loops


def _assert_equal(mesh, other):
    for kind, names in VALUES.items():
        for name, width in names.items():
            ours, theirs = (_read(getattr(m, kind), name, width) for m in (mesh, other))
            np.testing.assert_allclose(ours, theirs, atol=1e-7, err_msg=f"{kind}.{name}")
    for ours, theirs in zip(_edges(mesh), _edges(other)):
        np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_allclose(
        _read(mesh.vertices, "normal", 3), _read(other.vertices, "normal", 3), atol=1e-6
    )


def _triangle():
    return np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.int32)


def _isosurface():
    box = leaflight.bump_box(24)
    vertices, _, triangles = leaflight._core.contour(box.field(), 47.0)
    return vertices, triangles


def _quads():
    y, x = np.mgrid[:20, :31]
    vertices = np.stack([x, y, np.sin(x + y)], axis=-1).reshape(-1, 3)
    corner = np.arange(x.size).reshape(x.shape)
    corners = (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])
    return vertices, np.stack(corners, axis=-1).reshape(-1, 4)


@pytest.mark.parametrize("shape", [_triangle, _isosurface, _quads])
def check_both_ways_give_equal_meshes(shape):
    vertices, faces = shape()
    colors = np.random.default_rng(0).random((len(vertices), 3)).astype(np.float32)
    mesh, other = (bpy.data.meshes.new(name) for name in ("Fast", "Careful"))
    # Fill over the previous content, too.
    fill.fill(mesh, *_quads(), {"radiance": np.ones((620, 3))})
    fill.fill(mesh, vertices, faces, {"radiance": colors})
    fill.fill_with_care(
        other, np.ascontiguousarray(vertices, np.float32), np.ascontiguousarray(faces, np.int32)
    )
    assert len(mesh.polygons) == len(faces) and len(mesh.edges) > 2
    _assert_equal(mesh, other)
    found = _read(mesh.attributes["radiance"].data, "color", 4)
    np.testing.assert_allclose(found[:, :3], colors, atol=1e-7)
    assert (found[:, 3] == 1).all()
    # Neither needs a correction by Blender.
    assert not mesh.validate(verbose=True) and not other.validate()


def check_the_fast_way_is_this_blenders():
    known = versions.mesh_storage() in fill._WAYS
    assert known == (bpy.app.version[:2] == (3, 4) or bpy.app.version >= (4, 2, 0))


def check_structs_of_another_size_are_filled_with_care(monkeypatch):
    if versions.mesh_storage() != "STRUCTS":
        pytest.skip("this Blender's meshes are not made of structs")
    monkeypatch.setitem(fill._STRUCTS, "polygons", 16)
    vertices, triangles = _isosurface()
    mesh, other = (bpy.data.meshes.new(name) for name in ("Fast", "Careful"))
    fill.fill(mesh, vertices, triangles, {})
    fill.fill_with_care(other, vertices, triangles)
    _assert_equal(mesh, other)


def check_nothing_is_no_mesh():
    mesh = bpy.data.meshes.new("Mesh")
    fill.fill(mesh, *_isosurface(), {})
    fill.fill(mesh, np.empty((0, 3)), np.empty((0, 3)), {"radiance": np.empty((0, 3))})
    assert len(mesh.vertices) == len(mesh.edges) == len(mesh.polygons) == 0
