# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows each volume at its isovalue; those of several volumes belong together.

A volume shows the isovalue low + c (high - low) of its window at the leaf coordinate c. A volume
that is linked follows the one whose isovalue was moved, unless it is animated itself. A move is
noticed by the isovalue that the mesh still shows: undo and loading a file bring back both together.
"""

from .. import versions
from . import surface_object, walls

# Drivers and keyframes use this path, seen from the object.
ISOVALUE_PATH = 'leaflight["isovalue"]'


def window(settings):
    """Isovalues (low, high) of the leaf coordinates 0 and 1: those of the bake if there is one."""
    if settings.bake_id:
        return settings.bake_low, settings.bake_high
    return settings.low, settings.high


def leaf_coordinate(settings, isovalue):
    """c, within 0..1 inside the window; 0 where the window is empty."""
    low, high = window(settings)
    return (isovalue - low) / (high - low) if high > low else 0.0


def isovalue_at(settings, c):
    low, high = window(settings)
    return low + c * (high - low)


def volumes(scene):
    return [obj for obj in scene.objects if obj.leaflight.is_volume]


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


def update(scene, depsgraph):
    """Shows every volume of the scene at its evaluated isovalue, or where a linked one leads it.

    Only the evaluated object has the animated value: in a render the original lags behind.
    """
    found = [obj for obj in volumes(scene) if obj.mode == "OBJECT"]
    values = {obj: obj.evaluated_get(depsgraph).leaflight.isovalue for obj in found}
    moved = [obj for obj in found if surface_object.shown_isovalue(obj) != values[obj]]
    leader = min(filter(_linked, moved), key=_precedence, default=None)
    for obj, isovalue in values.items():
        follows = leader not in (None, obj) and _linked(obj) and not _is_animated(obj)
        if follows:
            _follow(obj, leader, values[leader])
        else:
            surface_object.update(obj, isovalue)
    if found:
        walls.update(scene)


def lock_interface(scene):
    """Surfaces change while an animation renders, and the viewport must not draw them then."""
    scene.render.use_lock_interface = True


def _linked(obj):
    return obj.leaflight.linked and not obj.hide_render and obj.library is None


def _precedence(obj):
    """Of several that moved at once an animated one leads, then one that is selected."""
    return (not _is_animated(obj), not obj.select_get(), obj.name)


def _is_animated(obj):
    data = obj.animation_data
    curves = [*(data.drivers if data else ()), *versions.fcurves(obj)]
    return any(curve.data_path == ISOVALUE_PATH for curve in curves)


def _follow(obj, leader, isovalue):
    target = isovalue_at(obj.leaflight, leaf_coordinate(leader.leaflight, isovalue))
    if obj.leaflight["isovalue"] != target:
        obj.leaflight["isovalue"] = target
        obj.update_tag()
    surface_object.update(obj, target)
