# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes inside Blender, and their pictures by Cycles."""

import math

import bpy
import mathutils
from PIL import Image


def empty_scene():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)


def turn(obj, *degrees):
    """Turns an object about the axes x, y and z of the scene."""
    angles = mathutils.Euler([math.radians(angle) for angle in degrees])
    obj.matrix_world = angles.to_matrix().to_4x4() @ obj.matrix_world


def rendered(path, size, samples):
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", samples
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.filepath = str(path.resolve())
    bpy.ops.render.render(write_still=True)
    return Image.open(path).convert("RGB")
