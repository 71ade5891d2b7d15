# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows each volume at its isovalue; those of several volumes belong together.

A volume shows the isovalue low + c (high - low) of its range at the common isovalue c. A volume
that is linked follows the one whose isovalue was moved, unless it is animated itself. A move is
noticed by the isovalue that the mesh still shows: undo and loading a file bring back both together.

A duplicate of a volume gets copies of the isosurfaces that were added to it: these cannot be
selected, so that Blender leaves them out. A volume that has some bears a mark of its own, and a
duplicate is known by bearing the mark of another.
"""

import bpy

from .. import versions
from ..store import cache, frame_bakes
from . import display, surface_material, surface_object, walls

# Drivers and keyframes use this path, seen from the object.
ISOVALUE_PATH = 'leaflight["isovalue"]'
FRAME_PATH = "leaflight.shown_frame"


def isovalue_range(settings):
    """Isovalues (low, high) of the common isovalues 0 and 1: those of the bake if there is one."""
    if settings.bake_id:
        return settings.bake_low, settings.bake_high
    return settings.low, settings.high


def common_isovalue(settings, isovalue):
    """c, within 0..1 inside the isovalue range; 0 where the isovalue range is empty."""
    low, high = isovalue_range(settings)
    return (isovalue - low) / (high - low) if high > low else 0.0


def isovalue_at(settings, c):
    low, high = isovalue_range(settings)
    return low + c * (high - low)


def volumes(scene):
    return [obj for obj in isosurfaces(scene) if obj.leaflight.is_volume]


def isosurfaces(scene):
    """The volumes of a scene, and the isosurfaces that were added to them."""
    found = [obj for obj in scene.objects if display.is_isosurface(obj)]
    display.note(found)
    return found


def limit(obj):
    """Limits the slider of an isosurface to the data, and softly to the range of its volume."""
    volume = display.volume_object(obj)
    data_range = cache.volume_of(volume).data_range()
    obj.leaflight.limit_isovalue(
        data_range, isovalue_range(volume.leaflight), obj.leaflight.isovalue
    )


def left_alone():
    """What was added to volumes that are gone."""
    return [obj for obj in display.noted() if display.is_display(obj) and obj.parent is None]


def remove_left_alone():
    for obj in left_alone():
        display.remove(obj)


def partners(obj, scene):
    """The other volumes of the scene that move with this one."""
    if not _linked(obj):
        return []
    return [other for other in volumes(scene) if other != obj and _linked(other)]


def set_isovalue(obj, isovalue):
    """Shows an isovalue that a script has set, and moves what is linked to it."""
    surface_object.update(obj, isovalue)
    for scene in obj.users_scene:
        for other in partners(obj, scene):
            if not _is_animated(other):
                _follow(other, obj, isovalue)
        walls.update(scene)


def show_frame(obj):
    """Shows the frame of a file that a script or the slider has set."""
    if frame_bakes.switch(obj, frame_bakes.wanted(obj.leaflight)):
        surface_object.update_all(obj)
        for scene in obj.users_scene:
            walls.update(scene)


def update(scene, depsgraph, moving=False):
    """Shows every isosurface of the scene at its evaluated isovalue, or where a linked one leads.

    Only the evaluated object has the animated value: in a render the original lags behind.
    moving: see surface_object.update(). Returns the objects whose isovalue was another before.
    """
    found = [obj for obj in isosurfaces(scene) if obj.mode == "OBJECT"]
    evaluated = {obj: obj.evaluated_get(depsgraph) for obj in found}
    for obj in found:
        if frame_bakes.is_behind(obj, evaluated[obj]):
            frame_bakes.switch(obj, frame_bakes.wanted(evaluated[obj].leaflight))
    moved = _show(scene, {obj: e.leaflight.isovalue for obj, e in evaluated.items()}, moving)
    for obj in found:
        surface_material.show_opacity(obj, evaluated[obj].leaflight_look.opacity)
    return moved


def update_before_evaluation(scene, moving=False):
    """The same for isovalues that are not animated, which the objects themselves have already.

    It spares the evaluation of the surfaces that go. Next to nothing where none has moved.
    """
    if not any_is_behind():
        return []
    found = [obj for obj in isosurfaces(scene) if obj.mode == "OBJECT"]
    values = {obj: obj.leaflight.isovalue for obj in found if not _is_animated(obj)}
    return _show(scene, values, moving)


def any_is_behind(depsgraph=None):
    """Whether an isosurface that was seen before shows another isovalue than it has, or is to have.

    depsgraph: that has evaluated it; a driver's work is not among its updates.
    """
    for obj in filter(display.is_isosurface, known()):
        evaluated = obj if depsgraph is None else obj.evaluated_get(depsgraph)
        if surface_object.shown_isovalue(obj) != evaluated.leaflight.isovalue:
            return True
        if depsgraph is not None and frame_bakes.is_behind(obj, evaluated):
            return True
    return False


def known():
    """What was seen last and is still there: isosurfaces, and some left alone by their volume."""
    return [o for o in display.noted() if o.leaflight.is_volume or display.is_added(o)]


def _show(scene, values, moving):
    """Shows the volumes at their values, or where the one leads that was moved; what moved."""
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
    """Surfaces change while an animation renders, and the viewport must not draw them then."""
    scene.render.use_lock_interface = True


def _linked(obj):
    settings = obj.leaflight
    return settings.is_volume and settings.linked and not obj.hide_render and obj.library is None


def _precedence(obj):
    """Of several that moved at once an animated one leads, then one that is selected."""
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
    """Gives the isosurfaces to duplicates that are without, and marks of their own to all."""
    alike = {}
    for obj in bpy.data.objects:
        if display.mark_of(obj) is not None:
            alike.setdefault(display.mark_of(obj), []).append(obj)
    for volumes in alike.values():
        if len(volumes) > 1:
            _separate(volumes)


def _separate(volumes):
    """Volumes that bear one mark: the first that has isosurfaces keeps it."""
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
    """Of what a volume may be a duplicate of; a copy of the whole scene has isosurfaces, too."""
    scenes = set(volume.users_scene)
    return next((other for other in having if scenes & set(other.users_scene)), having[0])


def _copy_isosurface(source, volume):
    """An isosurface of a volume that shows what another volume's does, animation included."""
    obj = source.copy()
    obj.name = display.name_for(volume)
    obj.data = source.data.copy()
    if source.animation_data is not None and source.animation_data.action is not None:
        obj.animation_data.action = source.animation_data.action.copy()
    obj.parent = volume
    display.link_beside(obj, volume)
    # It takes a material of its own in place of the source's.
    surface_object.shade(obj)
