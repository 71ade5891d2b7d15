# SPDX-License-Identifier: GPL-3.0-or-later
"""A duplicate of a volume gets copies of the isosurfaces that were added to it.

These cannot be selected, so that Blender leaves them out. A volume that has some bears a mark of
its own, and a duplicate is known by bearing the mark of another.
"""

import bpy

from . import added, surface_object


def complete():
    """Gives the isosurfaces to duplicates that are without, and marks of their own to all."""
    alike = {}
    for obj in bpy.data.objects:
        if added.mark_of(obj) is not None:
            alike.setdefault(added.mark_of(obj), []).append(obj)
    for volumes in alike.values():
        if len(volumes) > 1:
            _separate(volumes)


def _separate(volumes):
    """Volumes that bear one mark: the first that has isosurfaces keeps it."""
    having = [volume for volume in volumes if added.added_to(volume)]
    if not having:
        return
    for volume in volumes:
        if volume == having[0] or volume.library is not None or volume.override_library is not None:
            continue
        if volume not in having:
            for source in added.added_to(_original(volume, having)):
                _copy(source, volume)
        added.mark_anew(volume)


def _original(volume, having):
    """Of what a volume may be a duplicate of; a copy of the whole scene has isosurfaces, too."""
    scenes = set(volume.users_scene)
    return next((other for other in having if scenes & set(other.users_scene)), having[0])


def _copy(source, volume):
    """An isosurface of a volume that shows what another volume's does, animation included."""
    obj = source.copy()
    obj.name = added.name_for(volume)
    obj.data = source.data.copy()
    if source.animation_data is not None and source.animation_data.action is not None:
        obj.animation_data.action = source.animation_data.action.copy()
    obj.parent = volume
    added.link_beside(obj, volume)
    # It takes a material of its own in place of the source's.
    surface_object.shade(obj)
