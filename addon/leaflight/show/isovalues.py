# SPDX-License-Identifier: GPL-3.0-or-later
"""The display of each volume at its isovalue, with a common isovalue for linked volumes.

At the common isovalue c a volume shows the isovalue low + c (high - low) of its range. A linked
volume follows the volume whose isovalue was moved, unless it is animated. A move is detected by
comparison with the isovalue that the mesh stores, because undo and loading restore both together.

Blender does not duplicate added isosurfaces, because they cannot be selected. A duplicate of a
volume gets copies of them here. Each volume with added isosurfaces has a unique mark, so that two
volumes with the same mark are duplicates.
"""

from contextlib import suppress

import bpy
from leaflight import LeaflightError

from .. import versions
from ..store import cache, frame_bakes
from . import display, surface_material, surface_object, walls

# Paths of the properties for drivers and keyframes, from the object.
ISOVALUE_PATH = 'leaflight["isovalue"]'
FRAME_PATH = frame_bakes.PATH


def isovalue_range(settings):
    """Returns the isovalues (low, high) of the bake, or else of the settings.

    They belong to the common isovalues 0 and 1.
    """
    if settings.bake_id:
        return settings.bake_low, settings.bake_high
    return settings.low, settings.high


def common_isovalue(settings, isovalue):
    """Returns the common isovalue, 0 to 1 in the isovalue range, and 0 for an empty range."""
    low, high = isovalue_range(settings)
    return (isovalue - low) / (high - low) if high > low else 0.0


def isovalue_at(settings, c):
    low, high = isovalue_range(settings)
    return low + c * (high - low)


def volumes(scene):
    return [obj for obj in isosurfaces(scene) if obj.leaflight.is_volume]


def isosurfaces(scene):
    """Returns the volumes of a scene and their added isosurfaces."""
    found = [obj for obj in scene.objects if display.is_isosurface(obj)]
    display.note((*found, *filter(display.is_label, scene.objects)))
    return found


def limit(obj):
    """Limits the slider of an isosurface to the data, and softly to the volume's range."""
    volume = display.volume_object(obj)
    data_range = cache.volume_of(volume).data_range()
    obj.leaflight.limit_isovalue(
        data_range, isovalue_range(volume.leaflight), obj.leaflight.isovalue
    )


def limit_all(volume):
    """Calls limit() for the isosurfaces of a volume object, unless its data are still read."""
    with suppress(LeaflightError):
        for surface in display.surfaces_of(volume):
            limit(surface)


def orphans():
    """Returns the displays of volumes that are gone."""
    displays = filter(display.is_display, display.noted())
    return [obj for obj in displays if display.is_left_behind(obj)]


def remove_orphans():
    # The parts of a removed display are orphans, too.
    while found := orphans():
        for obj in found:
            display.remove(obj)


def partners(obj, scene):
    """Returns the other volumes of the scene that move with this one."""
    if not _linked(obj):
        return []
    return [other for other in volumes(scene) if other != obj and _linked(other)]


def set_isovalue(obj, isovalue):
    """Shows an isovalue that a script has set, and moves the linked volumes.

    Waits for their files.
    """
    with cache.waiting():
        surface_object.update(obj, isovalue)
        for scene in obj.users_scene:
            for other in partners(obj, scene):
                if not _is_animated(other):
                    _follow(other, obj, isovalue)
            walls.update(scene)


def show_frame(obj):
    """Shows the frame of a file that a script or the slider has chosen."""
    if frame_bakes.switch(obj, frame_bakes.wanted(obj.leaflight)):
        surface_object.update_all(obj)
        for scene in obj.users_scene:
            walls.update(scene)


def update(scene, depsgraph, moving=False):
    """Shows every isosurface of the scene at its evaluated isovalue, or at that of its leader.

    Only the evaluated object has the animated value; in a render the original lags behind.
    moving: see surface_object.update(). Returns the objects whose isovalue has changed.
    """
    found = [obj for obj in isosurfaces(scene) if obj.mode == "OBJECT"]
    evaluated = {obj: obj.evaluated_get(depsgraph) for obj in found}
    for obj in found:
        if depsgraph.mode == "RENDER" and obj.hide_render:
            _choose_frame(obj, scene)
            evaluated[obj] = obj
        if frame_bakes.is_behind(obj, evaluated[obj]):
            frame_bakes.switch(obj, frame_bakes.wanted(evaluated[obj].leaflight))
    moved = _show(scene, {obj: e.leaflight.isovalue for obj, e in evaluated.items()}, moving)
    for obj in found:
        surface_material.show_opacity(obj, evaluated[obj].leaflight_look.opacity)
        look = display.volume_object(evaluated[obj]).leaflight_look
        surface_object.explode(obj, look.explode_distance)
    return moved


def _choose_frame(obj, scene):
    """Gives an object the frame of its keyframes, because its values may color another volume.

    A render does not evaluate hidden objects.
    """
    frame = versions.keyed_value(obj, FRAME_PATH, scene.frame_current)
    if frame is not None:
        obj.leaflight["shown_frame"] = int(frame)


def update_before_evaluation(scene, moving=False):
    """Shows isovalues that are not animated, before the depsgraph evaluates their old surfaces.

    Returns the objects whose isovalue has changed. It is cheap if none has.
    """
    if not any_is_behind():
        return []
    found = [obj for obj in isosurfaces(scene) if obj.mode == "OBJECT"]
    values = {obj: obj.leaflight.isovalue for obj in found if not _is_animated(obj)}
    return _show(scene, values, moving)


def any_is_behind(depsgraph=None):
    """True if a known isosurface does not yet show its isovalue or frame.

    depsgraph: the one that has evaluated it, because drivers cause no updates, or None.
    """
    for obj in filter(display.is_isosurface, known()):
        evaluated = obj if depsgraph is None else obj.evaluated_get(depsgraph)
        if surface_object.shown_isovalue(obj) != evaluated.leaflight.isovalue:
            return True
        if depsgraph is not None and frame_bakes.is_behind(obj, evaluated):
            return True
    return False


def known():
    """Returns the known isosurfaces that still exist, including those whose volume is gone."""
    return [o for o in display.noted() if o.leaflight.is_volume or display.is_added(o)]


def _show(scene, values, moving):
    """Shows isosurfaces at their values, and linked volumes at the isovalue of the one that moved.

    Returns the objects that have moved.
    """
    moved = [obj for obj in values if surface_object.shown_isovalue(obj) != values[obj]]
    leader = min(filter(_linked, moved), key=_precedence, default=None)
    for obj, isovalue in values.items():
        follows = leader not in (None, obj) and _linked(obj) and not _is_animated(obj)
        if follows:
            _follow(obj, leader, values[leader], moving)
        else:
            surface_object.update(obj, isovalue, moving)
    if values:
        walls.update(scene)
    return moved


def lock_interface(scene):
    """Locks the interface during renders: the viewport must not draw surfaces that change."""
    scene.render.use_lock_interface = True


def _linked(obj):
    settings = obj.leaflight
    return settings.is_volume and settings.linked and not obj.hide_render and obj.library is None


def _precedence(obj):
    """Returns the sort key of leaders: animated volumes first, then selected ones."""
    return (not _is_animated(obj), not obj.select_get(), obj.name)


def _is_animated(obj):
    return versions.is_animated(obj, ISOVALUE_PATH)


def _follow(obj, leader, isovalue, moving=False):
    target = isovalue_at(obj.leaflight, common_isovalue(leader.leaflight, isovalue))
    if obj.leaflight["isovalue"] != target:
        obj.leaflight["isovalue"] = target
        obj.update_tag()
    surface_object.update(obj, target, moving)


def complete_duplicates():
    """Gives all duplicates of volumes their added isosurfaces and a unique mark."""
    alike = {}
    for obj in bpy.data.objects:
        if display.mark_of(obj) is not None:
            alike.setdefault(display.mark_of(obj), []).append(obj)
    for volumes in alike.values():
        if len(volumes) > 1:
            _separate(volumes)


def _separate(volumes):
    """Gives new marks to volumes with one mark, except the first with added isosurfaces."""
    having = [volume for volume in volumes if display.added_to(volume)]
    if not having:
        return
    for volume in volumes:
        if volume == having[0] or volume.library is not None or volume.override_library is not None:
            continue
        if volume not in having:
            for source in display.added_to(_original(volume, having)):
                _copy_isosurface(source, volume)
        display.mark_anew(volume)


def _original(volume, having):
    """Returns the original of a duplicate, from its own scene if possible.

    A copy of the whole scene has isosurfaces, too.
    """
    scenes = set(volume.users_scene)
    return next((other for other in having if scenes & set(other.users_scene)), having[0])


def _copy_isosurface(source, volume):
    """Copies an added isosurface, with its animation, to another volume."""
    obj = source.copy()
    obj.name = display.name_for(volume)
    obj.data = source.data.copy()
    if source.animation_data is not None and source.animation_data.action is not None:
        obj.animation_data.action = source.animation_data.action.copy()
    obj.parent = volume
    display.link_beside(obj, volume)
    # Replace the source's material by a separate one.
    surface_object.shade(obj)
