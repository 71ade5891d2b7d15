# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of scene descriptions as Blender objects that the user may edit."""

import math

import bpy
import mathutils
import numpy as np
from leaflight.scene.lights import AreaLight, SunLight, strengths_of

from .. import versions
from ..show import shader
from . import lights, world


def build(context, description):
    """Adds the meshes, lights and world of a description to the scene, in a new collection.

    Returns sentences on the parts that Blender objects cannot represent.
    """
    warnings = []
    collection = bpy.data.collections.new(description.name)
    context.scene.collection.children.link(collection)
    for mesh in description.meshes:
        if mesh.texture is not None:
            warnings.append(f'"{mesh.name}" is imported without its image texture')
        collection.objects.link(mesh_object(mesh))
    for light in description.lights:
        collection.objects.link(light_object(light))
        cone = getattr(light, "cone", None)
        if cone is not None and cone.cosine_falloff != versions.light_units().spot_cosine:
            warnings.append(
                f'Light "{light.name}" has the right brightness only on its axis, because spots '
                "faded differently in the Blender of the bake"
            )
    environment = description.environment
    if environment is not None and environment.image is not None:
        warnings.append(f'The world "{environment.name}" is imported without its image')
    surround(context.scene, environment)
    context.scene.view_settings.view_transform = "Standard"
    context.scene.view_settings.exposure = math.log2(description.exposure)
    return warnings


def mesh_object(description):
    """Returns a mesh object with its origin at the mean of its vertices."""
    middle = description.vertices.mean(axis=0)
    data = bpy.data.meshes.new(description.name)
    data.from_pydata((description.vertices - middle).tolist(), [], description.triangles.tolist())
    if _is_curved(description):
        data.polygons.foreach_set("use_smooth", [True] * len(data.polygons))
    material = bpy.data.materials.new(description.name)
    shader.build_isosurface(
        material, description.scattering.upper(), description.ior, description.emission
    )
    shader.set_albedo(material, description.albedo)
    material.diffuse_color = (*description.albedo, 1.0)
    data.materials.append(material)
    obj = bpy.data.objects.new(description.name, data)
    obj.location = middle
    return obj


def _is_curved(mesh):
    """True if a mesh has no visible edges: the normals of facets at a vertex are nearly equal."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles].astype(np.float64), 1, 0)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sums = np.zeros_like(mesh.vertices, np.float64)
    np.add.at(sums, mesh.triangles, normals[:, np.newaxis])
    cosines = np.einsum("fk,fck->fc", normals, sums[mesh.triangles])
    return bool(np.all(cosines > 0.97 * np.linalg.norm(sums[mesh.triangles], axis=2)))


def light_object(description):
    if isinstance(description, AreaLight):
        obj = _area_light(description)
    elif isinstance(description, SunLight):
        obj = _turned("SUN", description.name, description.direction)
        obj.data.angle = description.angle
    else:
        cone = description.cone
        kind, axis = ("POINT", (0, 0, -1)) if cone is None else ("SPOT", cone.axis)
        obj = _turned(kind, description.name, axis, description.position)
        obj.data.shadow_soft_size = description.radius
        versions.harden_falloff(obj.data)
        if cone is not None:
            obj.data.spot_size, obj.data.spot_blend = cone.angle, cone.blend
    _brighten(obj, np.array(strengths_of(description), np.float64))
    return obj


def _area_light(description):
    u, v = (np.array(edge, np.float64) for edge in (description.edge_u, description.edge_v))
    light = bpy.data.lights.new(description.name, "AREA")
    light.shape = "ELLIPSE" if description.ellipse else "RECTANGLE"
    light.size, light.size_y = np.linalg.norm(u), np.linalg.norm(v)
    obj = bpy.data.objects.new(description.name, light)
    # An area light shines along its local -Z, so its local axes are u, -v and -(u x v).
    axes = np.array([u / np.linalg.norm(u), -v / np.linalg.norm(v), -np.cross(u, v)])
    axes[2] /= np.linalg.norm(axes[2])
    middle = np.array(description.corner) + 0.5 * (u + v)
    rotation = mathutils.Matrix(axes.T.tolist()).to_4x4()
    obj.matrix_world = mathutils.Matrix.Translation(middle) @ rotation
    return obj


def _turned(kind, name, direction, position=(0, 0, 0)):
    """Returns a light object whose local -Z, along which it shines, has this direction."""
    obj = bpy.data.objects.new(name, bpy.data.lights.new(name, kind))
    turn = mathutils.Vector(direction).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    obj.matrix_world = mathutils.Matrix.Translation(position) @ turn
    return obj


def _brighten(obj, wanted):
    """Sets a light's color and power so that its export has the wanted values (3,)."""
    obj.data.color, obj.data.energy = wanted / wanted.max(), 1.0
    exported = lights.export_light(obj, obj.matrix_basis, lambda: [], [])
    obj.data.energy = wanted.max() / max(strengths_of(exported))


def surround(scene, environment):
    """Gives the scene a world of one color, black without an environment.

    The user's world stays in the file.
    """
    if environment is None and (scene.world is None or world.is_dark(scene.world)):
        scene.world = scene.world or _new_world("Black World", (0.0, 0.0, 0.0))
        return
    if scene.world is not None:
        scene.world.use_fake_user = True
    if environment is None:
        scene.world = _new_world("Black World", (0.0, 0.0, 0.0))
    else:
        scene.world = _new_world(environment.name, environment.radiance)


def _new_world(name, radiance):
    made = bpy.data.worlds.new(name)
    strength = max(radiance)
    color = tuple(x / strength for x in radiance) if strength > 0 else (0.0, 0.0, 0.0)
    made.color = color
    background = next(n for n in versions.give_nodes(made).nodes if n.type == "BACKGROUND")
    background.inputs[0].default_value = (*color, 1.0)
    background.inputs[1].default_value = strength if strength > 0 else 1.0
    return made
