# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene that a bake was made in as Blender objects: meshes, lights, world, exposure."""

import math

import bpy
import mathutils
import numpy as np
from leaflight.scene.scene import AreaLight, SunLight

from .. import versions
from ..show import shader
from . import cornell_box, lights


def build(context, description):
    """Adds all of a scene description but its volumes to the scene, in a collection of its own.

    Returns sentences on what Blender objects cannot take over.
    """
    warnings = []
    collection = bpy.data.collections.new(description.name)
    context.scene.collection.children.link(collection)
    for mesh in description.meshes:
        if mesh.texture is not None:
            warnings.append(f'"{mesh.name}" comes without its image texture')
        collection.objects.link(_mesh(mesh))
    for light in description.lights:
        collection.objects.link(_light(light))
        cone = getattr(light, "cone", None)
        if cone is not None and cone.cosine_falloff != versions.light_units().spot_cosine:
            warnings.append(
                f'Light "{light.name}" comes as bright as it was along its axis only: spots of the '
                "Blender it was baked in fade otherwise towards their edge"
            )
    _surround(context.scene, description.environment, warnings)
    context.scene.view_settings.view_transform = "Standard"
    context.scene.view_settings.exposure = math.log2(description.exposure)
    return warnings


def _mesh(description):
    data = bpy.data.meshes.new(description.name)
    data.from_pydata(description.vertices.tolist(), [], description.triangles.tolist())
    material = bpy.data.materials.new(description.name)
    shader.build_leaf(
        material, description.scattering.upper(), description.ior, description.emission
    )
    shader.set_albedo(material, description.albedo)
    material.diffuse_color = (*description.albedo, 1.0)
    data.materials.append(material)
    return bpy.data.objects.new(description.name, data)


def _light(description):
    if isinstance(description, AreaLight):
        obj = cornell_box.area_light(description)
        obj.data.shape = "ELLIPSE" if description.ellipse else "RECTANGLE"
        wanted = description.radiance
    elif isinstance(description, SunLight):
        obj = _turned("SUN", description.name, description.direction)
        obj.data.angle = description.angle
        wanted = description.irradiance
    else:
        cone = description.cone
        kind, axis = ("POINT", (0, 0, -1)) if cone is None else ("SPOT", cone.axis)
        obj = _turned(kind, description.name, axis, description.position)
        obj.data.shadow_soft_size = description.radius
        versions.harden_falloff(obj.data)
        if cone is not None:
            obj.data.spot_size, obj.data.spot_blend = cone.angle, cone.blend
        wanted = description.intensity
    _brighten(obj, np.array(wanted, np.float64))
    return obj


def _turned(kind, name, direction, position=(0, 0, 0)):
    """A light object that shines along a direction, its local -Z."""
    obj = bpy.data.objects.new(name, bpy.data.lights.new(name, kind))
    turn = mathutils.Vector(direction).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    obj.matrix_world = mathutils.Matrix.Translation(position) @ turn
    return obj


def _brighten(obj, wanted):
    """Gives a light the power whose export is what is wanted (3,)."""
    obj.data.color, obj.data.energy = wanted / wanted.max(), 1.0
    exported = lights.export_light(obj, obj.matrix_basis, lambda: [], [])
    names = ("radiance", "irradiance", "intensity")
    found = next(getattr(exported, name) for name in names if hasattr(exported, name))
    obj.data.energy = wanted.max() / max(found)


def _surround(scene, environment, warnings):
    if environment is None:
        cornell_box.darken_world(scene)
        return
    if environment.image is not None:
        warnings.append(f'The world "{environment.name}" comes without its image')
    if scene.world is not None:
        scene.world.use_fake_user = True
    scene.world = bpy.data.worlds.new(environment.name)
    tree = versions.give_nodes(scene.world)
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    strength = max(environment.radiance)
    background.inputs[0].default_value = (*(x / strength for x in environment.radiance), 1.0)
    background.inputs[1].default_value = strength
