# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera that has the volumes in its frame."""

import math

import bpy
import mathutils
import numpy as np

# Of view, across the frame's shorter side: a portrait's lens.
_ANGLE = math.radians(26.0)


def around(low, high, elevation, filled, is_wide):
    """A camera object before the side towards -y of a box, that looks down by degrees.

    filled: the share of the frame's shorter side that a cube of the box's diagonal fills. is_wide:
    whether that is its height.
    """
    middle = 0.5 * (low + high)
    height = float(np.linalg.norm(high - low)) / math.sqrt(3.0)
    distance = 0.5 * (float(high[1] - low[1]) + height / filled / math.tan(0.5 * _ANGLE))
    angle = math.radians(elevation)
    place = middle + distance * np.array([0.0, -math.cos(angle), math.sin(angle)])
    data = bpy.data.cameras.new("Stage Camera")
    data.sensor_fit = "VERTICAL" if is_wide else "HORIZONTAL"
    data.angle = _ANGLE
    data.clip_start, data.clip_end = 0.01 * distance, 10.0 * distance
    obj = bpy.data.objects.new(data.name, data)
    turn = mathutils.Vector(middle - place).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    obj.matrix_world = mathutils.Matrix.Translation(place) @ turn
    return obj
