# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that a stage hides from the viewport and from renders until they are shown again."""

import bpy
import numpy as np

from .. import versions
from ..operators import checks
from ..show import display
from ..translations import iface_

_HIDDEN = "leaflight_hidden_by_stage"


def would_render(scene, kept):
    """Returns the objects of a scene that a bake would see, except volumes and those in `kept`."""
    return [
        obj
        for obj in scene.objects
        if obj not in kept
        and obj.library is None
        and obj.type not in versions.UNSEEN_TYPES
        and not (obj.hide_render or obj.leaflight.is_volume or display.is_display(obj))
    ]


def hide(scene, objects):
    for obj in objects:
        display.hide(scene, obj, _HIDDEN)


def show(scene, objects):
    for obj in objects:
        display.show(scene, obj, _HIDDEN)


def all_hidden(scene):
    return [obj for obj in scene.objects if _HIDDEN in obj]


def names(objects):
    """Returns up to three names and the number of the others, for sentences."""
    text = ", ".join(obj.name for obj in objects[:3])
    more = len(objects) - 3
    return iface_("%s and %d more") % (text, more) if more > 0 else text


class LEAFLIGHT_OT_show_hidden(checks.LeaflightOperator, bpy.types.Operator):
    bl_label = "Show Hidden"
    bl_description = "Show and render the objects that Stage has hidden. Bakes then include them"
    conditions = (
        checks.needs(lambda context: all_hidden(context.scene), "Stage has not hidden any object"),
        checks.in_object_mode,
    )

    def run(self, context):
        objects = all_hidden(context.scene)
        show(context.scene, objects)
        self.report({"INFO"}, f"Shown again: {names(objects)}")


# Locations of the default cube and light of Blender, the cube's side and the light's power.
_CUBE, _LAMP = (0.0, 0.0, 0.0), (4.0762, 1.0055, 5.9039)
_SIDE, _POWER = 2.0, 1000.0


def is_first_scene(scene):
    """True if a scene has the default cube and, beside volumes, at most the default light."""
    objects = would_render(scene, ())
    return any(map(_is_cube, objects)) and all(_is_cube(o) or _is_lamp(o) for o in objects)


def _is_cube(obj):
    if obj.type != "MESH" or len(obj.data.vertices) != 8 or obj.modifiers:
        return False
    return _stands_at(obj, _CUBE) and np.allclose(obj.dimensions, _SIDE)


def _is_lamp(obj):
    if obj.type != "LIGHT" or obj.data.type != "POINT":
        return False
    return _stands_at(obj, _LAMP) and obj.data.energy == _POWER


def _stands_at(obj, place):
    return np.allclose(obj.matrix_world.translation, place, atol=1e-3)
