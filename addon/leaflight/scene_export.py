# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the surroundings of a volume back from the Blender scene.

What the renders show is what the bake sees: every object that renders, except the volume itself.
What the bake cannot model raises LeaflightError with one sentence that names the object.
"""

import hashlib
import math

import bpy
import numpy as np

from . import core, materials
from .core.scene import Mesh, RectangleLight, SceneDescription

LeaflightError = core.LeaflightError

# Radiance of an AREA light = factor * watts / area, from a Blender version on. Verified in 3.4.1
# and in 5.2.2; in which release between them it changed is not known. The tests render a probe.
AREA_LIGHT_FACTOR = (((3, 4, 0), 1.0 / 4.0), ((5, 0, 0), 1.0 / math.pi))

_MESH_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
_UNSEEN_TYPES = {"EMPTY", "CAMERA", "ARMATURE", "LATTICE", "SPEAKER", "GPENCIL", "LIGHT_PROBE"}


def export_scene(context, leaf):
    """The surroundings of the volume object `leaf` in world space, and a list of warnings.

    Returns (SceneDescription, [sentence, ...]). Raises LeaflightError.
    """
    depsgraph = context.evaluated_depsgraph_get()
    meshes, lights, warnings = [], [], []
    _check_world(context.scene.world)
    for obj, matrix in rendered_objects(context.view_layer, depsgraph):
        if obj.original == leaf:
            continue
        if obj.original.leaflight.is_volume:
            raise LeaflightError(
                f'"{obj.name}" is a second Leaflight volume, but a bake lights one at a time: '
                f'disable "{obj.name}" in renders, then bake again.'
            )
        if obj.type == "LIGHT":
            lights.append(_rectangle_light(obj, matrix))
        elif obj.type in _MESH_TYPES:
            meshes += _meshes(obj, matrix, warnings)
        elif obj.type not in _UNSEEN_TYPES:
            raise LeaflightError(
                f'"{obj.name}" is of type {obj.type.title()}, which the bake cannot light: '
                "convert it to a mesh or disable it in renders."
            )
    description = SceneDescription(
        name=context.scene.name,
        leaf_albedo=tuple(leaf.leaflight.leaf_albedo),
        exposure=2.0**context.scene.view_settings.exposure,
        meshes=meshes,
        lights=lights,
    )
    return description, warnings


def fingerprint(leaf, description):
    """A hash that changes when the volume, its window or anything that lights it changes."""
    digest = hashlib.sha256()
    digest.update(np.array(leaf.matrix_world, np.float64).tobytes())
    digest.update(np.array([leaf.leaflight.low, leaf.leaflight.high], np.float64).tobytes())
    digest.update(np.array(description.leaf_albedo, np.float64).tobytes())
    for mesh in description.meshes:
        digest.update(mesh.vertices.tobytes())
        digest.update(mesh.triangles.tobytes())
        digest.update(np.array(mesh.albedo, np.float64).tobytes())
    for light in description.lights:
        rows = (light.corner, light.edge_u, light.edge_v, light.radiance)
        digest.update(np.array(rows, np.float64).tobytes())
    return digest.hexdigest()


def rendered_objects(view_layer, depsgraph):
    """Yields (evaluated object, world matrix) of all that renders, instances included."""
    rendered = {}
    _collect(view_layer.layer_collection, rendered)
    for obj in rendered.values():
        if obj.is_instancer and not obj.show_instancer_for_render:
            continue
        yield obj.evaluated_get(depsgraph), obj.matrix_world
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.parent.original.name_full in rendered:
            yield instance.instance_object, instance.matrix_world.copy()


def _collect(layer_collection, rendered):
    collection = layer_collection.collection
    if layer_collection.exclude or collection.hide_render:
        return
    for obj in collection.objects:
        if obj.hide_render:
            continue
        if obj.hide_viewport or collection.hide_viewport:
            raise LeaflightError(
                f'"{obj.name}" is disabled in viewports but not in renders, so its present shape '
                "is unknown: enable it in viewports (hiding it with the eye is fine), or disable "
                "it in renders too."
            )
        rendered[obj.name_full] = obj
    for child in layer_collection.children:
        _collect(child, rendered)


def area_light_factor(version):
    """Radiance of an AREA light of one watt and unit area in the given Blender version."""
    factors = [factor for since, factor in AREA_LIGHT_FACTOR if version >= since]
    if not factors:
        raise LeaflightError("Leaflight needs Blender 3.4 or later.")
    return factors[-1]


def _rectangle_light(obj, matrix):
    light = obj.data
    if light.type != "AREA":
        raise LeaflightError(
            f'Light "{obj.name}" is a {light.type.title()} light, but the bake models Area lights: '
            "change its type, delete it or disable it in renders."
        )
    if light.shape not in {"SQUARE", "RECTANGLE"}:
        raise LeaflightError(
            f'Light "{obj.name}" has the shape {light.shape.title()}, but the bake models '
            "squares and rectangles: change its shape."
        )
    if light.spread < math.radians(179.9):
        raise LeaflightError(
            f'Light "{obj.name}" has a spread of {math.degrees(light.spread):.0f} degrees, but the '
            "bake models a spread of 180 degrees: change its spread."
        )
    if not light.cycles.cast_shadow or light.cycles.is_portal:
        raise LeaflightError(
            f'Light "{obj.name}" is a portal or casts no shadows, which the bake cannot model: '
            "change that in its settings or disable it in renders."
        )
    tint = materials.light_tint(obj.name, light)
    width = light.size
    height = light.size if light.shape == "SQUARE" else light.size_y
    axes = np.array(matrix, np.float64)
    edge_u, edge_v = axes[:3, 0] * width, axes[:3, 1] * height
    normal = np.cross(edge_u, edge_v)
    area = np.linalg.norm(normal)
    if not area > 0:
        raise LeaflightError(f'Light "{obj.name}" has no area: give it a size above zero.')
    if abs(edge_u @ edge_v) > 1e-4 * area:
        raise LeaflightError(
            f'Light "{obj.name}" is sheared by its parent, but the bake models rectangles: '
            "apply or remove the parent's scale."
        )
    # It shines along its local -Z, towards the cross product of the edges.
    if normal @ axes[:3, 2] > 0:
        edge_v = -edge_v
    power = np.array(light.color, np.float64) * light.energy * tint
    if not np.all(power >= 0):
        raise LeaflightError(f'Light "{obj.name}" has a negative power: make it zero or positive.')
    corner = axes[:3, 3] - 0.5 * (edge_u + edge_v)
    radiance = power * area_light_factor(bpy.app.version) / area
    return RectangleLight(obj.name, *(tuple(v) for v in (corner, edge_u, edge_v, radiance)))


def _meshes(obj, matrix, warnings):
    """One Mesh per material slot in use, of the evaluated object with its modifiers."""
    mesh = obj.to_mesh()
    try:
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        if count == 0:
            return []
        vertices = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", vertices)
        triangles = np.empty(3 * count, np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
        slot = np.empty(count, np.int32)
        mesh.loop_triangles.foreach_get("material_index", slot)
    finally:
        obj.to_mesh_clear()
    axes = np.array(matrix, np.float64)
    world = vertices.reshape(-1, 3) @ axes[:3, :3].T + axes[:3, 3]
    world = world.astype(np.float32)
    triangles = triangles.reshape(-1, 3).astype(np.uint32)
    # An index beyond the slots renders with the last one.
    slot = np.clip(slot, 0, max(len(obj.material_slots) - 1, 0))
    parts = []
    for index in np.unique(slot):
        material = obj.material_slots[index].material if obj.material_slots else None
        albedo, warning = materials.diffuse_albedo(obj.name, material)
        if warning and warning not in warnings:
            warnings.append(warning)
        used, renumbered = np.unique(triangles[slot == index], return_inverse=True)
        parts.append(
            Mesh(
                obj.name,
                np.ascontiguousarray(world[used]),
                renumbered.reshape(-1, 3).astype(np.uint32),
                albedo,
            )
        )
    return parts


def is_dark(world):
    """Whether a world, or none, sends no light."""
    return world is None or not np.any(materials.world_radiance(world) > 0)


def _check_world(world):
    if not is_dark(world):
        raise LeaflightError(
            f'World "{world.name}" lights the scene, but the bake models Area lights only: set its '
            "color to black, or press Build Cornell Box."
        )
