# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera that frames isosurfaces, and the points to which it and a stage are fitted."""

import math

import bpy
import mathutils
import numpy as np
from leaflight.volume.meshes import connected_parts

from ..show import display, fill, isosurfaces

# Angle of view across the frame's shorter side, as of a portrait lens.
_ANGLE = math.radians(26.0)

# Largest shares of the frame's height and width that the points fill. They reach one of the two.
HEIGHT, WIDTH = 0.62, 0.7

# Number of points that is enough for the outline of any isosurface.
_POINTS = 100_000


def new(scene):
    data = bpy.data.cameras.new("Stage Camera")
    is_wide = scene.render.resolution_x >= scene.render.resolution_y
    data.sensor_fit = "VERTICAL" if is_wide else "HORIZONTAL"
    data.angle = _ANGLE
    return bpy.data.objects.new(data.name, data)


def frame(camera, scene, points, direction, elevation):
    """Moves a camera so that world points (n, 3) fill its frame, and keeps its lens.

    direction: from the points to the camera, in radians counterclockwise from -y.
    elevation: of the camera above the points, in radians.
    """
    around, up = (
        mathutils.Matrix.Rotation(a, 3, x) for a, x in ((direction, "Z"), (elevation, "X"))
    )
    # Columns are the camera's local axes: right, up, and toward the viewer.
    axes = np.array(around @ up.inverted() @ mathutils.Matrix.Rotation(math.pi / 2, 3, "X"))
    points = points[:: max(1, len(points) // _POINTS)]
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    seen = (points - middle) @ axes
    half = _half_frame(camera.data, scene)
    distance = 4.0 * max(float(np.abs(seen).max()), 1e-6) / half.min()
    shift = np.zeros(2)
    for _ in range(12):
        depth = distance - seen[:, 2:]
        places = (seen[:, :2] - shift) / depth / half
        low, high = places.min(axis=0), places.max(axis=0)
        shift += 0.5 * (low + high) * half * distance
        larger = float((0.5 * (high - low) / (WIDTH, HEIGHT)).max())
        distance = max(distance * larger, 1.2 * float(seen[:, 2].max()))
    place = middle + axes @ (*shift, distance)
    camera.matrix_world = mathutils.Matrix.Translation(place) @ mathutils.Matrix(axes).to_4x4()
    camera.data.clip_start, camera.data.clip_end = 0.01 * distance, 10.0 * distance


def _half_frame(data, scene):
    """Returns half the width and half the height of the frame at the distance 1."""
    corners = np.array([tuple(corner) for corner in data.view_frame(scene=scene)])
    return 0.5 * np.ptp(corners[:, :2], axis=0) / abs(corners[0, 2])


# Smallest part of an isosurface that counts, as a share of the triangles of its largest part.
_SHARE = 0.1


def shown_points(volumes):
    """Returns world coordinates (n, 3) of the large parts of all visible isosurfaces.

    A volume without visible isosurfaces gives the corners of its box. Raises LeaflightError.
    """
    points = []
    for volume in volumes:
        shown = [_large_parts(obj) for obj in display.surfaces_of(volume)]
        if not any(map(len, shown)):
            box = isosurfaces.world_box(volume)
            shown = [np.array([[x, y, z] for x in box[:, 0] for y in box[:, 1] for z in box[:, 2]])]
        points += shown
    return np.concatenate(points)


def bounds(points):
    return points.min(axis=0), points.max(axis=0)


def _large_parts(obj):
    vertices = fill.read(obj.data.vertices, "co", np.float32, 3)
    corners = fill.read(obj.data.loops, "vertex_index", np.int32)
    matrix = np.array(obj.matrix_world, np.float64)
    large = in_large_parts(len(vertices), corners.reshape(-1, 3))
    return vertices[large] @ matrix[:3, :3].T + matrix[:3, 3]


def in_large_parts(count, triangles):
    """Returns a bool (count,): True for each vertex in a large part of a mesh.

    count: number of vertices. triangles: (m, 3).
    """
    if not len(triangles):
        return np.zeros(count, bool)
    part = connected_parts(triangles, count)
    sizes = np.bincount(part[triangles[:, 0]], minlength=count)
    return sizes[part] >= _SHARE * sizes.max()
