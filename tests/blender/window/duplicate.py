# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python duplicate.py -- VOLUME.npy: duplicates a volume with an
added isosurface by Shift+D, and undoes and redoes it.

Prints a line WINDOW and a JSON object of the state after each step.
"""

import sys

import bpy
import hand
import stepwise
from leaflight import blender
from leaflight_addon.show import display, surface_object


found = {}


def main():
    hand.clear_scene()
    stepwise.run(steps(), found)


def steps():
    # Act in the window, so that there is an undo step.
    with hand.in_view():
        bpy.ops.leaflight.import_volume(filepath=sys.argv[-1])
        obj = bpy.context.object
        obj.leaflight.linked = False
        blender.add_isosurface(obj, 70.0, opacity=0.5)
        bpy.ops.ed.undo_push(message="Isosurfaces")
    yield from stepwise.wait(1.0)
    hand.event("D", "PRESS", shift=True)
    hand.event("D", "RELEASE", shift=True)
    yield from stepwise.until(lambda: len(volumes()) == 2)
    for step in range(1, 8):
        hand.event("MOUSEMOVE", "NOTHING", x=0.5 + 0.02 * step)
        yield 0.1
    hand.event("LEFTMOUSE", "PRESS", x=0.64)
    hand.event("LEFTMOUSE", "RELEASE", x=0.64)
    yield from stepwise.wait(1.0)
    copy = bpy.context.view_layer.objects.active
    found["moved"] = copy.location.length > 0.1
    found["duplicated"] = state()
    # Move the slider of the panel.
    (own,) = display.added_to(copy)
    own.leaflight.isovalue = 80.0
    with hand.in_view():
        bpy.ops.ed.undo_push(message="Isovalue")
    yield from stepwise.wait(0.5)
    found["edited"] = state()
    for name, shift in (("undone", False), ("undone twice", False), ("redone", True)):
        before = state()
        hand.event("Z", "PRESS", ctrl=True, shift=shift)
        hand.event("Z", "RELEASE", ctrl=True, shift=shift)
        yield from stepwise.until(lambda: state() != before)
        yield from stepwise.wait(1.0)
        found[name] = state()


def state():
    """Returns, for each volume, isovalue and opacity of its added isosurfaces."""
    return [
        [
            [round(surface_object.shown_isovalue(obj), 3), round(obj.leaflight_look.opacity, 3)]
            for obj in display.added_to(volume)
        ]
        for volume in volumes()
    ]


def volumes():
    found = (obj for obj in bpy.context.scene.objects if obj.leaflight.is_volume)
    return sorted(found, key=lambda obj: obj.name)


main()
