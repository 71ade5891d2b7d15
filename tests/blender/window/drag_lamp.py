# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python drag_lamp.py -- VOLUME FOLDER: drags the key light of
Studio over a baked volume with the mouse, with Live on.

Then stops the light by Esc and moves the lamp again. Writes pictures of the viewport to the folder.
Prints a line WINDOW and a JSON object: seconds from moves to light.
"""

import json
import sys
import time
from pathlib import Path

import bpy
import hand
import numpy as np
import seen
import stepwise
from leaflight import blender
from leaflight.io.images import write_png
from leaflight_addon.bake import live
from leaflight_addon.operators import jobs
from leaflight_addon.show import display, surface_object
from leaflight_addon.store import cache

VOLUME, FOLDER = sys.argv[-2], Path(sys.argv[-1])
# Mouse steps in a drag, pixels per step, and steps per second.
STEPS, PIXELS, PER_SECOND = 40, 10, 10

found, pictures = {"seconds": {}}, []


def main():
    hand.clear_scene()
    obj = blender.import_volume(VOLUME)
    blender.stage(obj)
    obj.leaflight.quality = "DRAFT"
    obj.leaflight.bake_folder = str(FOLDER / "bakes")
    stepwise.run(drive(), found)


def key_light():
    return max(
        (obj for obj in bpy.data.objects if obj.type == "LIGHT"), key=lambda o: o.data.energy
    )


def label():
    return surface_object.label_of(hand.volume().data)


def label_of_walls():
    return {
        o.data.get("leaflight_shown") for o in bpy.data.objects if display.is_display(o, "wall")
    }


def is_moved():
    return bool(json.loads(label())["moved"])


def drive():
    view = hand.view().spaces.active
    view.show_region_ui = False
    # Without a graphics card, other shading takes seconds for each picture.
    view.shading.type, view.shading.light, view.shading.color_type = "SOLID", "FLAT", "VERTEX"
    view.overlay.show_overlays = False
    view.region_3d.view_perspective = "CAMERA"
    yield from stepwise.wait(2.0)
    start = time.perf_counter()
    hand.press(bpy.ops.leaflight.bake)
    yield from stepwise.until(lambda: jobs.running() is None)
    found["bake"] = time.perf_counter() - start
    found["triangles"] = len(hand.volume().data.polygons)
    found["points"] = len(cache.bake_of(hand.volume()).grid.direct.light_points)
    # Make isosurfaces of small volumes coarse, too, while the lamp moves. The light adds triangles
    # to their nodes.
    live._QUICK_MAPS = 0
    limit = min(surface_object.MOVING_TRIANGLES, found["triangles"] // 8)
    surface_object.MOVING_TRIANGLES = limit
    yield from picture("baked")
    bpy.context.scene.leaflight_live = True
    yield from stepwise.until(seen.at_rest)
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    key_light().select_set(True)
    bpy.context.view_layer.objects.active = key_light()
    yield from drag()
    yield from stop()
    yield from move_and_wait()


def drag():
    """Drags the light with G and the mouse, and records the display meanwhile."""
    x, y = hand.region().x + 0.3 * hand.region().width, hand.region().y + 0.6 * hand.region().height
    labels, times, before, triangles = set(), [], label(), found["triangles"]
    place = tuple(key_light().location)
    hand.event_at("MOUSEMOVE", "NOTHING", x, y)
    yield 0.2
    hand.tap("G", x, y)
    yield 0.2
    start = time.perf_counter()
    for step in range(STEPS):
        hand.event_at("MOUSEMOVE", "NOTHING", x + PIXELS * (step + 1), y)
        yield 1.0 / PER_SECOND
        if label() != before:
            before = label()
            labels.add(before)
            times.append(time.perf_counter() - start)
            triangles = min(triangles, len(hand.volume().data.polygons))
        if step == STEPS // 2:
            yield from picture("dragged")
    # Nothing else moves, so take the pictures of this position.
    yield from stepwise.until(lambda: live._job is not None and not live._job.is_outdated)
    yield from stepwise.until(lambda: live._job is None or live._job._can_be_cancelled)
    hand.tap("LEFTMOUSE", x + PIXELS * STEPS, y)
    yield from stepwise.wait(1.0)
    found["drag"] = {
        "moved": float(np.linalg.norm(np.subtract(tuple(key_light().location), place))),
        "shown": len(labels),
        "times": times,
        "triangles": triangles,
        "direct": sum(bool(json.loads(one)["moved"]) for one in labels),
    }
    yield from picture("direct")


def stop():
    """Presses Esc during the passes, and records whether Live stays idle."""
    x, y = hand.region().x + 0.5 * hand.region().width, hand.region().y + 0.5 * hand.region().height
    yield from stepwise.until(lambda: live.at_work() is not None or seen.at_rest())
    hand.event_at("MOUSEMOVE", "NOTHING", x, y)
    yield 0.2
    at_work = live.at_work() is not None
    hand.tap("ESC", x, y)
    start = time.perf_counter()
    yield from stepwise.until(lambda: live.at_work() is None)
    found["stopped"] = {"was at work": at_work, "after": time.perf_counter() - start}
    found["stopped"]["sentence"] = live.sentence()
    yield from stepwise.wait(1.0)
    found["stopped"]["stays"] = live.at_work() is None


def move_and_wait():
    """Moves the lamp one step and records the seconds until its light."""
    seconds, before, walls = found["seconds"], label(), label_of_walls()
    key_light().location.x -= 0.3 * abs(key_light().location.x) + 0.1
    start, processor = time.perf_counter(), time.process_time()
    bpy.context.view_layer.update()
    shown = []
    while not seen.at_rest() or not shown:
        yield 0.01
        now = time.perf_counter() - start
        if label() != before:
            before = label()
            shown.append((now, is_moved()))
            seconds.setdefault("processor until direct", time.process_time() - processor)
        if "walls" not in seconds and label_of_walls() != walls:
            seconds["walls"] = now
    direct = [when for when, of_moved in shown if of_moved]
    seconds["direct"], seconds["sharp"] = direct[0], direct[-1]
    seconds["final"] = shown[-1][0]
    yield from stepwise.until(lambda: not surface_object.is_coarse(hand.volume().data))
    found["final triangles"] = len(hand.volume().data.polygons)
    found["final"] = not is_moved() and '"pass ' not in label()
    yield from picture("final")
    write_all()


def picture(name):
    """Takes a picture in Stage's shading, which needs seconds without a graphics card."""
    shading, drawn = hand.view().spaces.active.shading, []
    shading.type = "MATERIAL"
    handle = bpy.types.SpaceView3D.draw_handler_add(
        lambda: drawn.append(1), (), "WINDOW", "POST_PIXEL"
    )
    while len(drawn) < 4:
        hand.region().tag_redraw()
        yield 0.3
    bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
    pictures.append(str(FOLDER / f"live_{name}.png"))
    with bpy.context.temp_override(window=hand.window(), area=hand.view()):
        bpy.ops.screen.screenshot_area(filepath=pictures[-1])
    shading.type = "SOLID"


def pixels(path):
    """Returns the 8-bit RGB pixels of a picture, bottom row first."""
    image = bpy.data.images.load(path)
    width, height = image.size
    read = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(read)
    return np.uint8(np.round(255 * read.reshape(height, width, 4)[..., :3]))


def write_all():
    """Writes the pictures in two rows of two, in the order in which they were taken."""
    first, second, third, fourth = map(pixels, pictures)
    rows = np.vstack([np.hstack([third, fourth]), np.hstack([first, second])])
    write_png(FOLDER / "live.png", np.ascontiguousarray(rows[::-1]))


main()
