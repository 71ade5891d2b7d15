# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera that has isosurfaces in its frame."""

import math

import bpy
import mathutils
import numpy as np

# Of view, across the frame's shorter side: a portrait's lens.
_ANGLE = math.radians(26.0)

# The shares of the frame's height and width that are filled at most; one of them is.
HEIGHT, WIDTH = 0.62, 0.7

# As many points show the outline of any isosurface.
_POINTS = 100_000


def new(scene):
    data = bpy.data.cameras.new("Stage Camera")
    is_wide = scene.render.resolution_x >= scene.render.resolution_y
    data.sensor_fit = "VERTICAL" if is_wide else "HORIZONTAL"
    data.angle = _ANGLE
    return bpy.data.objects.new(data.name, data)


def frame(camera, scene, points, direction, elevation):
    """Moves a camera, which keeps its lens, so that world points (n, 3) are in the middle.

    direction: from the points to the camera, in radians counterclockwise from -y; elevation: from
    where it looks down, in radians.
    """
    around, up = (
        mathutils.Matrix.Rotation(a, 3, x) for a, x in ((direction, "Z"), (elevation, "X"))
    )
    # Its local axes: to the right, upwards, and back to the camera.
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
    """Half the width and half the height of the frame at the distance 1."""
    corners = np.array([tuple(corner) for corner in data.view_frame(scene=scene)])
    return 0.5 * np.ptp(corners[:, :2], axis=0) / abs(corners[0, 2])
