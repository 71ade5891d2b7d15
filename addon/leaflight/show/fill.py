# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that fill and read a Blender mesh, in the fastest way of the Blender version.

In the way that works in all versions, Blender finds the edges and copies vertices and corners one
by one. That took more than half of the time to show an isovalue. In the fast ways the core finds
the edges, and arrays are copied to Blender's memory (docs/decisions/meshes.md).
"""

import ctypes

import numpy as np
from leaflight.volume.meshes import PolygonEdges

from .. import versions

# Sizes in bytes of the structs MVert, MEdge, MLoop and MPoly in Blender 3.4.
_STRUCTS = {"vertices": 16, "edges": 12, "loops": 8, "polygons": 12}
# Offset of the flags in an MPoly, and the flag for smooth shading.
_FLAGS, _SMOOTH = 10, 1


def fill(mesh, vertices, faces, colors):
    """Replaces the geometry of a mesh by smooth faces (m, 3) or (m, 4). vertices: (n, 3).

    colors: name of an attribute -> linear RGB (n, 3).
    """
    mesh.clear_geometry()
    if len(faces):
        vertices = np.ascontiguousarray(vertices, np.float32)
        faces = np.ascontiguousarray(faces, np.int32)
        _WAYS.get(versions.mesh_storage(), fill_with_care)(mesh, vertices, faces)
    if len(mesh.vertices):
        for name, values in colors.items():
            color(mesh, name, values)


def read(items, name, kind, width=1):
    """Returns an attribute of the items of a collection: (n,), or (n, width) vectors."""
    numbers = np.empty(width * len(items), kind)
    items.foreach_get(name, numbers)
    return numbers.reshape(-1, width) if width > 1 else numbers


def color(mesh, name, values):
    """Writes linear RGB (n, 3) to the vertices' color attribute of this name."""
    colors = np.ones((len(values), 4), np.float32)
    colors[:, :3] = values
    attribute = mesh.attributes.get(name)
    if attribute is None:
        attribute = mesh.attributes.new(name, "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", colors.ravel())


def fill_with_care(mesh, vertices, faces):
    """Fills an empty mesh with float32 (n, 3) and int32 (m, k), in any version of Blender."""
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.ravel())
    mesh.loops.add(faces.size)
    mesh.loops.foreach_set("vertex_index", faces.ravel())
    mesh.polygons.add(len(faces))
    versions.set_loop_starts(mesh, _starts(faces), faces.shape[1])
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    mesh.update(calc_edges=True)
    _deselect_edges(mesh)


def fill_structs(mesh, vertices, faces):
    """Fills an empty mesh in versions where it consists of arrays of the structs above."""
    edges = PolygonEdges(faces, len(vertices))
    sizes = {
        "vertices": len(vertices),
        "edges": len(edges),
        "loops": faces.size,
        "polygons": len(faces),
    }
    memory = {}
    for name, count in sizes.items():
        getattr(mesh, name).add(count)
        memory[name] = _memory(getattr(mesh, name), _STRUCTS[name])
    if any(known is None for known in memory.values()):
        mesh.clear_geometry()
        fill_with_care(mesh, vertices, faces)
        return
    memory["vertices"].view(np.float32)[:, :3] = vertices
    corners = memory["loops"].view(np.int32)
    corners[:, 0] = faces.ravel()
    edges.write(memory["edges"].view(np.int32)[:, :2], corners[:, 1])
    polygons = memory["polygons"].view(np.int32)
    polygons[:, 0], polygons[:, 1] = _starts(faces), faces.shape[1]
    memory["polygons"][:, _FLAGS] |= _SMOOTH
    _deselect_edges(mesh)
    mesh.update()


def fill_attributes(mesh, vertices, faces):
    """Fills an empty mesh in versions where it consists of attributes and starts of polygons."""
    edges = PolygonEdges(faces, len(vertices))
    of_edges, of_corners = np.empty((len(edges), 2), np.int32), np.empty(faces.size, np.int32)
    edges.write(of_edges, of_corners)
    mesh.vertices.add(len(vertices))
    mesh.edges.add(len(edges))
    mesh.loops.add(faces.size)
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", _starts(faces))
    attributes = mesh.attributes
    attributes["position"].data.foreach_set("vector", vertices.ravel())
    attributes[".edge_verts"].data.foreach_set("value", of_edges.ravel())
    attributes[".corner_vert"].data.foreach_set("value", faces.ravel())
    attributes[".corner_edge"].data.foreach_set("value", of_corners)
    _deselect_edges(mesh)
    mesh.update()


_WAYS = {"STRUCTS": fill_structs, "ATTRIBUTES": fill_attributes}


def _deselect_edges(mesh):
    """Deselects the edges, because Blender selects added edges, and 3.4 arbitrary ones."""
    selected = mesh.attributes.get(".select_edge")
    if selected is not None:
        mesh.attributes.remove(selected)


def _starts(faces):
    return np.arange(0, faces.size, faces.shape[1], dtype=np.int32)


def _memory(collection, size):
    """Returns the bytes (n, size) of a collection of structs, None if they have another size."""
    count, start = len(collection), collection[0].as_pointer()
    if collection[count - 1].as_pointer() - start != (count - 1) * size:
        return None
    return np.frombuffer((ctypes.c_uint8 * (count * size)).from_address(start), np.uint8).reshape(
        count, size
    )
