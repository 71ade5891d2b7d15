# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python pick_isovalue.py -- VOLUME: drags the isovalue in the
histogram over the viewport, confirms it, drags it again and undoes that.

Prints a line WINDOW and a JSON object of the isovalues after each step.
"""

import sys

import bpy
import hand
import numpy as np
import stepwise
from leaflight_addon.edit import data_picture, pick_isovalue

found = {}


def event(kind, value, share, height=60):
    """Sends an event at a share of the viewport's width, at this many pixels above its bottom."""
    x = int(hand.region().x + share * hand.region().width)
    hand.window().event_simulate(type=kind, value=value, x=x, y=int(hand.region().y + height))


def press(key):
    event(key, "PRESS", 0.5)
    event(key, "RELEASE", 0.5)


def steps():
    hand.clear_scene()
    bpy.ops.leaflight.import_volume(filepath=sys.argv[-1])
    hand.view().spaces.active.show_region_ui = False
    # Show a gray viewport, so that the mark's color is unique.
    hand.volume().hide_set(False)
    found["imported"] = hand.volume().leaflight.isovalue
    hand.press(bpy.ops.leaflight.pick_isovalue)
    yield from stepwise.wait(1.0)
    found["drawn"] = yield from orange_pixels()
    for kept, last in (("kept", 0.6), ("taken back", 0.3)):
        event("MOUSEMOVE", "NOTHING", 0.5)
        yield from stepwise.wait(0.2)
        event("LEFTMOUSE", "PRESS", 0.5)
        yield from stepwise.wait(0.3)
        event("MOUSEMOVE", "NOTHING", last)
        yield from stepwise.wait(0.5)
        event("LEFTMOUSE", "RELEASE", last)
        yield from stepwise.wait(0.3)
        found[f"dragged, {kept}"] = hand.volume().leaflight.isovalue
        press("RET" if kept == "kept" else "ESC")
        yield from stepwise.wait(0.5)
        found[kept] = hand.volume().leaflight.isovalue
        found[f"left over, {kept}"] = len(pick_isovalue._drawn)
        if kept == "kept":
            hand.press(bpy.ops.leaflight.pick_isovalue)
            yield from stepwise.wait(0.5)
    found["gone"] = yield from orange_pixels()


def orange_pixels():
    """Returns the number of pixels in the mark's color, at the bottom of the viewport."""
    seen = {}
    yield from stepwise.pixels_of(hand.view(), seen)
    part = seen["pixels"][:220, :, :3]
    return int((np.abs(part - data_picture.ISOVALUE) < 0.06).all(axis=-1).sum())


stepwise.run(steps(), found)
