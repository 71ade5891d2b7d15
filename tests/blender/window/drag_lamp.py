# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python drag_lamp.py -- VOLUME FOLDER: drags the key light of
the Studio over a baked volume with the mouse, with Live on, stops the light by Esc, moves it again.

Pictures of the viewport go into the folder. Prints a line WINDOW and a JSON object: seconds from
moves to light.
"""

import os
import sys
import time
from pathlib import Path

import bpy
import numpy as np
from leaflight import blender
from leaflight.io.images import write_png
from leaflight_addon.bake import live
from leaflight_addon.operators import background
from leaflight_addon.show import display, preview, surface_object

sys.path.insert(0, os.path.dirname(__file__))
import stepwise  # noqa: E402

VOLUME, FOLDER = sys.argv[-2], Path(sys.argv[-1])
# Steps of the mouse in a drag, of so many pixels, that many times a second.
STEPS, PIXELS, PER_SECOND = 40, 10, 10

found = {}


def main():
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.ui_scale = 1.0
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    obj = blender.import_volume(VOLUME)
    blender.stage(obj)
    obj.leaflight.quality = "DRAFT"
    obj.leaflight.bake_folder = str(FOLDER / "bakes")
    stepwise.run(drive(), found)


def window():
    return bpy.context.window_manager.windows[0]


def area():
    return next(area for area in window().screen.areas if area.type == "VIEW_3D")


def region():
    return next(region for region in area().regions if region.type == "WINDOW")


def volume():
    return next(obj for obj in bpy.data.objects if obj.leaflight.is_volume)


def key_light():
    return max(
        (obj for obj in bpy.data.objects if obj.type == "LIGHT"), key=lambda o: o.data.energy
    )


def label():
    return surface_object.label_of(volume().data)


def label_of_walls():
    return {
        o.data.get("leaflight_shown") for o in bpy.data.objects if display.is_display(o, "wall")
    }


def is_moved():
    return " moved " in label()


def event(kind, value, x, y):
    window().event_simulate(type=kind, value=value, x=int(x), y=int(y))


def press(key, x, y):
    event(key, "PRESS", x, y)
    event(key, "RELEASE", x, y)


def drive():
    area().spaces.active.show_region_ui = False
    yield from stepwise.wait(2.0)
    start = time.perf_counter()
    with bpy.context.temp_override(window=window(), area=area(), region=region()):
        bpy.ops.leaflight.bake("INVOKE_DEFAULT")
    yield from stepwise.until(lambda: background.running() is None)
    found["bake"] = time.perf_counter() - start
    found["triangles"] = len(volume().data.polygons)
    found["points"] = len(volume_bake().grid.direct.light_points)
    yield from picture("baked")
    bpy.context.scene.leaflight_live = True
    yield from stepwise.until(at_rest)
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    key_light().select_set(True)
    bpy.context.view_layer.objects.active = key_light()
    yield from drag()
    yield from stop()
    yield from move_and_wait()


def volume_bake():
    from leaflight_addon.store import cache

    return cache.bake_of(volume())


def at_rest():
    return live.at_work() is None and not live._has_changed


def drag():
    """With G and the mouse; what is shown meanwhile."""
    x, y = region().x + 0.3 * region().width, region().y + 0.6 * region().height
    labels, times, before = set(), [], label()
    place = tuple(key_light().location)
    event("MOUSEMOVE", "NOTHING", x, y)
    yield 0.2
    press("G", x, y)
    yield 0.2
    start = time.perf_counter()
    for step in range(STEPS):
        event("MOUSEMOVE", "NOTHING", x + PIXELS * (step + 1), y)
        yield 1.0 / PER_SECOND
        if label() != before:
            before = label()
            labels.add(before)
            times.append(time.perf_counter() - start)
        if step == STEPS // 2:
            yield from picture("dragged")
    # Nothing else moves: the pictures of this place.
    yield from stepwise.until(lambda: live._job is not None and not live._job.is_outdated)
    yield from stepwise.until(lambda: live._job is None or live._job._can_be_cancelled)
    press("LEFTMOUSE", x + PIXELS * STEPS, y)
    yield from stepwise.wait(1.0)
    found["drag"] = {
        "moved": float(np.linalg.norm(np.subtract(tuple(key_light().location), place))),
        "shown": len(labels),
        "times": times,
        "all direct": all(" moved " in one for one in labels),
    }
    yield from picture("direct")


def stop():
    """Esc, while the passes are under way; nothing begins again by itself."""
    x, y = region().x + 0.5 * region().width, region().y + 0.5 * region().height
    yield from stepwise.until(lambda: live.at_work() is not None or at_rest())
    event("MOUSEMOVE", "NOTHING", x, y)
    yield 0.2
    at_work = live.at_work() is not None
    press("ESC", x, y)
    start = time.perf_counter()
    yield from stepwise.until(lambda: live.at_work() is None)
    found["stopped"] = {"was at work": at_work, "after": time.perf_counter() - start}
    found["stopped"]["sentence"] = live.sentence()
    yield from stepwise.wait(1.0)
    found["stopped"]["stays"] = live.at_work() is None


def move_and_wait():
    """One step of the lamp, and the seconds until its light."""
    before, walls = label(), label_of_walls()
    key_light().location.x -= 0.3 * abs(key_light().location.x) + 0.1
    start = time.perf_counter()
    seconds = found["seconds"] = {}
    bpy.context.view_layer.update()
    while True:
        yield 0.01
        now = time.perf_counter() - start
        if "direct" not in seconds and label() != before and is_moved():
            seconds["direct"] = now
        if "sharp" not in seconds and label() != before and live._job and live._job.round:
            if live._job._can_be_cancelled:
                seconds["sharp"] = now
        if "walls" not in seconds and label_of_walls() != walls:
            seconds["walls"] = now
        if "pass" not in seconds and preview.of(volume()) and not is_moved():
            seconds["pass"] = now
        if at_rest():
            break
    seconds["final"] = time.perf_counter() - start
    found["final"] = not is_moved() and " round " not in label()
    yield from picture("final")


def picture(name):
    yield from stepwise.wait(0.5)
    seen = {}
    yield from stepwise.pixels_of(area(), seen)
    pixels = np.clip(seen["pixels"][::-1, :, :3], 0, 1)
    write_png(FOLDER / f"live_{name}.png", np.uint8(np.round(255 * pixels)))


main()
