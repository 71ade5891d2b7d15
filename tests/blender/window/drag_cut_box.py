# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python drag_cut_box.py -- VOLUME FOLDER: cuts a baked volume by
its clip box, and drags the box with the mouse: first without Live, then with it.

Prints a line WINDOW and a JSON object, with the states that the viewport showed and the seconds
until the cut was lit.
"""

import sys
import time
from pathlib import Path

import bpy
import hand
import numpy as np
import seen
import stepwise
from leaflight import blender
from leaflight_addon.operators import jobs
from leaflight_addon.stage import staleness
from leaflight_addon.store import cache

VOLUME, FOLDER = sys.argv[-2], Path(sys.argv[-1])
# Mouse steps in a drag, pixels per step, and steps per second.
STEPS, PIXELS, PER_SECOND = 30, 6, 10

found = {"seconds": {}}


def main():
    hand.clear_scene()
    obj = blender.import_volume(VOLUME)
    blender.stage(obj)
    obj.leaflight.quality = "DRAFT"
    obj.leaflight.shading = "ATTRIBUTE"
    obj.leaflight.bake_folder = str(FOLDER / "bakes")
    stepwise.run(drive(), found)


def box():
    return hand.volume().leaflight_look.box


def light():
    """Returns the radiance of the vertices, averaged over the channels."""
    data = hand.volume().data.attributes["radiance"].data
    colors = np.empty(4 * len(data), np.float32)
    data.foreach_get("color", colors)
    return colors.reshape(-1, 4)[:, :3].mean(axis=1)


def drive():
    view = hand.view().spaces.active
    view.show_region_ui = False
    view.shading.type, view.shading.light, view.shading.color_type = "SOLID", "FLAT", "VERTEX"
    view.region_3d.view_perspective = "CAMERA"
    yield from stepwise.wait(2.0)
    hand.press(bpy.ops.leaflight.bake)
    yield from stepwise.until(lambda: jobs.running() is None)
    with hand.in_view():
        bpy.ops.leaflight.add_clip_box()
    hand.press(bpy.ops.leaflight.cut_data)
    yield from stepwise.until(lambda: jobs.running() is None and seen.cut_is_shown())
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    box().select_set(True)
    bpy.context.view_layer.objects.active = box()
    found["without live"] = yield from drag()
    found["darkest"] = float(light().min())
    found["change"] = staleness.change_since_bake(bpy.context, hand.volume()) == staleness.CUT
    yield from undo()
    bpy.context.scene.leaflight_live = True
    yield from stepwise.until(seen.at_rest)
    found["with live"] = yield from drag()
    yield from stepwise.until(seen.at_rest)
    yield from move_and_wait()


def drag():
    """Drags the box with G and the mouse. Returns the numbers of cuts and of states shown."""
    x, y = hand.region().x + 0.3 * hand.region().width, hand.region().y + 0.6 * hand.region().height
    place, cuts, moved = tuple(box().location), {seen.surface()["isosurface"]}, set()
    hand.event_at("MOUSEMOVE", "NOTHING", x, y)
    yield 0.2
    hand.tap("G", x, y)
    yield 0.2
    for step in range(STEPS):
        hand.event_at("MOUSEMOVE", "NOTHING", x + PIXELS * (step + 1), y)
        yield 1.0 / PER_SECOND
        cuts.add(seen.surface()["isosurface"])
        moved.add(seen.surface()["moved"])
    hand.tap("LEFTMOUSE", x + PIXELS * STEPS, y)
    yield from stepwise.until(seen.cut_is_shown)
    moved = len(moved - {""})
    length = float(np.linalg.norm(np.subtract(tuple(box().location), place)))
    return {"length": length, "cuts": len(cuts) - 1, "moved": moved}


def undo():
    """Undoes and redoes the drag, and records whether the cut comes along."""
    after = tuple(box().location)
    with hand.in_view():
        bpy.ops.ed.undo()
    yield from stepwise.until(seen.cut_is_shown)
    before = tuple(box().location)
    with hand.in_view():
        bpy.ops.ed.redo()
    yield from stepwise.until(seen.cut_is_shown)
    found["undone"] = before != after and np.allclose(tuple(box().location), after)


def move_and_wait():
    """Moves the box one step and records the seconds until its cut and its light."""
    seconds = found["seconds"]
    box().location.z += 0.1 * box().scale.z
    start = time.perf_counter()
    bpy.context.view_layer.update()
    while not seen.at_rest() or "final" not in seconds:
        yield 0.01
        now = time.perf_counter() - start
        if seen.cut_is_shown():
            seconds.setdefault("cut", now)
            if seen.surface()["moved"]:
                seconds.setdefault("direct", now)
        if not staleness.change_since_bake(bpy.context, hand.volume()) and seen.at_rest():
            seconds.setdefault("final", now)
    found["final"] = not seen.surface()["moved"] and seen.surface()["light"].startswith(
        cache.bake_of(hand.volume()).id
    )


main()
