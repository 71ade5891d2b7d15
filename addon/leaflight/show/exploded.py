# SPDX-License-Identifier: GPL-3.0-or-later
"""Exploded views: parts of isosurfaces moved apart along an axis of the data, with their light.

A mesh stores the closed positions of its vertices and their offsets for the distance 1. A new
distance therefore needs no new isosurface, and light is looked up at the closed positions.
"""

import numpy as np

from . import display, fill

# Value of explode_axis without an exploded view.
CLOSED = "NONE"
AXES = [
    (CLOSED, "Closed", "Parts as they are in the data"),
    *((axis, axis, f"Parts moved apart along the {axis} axis of the data") for axis in "XYZ"),
]

# Attributes of a mesh, and its property: the shown distance.
_POSITION, _OFFSET = "closed_position", "explode_offset"
_DISTANCE = "leaflight_exploded"


def axis_of(obj):
    """Returns the axis (3,) along which the parts of an isosurface are moved apart, or None."""
    axis = display.volume_object(obj).leaflight_look.explode_axis
    return None if axis == CLOSED else np.eye(3)["XYZ".index(axis)]


def store(mesh, vertices, offsets, distance):
    """Stores closed vertices (n, 3) and their offsets (n, 3), and shows a distance.

    offsets: None if parts stay as they are.
    """
    shown = mesh.pop(_DISTANCE, distance)
    if offsets is None:
        return
    for name, values in ((_POSITION, vertices), (_OFFSET, offsets)):
        attribute = mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
        attribute.data.foreach_set("vector", np.ascontiguousarray(values, np.float32).ravel())
    move(mesh, shown)


def is_at(mesh, distance):
    """True if the parts of a mesh are this distance apart, or stay as they are."""
    return _OFFSET not in mesh.attributes or mesh.get(_DISTANCE) == distance


def move(mesh, distance):
    """Moves the parts of a mesh apart by a distance, in the coordinates of its object."""
    moved = closed_positions(mesh) + np.float32(distance) * _vectors(mesh, _OFFSET)
    mesh.vertices.foreach_set("co", moved.ravel())
    mesh[_DISTANCE] = distance
    mesh.update()


def closed_positions(mesh):
    """Returns the vertices (n, 3) of a mesh as they are in the data."""
    if _POSITION in mesh.attributes:
        return _vectors(mesh, _POSITION)
    return fill.read(mesh.vertices, "co", np.float32, 3)


def closed_place(obj, place):
    """Returns where in the data a place on an isosurface is. Both are in the object's coordinates.

    A place beside the isosurface counts as one of the nearest part.
    """
    mesh = obj.data
    if _OFFSET not in mesh.attributes:
        return place
    face = obj.closest_point_on_mesh(place)[3]
    vertex = mesh.polygons[face].vertices[0]
    return place - mesh[_DISTANCE] * mesh.attributes[_OFFSET].data[vertex].vector


def _vectors(mesh, name):
    return fill.read(mesh.attributes[name].data, "vector", np.float32, 3)
