# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of the Blender scene to the bake.

The export includes every object that renders. Anything that the bake cannot model raises
LeaflightError, with one sentence that names the object.
"""

import dataclasses
import functools
import hashlib

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.scene import SceneDescription

from .. import versions
from ..show import display, isosurfaces, walls
from . import images, lights, meshes, world

_MESH_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}

# Properties that hide an object from some rays of Cycles. The bake's rays hit all objects.
_VISIBILITIES = ("visible_diffuse", "visible_glossy", "visible_transmission", "visible_shadow")


def export_scene(context, isosurface):
    """Exports all objects that render, in world space, and always the volume object `isosurface`.

    Returns (SceneDescription, [volume object, ...], [sentence of warning, ...]). The volumes have
    the order of the description's isosurfaces. Raises LeaflightError.
    """
    _check_colors()
    depsgraph = context.evaluated_depsgraph_get()
    volumes = volume_objects(context, isosurface)
    boxes = functools.cache(lambda: [isosurfaces.world_box(obj) for obj in volumes])
    walls, lamps, warnings = [], [], []
    for obj, matrix in rendered_objects(context.view_layer, depsgraph):
        if obj.original in volumes or display.is_display(obj.original):
            continue
        if obj.original.leaflight.is_volume:
            raise LeaflightError(
                f'"{obj.name}" is an instance of a Leaflight volume, which cannot be baked: make '
                "its instances real, or disable them in renders."
            )
        if obj.type == "LIGHT":
            light = lights.export_light(obj, matrix, boxes, warnings)
            lamps += [light] if light is not None else []
        elif obj.type in _MESH_TYPES:
            walls += meshes.export_meshes(obj, matrix, warnings)
        elif obj.type not in versions.UNSEEN_TYPES:
            raise LeaflightError(
                f'"{obj.name}" is of type {obj.type.title()}, which the bake cannot light: '
                "convert it to a mesh or disable it in renders."
            )
        if not all(getattr(obj, name) for name in _VISIBILITIES):
            warnings.append(
                f'"{obj.name}" is hidden from some kinds of rays, but is baked as visible to all: '
                "reset its ray visibility for a match"
            )
        if versions.links_light(obj):
            warnings.append(
                f'"{obj.name}" lights or shades only the objects of its light linking, but is '
                "baked as if it lit all: clear its light linking for a match"
            )
    warnings += [sentence for obj in volumes for sentence in _warnings_of(obj)]
    if lamps and not versions.lights_are_checked():
        warnings.append(
            "Lights of this version of Blender are not tested, so they may be baked too bright "
            "or too dark: check with a Render Comparison"
        )
    description = SceneDescription(
        name=context.scene.name,
        isosurfaces=[isosurfaces.export_isosurfaces(obj, len(volumes) > 1) for obj in volumes],
        exposure=2.0**context.scene.view_settings.exposure,
        meshes=walls,
        lights=lamps,
        environment=world.export_world(context.scene.world),
    )
    return description, volumes, warnings


def _check_colors():
    space = versions.working_space()
    if space != "Linear Rec.709":
        raise LeaflightError(
            f"The working space of this file is {space}, but bakes use Linear Rec.709: choose "
            "that under Color Management in the render properties."
        )


def _warnings_of(volume):
    settings = volume.leaflight
    if settings.isosurface_scattering == "GLASS" and not settings.capped:
        yield (
            f'"{volume.name}" is glass but not capped, so its inside is open at the border and '
            "renders differ from the bake: turn Capped on"
        )


def check_light(description):
    """Raises LeaflightError if nothing in a scene emits light."""
    emitters = [*description.meshes, *description.isosurfaces]
    glows = any(np.max(isosurfaces.colors(emitter.emission)) > 0 for emitter in emitters)
    if not (description.lights or description.environment or glows):
        raise LeaflightError(
            "No rendered object emits light, so the bake would be black: add a light, or "
            "brighten the world."
        )


def fingerprint(volumes, description):
    """Returns a hash of the volumes' places and isovalue ranges, and of all that lights them."""
    digest = hashlib.sha256()
    for obj in volumes:
        _add(digest, np.array(obj.matrix_world, np.float64))
        _add(digest, (obj.leaflight.low, obj.leaflight.high))
    for part in (description.isosurfaces, description.meshes, description.lights):
        _add(digest, part)
    _add(digest, description.environment)
    return digest.hexdigest()


def _add(digest, value):
    """Adds plain data to a hash, except names and sources."""
    if dataclasses.is_dataclass(value):
        for part in dataclasses.fields(value):
            if part.name not in {"name", "source"}:
                _add(digest, getattr(value, part.name))
    elif isinstance(value, np.ndarray):
        digest.update(str((value.dtype, value.shape)).encode())
        digest.update(images.digest(value))
    elif isinstance(value, (list, tuple)):
        digest.update(f"{len(value)}[".encode())
        for item in value:
            _add(digest, item)
    else:
        digest.update(f"{value!r};".encode())


def volume_objects(context, isosurface):
    """Returns the volumes that a bake lights: `isosurface`, and all volumes that render."""
    rendered = {}
    _collect(context.view_layer.layer_collection, rendered)
    chosen = [obj for obj in rendered.values() if obj.leaflight.is_volume]
    if isosurface not in chosen:
        chosen.append(isosurface)
    return sorted(chosen, key=lambda obj: obj.name_full)


def rendered_objects(view_layer, depsgraph):
    """Yields (evaluated object, world matrix) of all objects and instances that render."""
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
        if obj.hide_render and not walls.is_hidden(obj):
            continue
        if obj.hide_viewport or collection.hide_viewport:
            raise LeaflightError(
                f'"{obj.name}" is disabled in viewports but not in renders, so its current shape '
                "is unknown: enable it in viewports, or disable it in renders."
            )
        rendered[obj.name_full] = obj
    for child in layer_collection.children:
        _collect(child, rendered)
