# SPDX-License-Identifier: GPL-3.0-or-later
"""How strong the lamps of the scene are now, for what is shown by bakes of it."""

import bpy
from leaflight import LeaflightError

from ..show import lamps
from . import lights, scene_export


def follow(scene, depsgraph):
    """Looks at the lamps as they were evaluated; returns whether a bake is to be shown anew."""
    lit = [obj for obj in scene.objects if obj.leaflight.is_volume and obj.leaflight.bake_lamps]
    if not lit:
        return False
    try:
        present = [light for light in _present(depsgraph) if light is not None]
    except LeaflightError:
        # Of a kind that cannot be baked; the panel says why.
        present = None
    if present is None:
        return False
    # A volume that came into a scene without any lamp is shown as it was baked.
    has_lamps = any(obj.type == "LIGHT" for obj in scene.objects)
    found = [lamps.follow(obj.leaflight, present if has_lamps else None) for obj in lit]
    return any(found)


def concern(changed):
    """Whether a data-block that was changed may be, or may hide, a lamp."""
    if isinstance(changed, bpy.types.Object):
        return changed.type == "LIGHT"
    kinds = (bpy.types.Light, bpy.types.ShaderNodeTree, bpy.types.Collection, bpy.types.Scene)
    return isinstance(changed, kinds)


def _present(depsgraph):
    for obj, matrix in scene_export.rendered_objects(depsgraph.view_layer, depsgraph):
        if obj.type == "LIGHT":
            yield lights.export_light(obj, matrix, lambda: [], [])
