# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a Cornell box around a volume, out of ordinary objects that the user may edit."""

import math

import bpy
import leaflight
import mathutils
import numpy as np

from .. import versions
from ..operators import checks
from ..show import shader
from ..store.cache import world_volume
from . import scene_export, world

# Marks the collection, whatever the user may call it.
COLLECTION = "leaflight_cornell_box"


class LEAFLIGHT_OT_build_cornell_box(bpy.types.Operator):
    bl_idname = "leaflight.build_cornell_box"
    bl_label = "Build Cornell Box"
    bl_description = (
        "Put walls, an area light and a camera around the volumes, as objects that you may edit. "
        "The scene gets a black world"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not checks.has_volume(cls, context):
            return False
        if any(COLLECTION in child for child in context.scene.collection.children_recursive):
            cls.poll_message_set(
                "The scene has a Cornell box; delete its collection to build another"
            )
            return False
        return True

    def execute(self, context):
        leaf = context.object
        try:
            volumes = scene_export.volume_objects(context, leaf)
            box = leaflight.fit_scene(
                leaflight.cornell_box(), [world_volume(obj) for obj in volumes]
            )
        except leaflight.LeaflightError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

        collection = bpy.data.collections.new(box.name)
        collection[COLLECTION] = True
        context.scene.collection.children.link(collection)
        for mesh in box.meshes:
            collection.objects.link(_wall(mesh))
        for light in box.lights:
            collection.objects.link(area_light(light))
        collection.objects.link(_camera(context.scene, box))
        darken_world(context.scene)
        context.scene.view_settings.view_transform = "Standard"
        context.scene.view_settings.exposure = math.log2(box.exposure)
        for obj in volumes:
            obj.leaflight.leaf_albedo = box.leaves[0].albedo
        context.view_layer.update()
        self._warn(context, leaf, box, {obj.name for obj in collection.objects})
        return {"FINISHED"}

    def _warn(self, context, leaf, box, ours):
        """Says now what would stop or spoil the bake later."""
        try:
            surroundings, _, warnings = scene_export.export_scene(context, leaf)
        except leaflight.LeaflightError as error:
            self.report({"WARNING"}, f"Before the bake: {error}")
            return
        corners = np.concatenate([mesh.vertices for mesh in box.meshes])
        for mesh in surroundings.meshes:
            low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
            if mesh.name not in ours and np.all(high > corners.min(axis=0)):
                if np.all(low < corners.max(axis=0)):
                    warnings.append(
                        f'"{mesh.name}" stands in the box and will be baked with it: delete it or '
                        "disable it in renders unless you want that"
                    )
        for warning in warnings:
            self.report({"WARNING"}, warning)


def _wall(description):
    """The object stands at the middle of its wall, so that it turns and scales about it."""
    middle = description.vertices.mean(axis=0)
    mesh = bpy.data.meshes.new(description.name)
    mesh.from_pydata((description.vertices - middle).tolist(), [], description.triangles.tolist())
    material = bpy.data.materials.new(description.name)
    shader.build_lambertian(material, description.albedo)
    material.diffuse_color = (*description.albedo, 1.0)
    mesh.materials.append(material)
    obj = bpy.data.objects.new(description.name, mesh)
    obj.location = middle
    return obj


def area_light(description):
    u, v = (np.array(edge, np.float64) for edge in (description.edge_u, description.edge_v))
    light = bpy.data.lights.new(description.name, "AREA")
    light.shape = "RECTANGLE"
    light.size, light.size_y = np.linalg.norm(u), np.linalg.norm(v)
    radiance = np.array(description.radiance, np.float64)
    light.color = radiance / radiance.max()
    light.energy = radiance.max() * light.size * light.size_y / versions.light_units().area
    obj = bpy.data.objects.new(description.name, light)
    # It shines along its local -Z: the local axes are u, -v and -(u x v).
    axes = np.array([u / np.linalg.norm(u), -v / np.linalg.norm(v), -np.cross(u, v)])
    axes[2] /= np.linalg.norm(axes[2])
    middle = np.array(description.corner) + 0.5 * (u + v)
    rotation = mathutils.Matrix(axes.T.tolist()).to_4x4()
    obj.matrix_world = mathutils.Matrix.Translation(middle) @ rotation
    return obj


def _camera(scene, box):
    """A camera before the open side; the opening fills the height of its frame."""
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
    scene.camera = camera
    return camera


def darken_world(scene):
    """The box has a lamp of its own. The user's own world stays in the file."""
    if scene.world is not None:
        if world.is_dark(scene.world):
            return
        scene.world.use_fake_user = True
    scene.world = bpy.data.worlds.new("Black World")
    scene.world.color = (0.0, 0.0, 0.0)
    tree = versions.node_tree(scene.world)
    for node in tree.nodes if tree else ():
        if node.type == "BACKGROUND":
            node.inputs[0].default_value = (0.0, 0.0, 0.0, 1.0)


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_build_cornell_box)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_build_cornell_box)
