# SPDX-License-Identifier: GPL-3.0-or-later
"""The display of walls with the light of the present isosurface: shadows and color bleeding.

A bake that lights the walls holds their radiance for every isosurface. A display object shows it in
place of each baked mesh. The original is hidden meanwhile and marked, so that the next bake still
sees it.
"""

import threading
from contextlib import suppress

import bpy
import numpy as np
from leaflight import LeaflightError

from ..store import cache
from ..store.reading import StillReading
from . import display, fill, lamps, preview, shader, surface_object
from .isosurface import RADIANCE, RADIANCE_BACK

COLLECTION = "Leaflight Walls"

_COLLECTION = "leaflight_walls"
_WALL = "wall"
_INDEX, _NAME = "leaflight_wall", "leaflight_wall_name"
_WALL_MATERIAL = "leaflight_wall_material"
_HIDDEN = "leaflight_hidden"
_SHOWN = "leaflight_shown"
_BAKED_AS = "leaflight_baked_as"

_completing = threading.Lock()


def is_hidden(obj):
    """True if an object is hidden because its display renders in its place."""
    return _HIDDEN in obj


def forget_names(scene):
    """Removes the baked names from all objects, after a bake under their present names."""
    for obj in scene.objects:
        if _BAKED_AS in obj:
            del obj[_BAKED_AS]


def refresh(scene):
    """Shows the lit walls or the original objects, as the user has chosen.

    Their bake may still be read: complete() follows.
    """
    _clear(scene)
    leader = _leader(scene)
    if leader is not None and scene.leaflight.show_walls:
        try:
            _build(scene, leader)
        except StillReading:
            return
        except LeaflightError as error:
            _clear(scene)
            surface_object.problems[leader.name_full] = str(error)
            return
    update(scene)


def show_pass(scene):
    """Lights the walls with the pass that lights the volumes, if it has their light."""
    leader = _leader(scene)
    if leader is None or not _pass_with_walls(leader):
        return
    displays = _displays(scene)
    if displays and all(_has_as_many_vertices(obj, _bake_of(leader)[0]) for obj in displays):
        update(scene)
    else:
        refresh(scene)


def _has_as_many_vertices(obj, bake):
    index = obj[_INDEX]
    known = bake.walls.count > index and bake.scene.meshes[index].name == obj.get(_NAME)
    return known and len(bake.walls.mesh(index)[0]) == len(obj.data.vertices)


def complete(scene):
    """Shows the lit walls once a bake has their light.

    A render and the window may call it at the same time, in different threads.
    """
    with _completing:
        if _displays(scene):
            update(scene)
        elif _leader(scene) is not None:
            refresh(scene)


def finish(scene):
    """Shows the lit walls for a render, and waits if their present light is missing or old."""
    leader, displays = _leader(scene), _displays(scene)
    if leader is None:
        return
    waits = scene.leaflight.show_walls and cache.lacks_walls(leader)
    if _stale(displays, leader) or (waits and not displays):
        with suppress(LeaflightError):
            cache.bake_of(leader)
        complete(scene)


def are_orphans(scene):
    """True if the volume that lit the displays of a scene is gone."""
    displays = _displays(scene)
    if not displays or _leader(scene) is not None:
        return False
    return any(not any(map(_leader, obj.users_scene)) for obj in displays)


def remove_orphans():
    for scene in bpy.data.scenes:
        if are_orphans(scene):
            _clear(scene)


def update(scene):
    """Lights the displays for the present isosurface unless they already show its light."""
    displays = _displays(scene)
    leader = _leader(scene) if displays else None
    stale = _stale(displays, leader) if leader is not None else []
    if not stale:
        return
    of_pass, label = _pass_with_walls(leader), _label(leader)
    try:
        bake, index = _bake_of(leader)
    except StillReading:
        return
    except LeaflightError as error:
        surface_object.problems[leader.name_full] = str(error)
        return
    if bake.walls is None:
        return
    low, high = bake.isovalues
    c = min(max(_common_isovalue(leader, bake, index), low), high)
    for obj in stale:
        if of_pass:
            # The vertices of a pass may have moved.
            vertices = bake.walls.mesh(obj[_INDEX])[0]
            obj.data.vertices.foreach_set("co", vertices.ravel())
        for name, back in ((RADIANCE, False), (RADIANCE_BACK, True)):
            radiance = bake.walls.radiance(obj[_INDEX], c, back=back)
            fill.color(obj.data, name, radiance)
        obj.data[_SHOWN] = label
        obj.data.update()


def _displays(scene):
    return [obj for obj in scene.objects if display.is_display(obj, _WALL)]


def _stale(displays, leader):
    """Returns the displays that do not show the light of the present isosurface."""
    return [obj for obj in displays if obj.data.get(_SHOWN) != _label(leader)]


def _label(leader):
    settings = leader.leaflight
    light = f"{settings.bake_id} {lamps.label(settings)}"
    if _pass_with_walls(leader):
        light = f"pass {preview.of(leader).walls_key}"
    return f"{surface_object.shown_isovalue(leader)!r} lit by {light}"


def _leader(scene):
    """Returns the volume whose bake or pass has lit the walls, or None."""
    volumes = [obj for obj in scene.objects if _pass_with_walls(obj)] or [
        obj for obj in scene.objects if obj.leaflight.bake_walls
    ]
    shown = [obj for obj in volumes if not obj.hide_render]
    return min(shown or volumes, key=lambda obj: obj.leaflight.bake_index, default=None)


def _pass_with_walls(obj):
    shown = preview.of(obj)
    return shown is not None and shown.walls is not None


def _bake_of(leader):
    """Returns (bake that lights the walls, index of the leader's volume in it).

    Raises LeaflightError.
    """
    if _pass_with_walls(leader):
        shown = preview.of(leader)
        return shown.walls, shown.index
    return lamps.light_of(leader), leader.leaflight.bake_index


def _common_isovalue(leader, bake, index):
    lowest, highest = (bake.isovalue_of(index, c) for c in bake.isovalues)
    low, high = bake.isovalues
    part = (surface_object.shown_isovalue(leader) - lowest) / (highest - lowest)
    return low + part * (high - low)


def _build(scene, leader):
    bake, _ = _bake_of(leader)
    if bake.walls is None:
        return
    collection = bpy.data.collections.new(COLLECTION)
    collection[_COLLECTION] = True
    scene.collection.children.link(collection)
    shared = material()
    for index, mesh in enumerate(bake.scene.meshes):
        original = _original(scene, mesh.name)
        # Leave mirrors and glass as they are, because their radiance depends on the view.
        if original is None or mesh.scattering != "diffuse":
            continue
        collection.objects.link(_display(bake, index, mesh.name, shared))
        original[_BAKED_AS] = mesh.name
        # An object with several materials has a mesh for each.
        if not (is_hidden(original) or original.hide_render):
            display.hide(scene, original, _HIDDEN)


def _original(scene, name):
    """Returns the object that was baked under a name, even if it was renamed, or None."""
    marked = (obj for obj in scene.objects if obj.get(_BAKED_AS) == name)
    return next(marked, None) or scene.objects.get(name)


def material():
    """Returns the material that all displays share."""
    return shader.shared_material(_WALL_MATERIAL, "Leaflight Wall", RADIANCE, RADIANCE_BACK)


def _display(bake, index, name, shared):
    vertices, triangles = bake.walls.mesh(index)
    data = bpy.data.meshes.new(f"{name} Lit")
    fill.fill(data, vertices, triangles, {})
    data.polygons.foreach_set("use_smooth", np.zeros(len(triangles), bool))
    data.materials.append(shared)
    obj = bpy.data.objects.new(f"{name} Lit", data)
    display.mark(obj, _WALL)
    obj[_INDEX], obj[_NAME] = index, name
    obj.hide_select = True
    return obj


def _clear(scene):
    """Removes the displays and shows the original objects."""
    for obj in _displays(scene):
        bpy.data.meshes.remove(obj.data)
    for collection in [c for c in scene.collection.children if _COLLECTION in c]:
        bpy.data.collections.remove(collection)
    for obj in scene.objects:
        if is_hidden(obj):
            display.show(scene, obj, _HIDDEN)
