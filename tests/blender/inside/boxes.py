# SPDX-License-Identifier: GPL-3.0-or-later
"""The Cornell box of scenes/cornell.json around the volumes, and a camera.

Tolerances of checks were measured in this scene, so it does not change with Stage.
"""

import math

import bpy
import leaflight
import numpy as np
from leaflight_addon.stage import scene_export, scene_objects
from leaflight_addon.store.cache import world_volume


def build_cornell_box():
    bpy.context.view_layer.update()
    volumes = scene_export.volume_objects(bpy.context, bpy.context.object)
    box = leaflight.fit_scene(leaflight.cornell_box(), [world_volume(obj) for obj in volumes])
    assert scene_objects.build(bpy.context, box) == []
    bpy.context.scene.camera = _camera(box)
    for obj in volumes:
        obj.leaflight.isosurface_albedo = box.isosurfaces[0].albedo
    bpy.context.view_layer.update()


def _camera(box):
    """Adds a camera in front of the open side, which fills the height of its frame."""
    corners = np.concatenate([mesh.vertices for mesh in box.meshes]).astype(np.float64)
    low, high = corners.min(axis=0), corners.max(axis=0)
    width = max(high[0] - low[0], high[2] - low[2])
    data = bpy.data.cameras.new("Cornell Box Camera")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(39.3)
    distance = 0.5 * width / math.tan(0.5 * data.angle)
    middle = 0.5 * (low + high)
    camera = bpy.data.objects.new(data.name, data)
    camera.location = (middle[0], low[1] - distance, middle[2])
    camera.rotation_euler = (0.5 * math.pi, 0.0, 0.0)
    data.clip_start, data.clip_end = 0.01 * distance, 10.0 * distance
    bpy.context.scene.collection.objects.link(camera)
    return camera
