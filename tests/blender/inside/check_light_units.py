# SPDX-License-Identifier: GPL-3.0-or-later
"""The radiance that is read from an AREA light against what Cycles renders of it."""

import bpy
import numpy as np
from leaflight import scene_export
from tools import add_camera, close, render_exr


def _irradiance(light, point, normal, n=400):
    """Irradiance (3,) of a RectangleLight by the midpoint rule."""
    corner, u, v = (np.array(x) for x in (light.corner, light.edge_u, light.edge_v))
    s = (np.arange(n) + 0.5) / n
    points = corner + s[:, None, None] * u + s[None, :, None] * v
    emitter = np.cross(u, v)
    area = np.linalg.norm(emitter)
    to_light = points - point
    distance2 = (to_light**2).sum(axis=-1)
    cosines = (to_light @ normal).clip(0) * (-to_light @ emitter / area).clip(0) / distance2
    return np.array(light.radiance) * (cosines / distance2).mean() * area


def check_a_probe_under_an_area_light():
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("Black")
    scene.world.color = (0, 0, 0)
    bpy.ops.mesh.primitive_plane_add(size=0.02)
    probe = bpy.context.object
    material = bpy.data.materials.new("Probe")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    bsdf, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    albedo = np.array([0.8, 0.5, 0.3])
    bsdf.inputs[0].default_value = (*albedo, 1.0)
    material.node_tree.links.new(bsdf.outputs[0], output.inputs[0])
    probe.data.materials.append(material)

    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
    lamp.data.shape = "RECTANGLE"
    lamp.data.size, lamp.data.size_y = 0.6, 0.4
    lamp.data.energy = 5.0
    lamp.data.color = (1.0, 0.7, 0.4)
    lamp.location = (0.4, 0.2, 1.0)
    lamp.rotation_euler = (0.2, 0.3, 0.5)
    lamp.scale = (1.5, 0.5, 1.0)
    scene.collection.objects.link(lamp)
    # Beside the light, which a camera right above would have in its way.
    add_camera((0, 0, 0.1), (0, 0, 0), orthographic=0.01)
    bpy.context.view_layer.update()

    leaf = bpy.data.objects.new("Leaf", None)
    description, _ = scene_export.export_scene(bpy.context, leaf)
    (light,) = description.lights
    expected = albedo / np.pi * _irradiance(light, np.zeros(3), np.array([0.0, 0.0, 1.0]))
    path = bpy.app.tempdir + "probe.exr"
    scene.cycles.light_sampling_threshold = 0.0
    rendered = render_exr(path, samples=256, size=16)[..., :3].mean(axis=(0, 1))
    close(rendered / expected, 1.0, 0.01)
