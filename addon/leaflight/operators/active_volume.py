# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume that panels and operators work on, whatever else is selected."""

import bpy


def active_volume(context: bpy.types.Context) -> bpy.types.Object | None:
    """The active object if it is a volume, else the scene's volume that was active last, or None.

    None, too, while the graph of an image is active, which has a panel of its own.
    """
    obj, scene = context.object, context.scene
    if obj is not None and obj.leaflight.is_volume:
        return obj
    if obj is not None and obj.leaflight_flat.is_flatland:
        return None
    last = scene.objects.get(scene.leaflight.active_volume)
    if last is not None and last.leaflight.is_volume:
        return last
    return next((one for one in scene.objects if one.leaflight.is_volume), None)


def remember(scene: bpy.types.Scene, obj: bpy.types.Object | None) -> None:
    """Notes the active object of a scene where it is a volume."""
    if obj is None or not obj.leaflight.is_volume or scene.library is not None:
        return
    # By its name: a pointer would keep the volume in the file after its deletion.
    if scene.leaflight.active_volume != obj.name:
        scene.leaflight.active_volume = obj.name
