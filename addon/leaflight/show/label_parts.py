# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of labels: their material, texts, and the place of the camera's picture."""

import bpy
import numpy as np
from mathutils import Vector

from .. import versions
from . import shader

_LABEL, _WHITE = "Leaflight Label", 0.9
# Distance from the camera, as a multiple of its clip start.
_DISTANCE = 4.0


def white_material():
    """Returns the material of white labels, which all of them share."""
    return bpy.data.materials.get(_LABEL) or gray_material(_LABEL, _WHITE)


def gray_material(name, gray):
    material = bpy.data.materials.new(name)
    versions.do_not_sample_as_light(material)
    shader.build_emission(material, exposed((gray,) * 3))
    return material


def exposed(color):
    """Returns the radiance that the scene's exposure turns into a color."""
    exposure = bpy.context.scene.view_settings.exposure
    return tuple(2.0**-exposure * x for x in color)


def text_curve(words, size):
    """Returns the data of a text that is centered about its origin."""
    curve = bpy.data.curves.new(words, "FONT")
    curve.body, curve.size = words, size
    curve.align_x = curve.align_y = "CENTER"
    return curve


def picture_corners(scene, camera):
    """Returns the lower left and the upper right corner of the picture in camera coordinates."""
    distance = _DISTANCE * camera.data.clip_start
    frame = np.array(camera.data.view_frame(scene=scene))
    if camera.data.type == "PERSP":
        frame *= distance / -frame[0, 2]
    frame[:, 2] = -distance
    return Vector(frame.min(axis=0)), Vector(frame.max(axis=0))
