# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python drag_isovalue.py -- VOLUME.npy WINDOW_LOW WINDOW_HIGH:
drags the isovalue's slider back and forth with the mouse.

There are three drags: with full detail in every step, as Leaflight shows it, and during a bake.
Prints a line WINDOW and a JSON object: for each drag, the seconds between pictures of the viewport.
"""

import os
import sys
import time

import bpy
import hand
import leaflight
import mouse
import numpy as np
import stepwise
from leaflight_addon.operators import jobs
from leaflight_addon.show import surface_object

# Steps of the mouse per drag, pixels per step, and turns back and forth per drag.
STEPS, PIXELS, TURNS = 16, 4, 1

found = {}
pictures = []


def main():
    path, low, high = sys.argv[-3:]
    # Switch these off, because they take most of the time without a graphics card.
    bpy.context.preferences.system.viewport_aa = "OFF"
    show_leaflight_alone()
    import_volume(path, float(low), float(high))
    bpy.types.SpaceView3D.draw_handler_add(
        lambda: pictures.append(time.perf_counter()), (), "WINDOW", "POST_PIXEL"
    )
    stepwise.run(drive(), found)


def show_leaflight_alone():
    """Removes all other tabs of the sidebar, except Blender's innermost one."""
    for cls in list(bpy.types.Panel.__subclasses__()):
        place = [getattr(cls, name, None) for name in ("bl_space_type", "bl_region_type")]
        if place == ["VIEW_3D", "UI"] and getattr(cls, "bl_category", None) != "Leaflight":
            try:
                bpy.utils.unregister_class(cls)
            except RuntimeError:
                pass
    area = hand.view()
    area.spaces.active.show_region_ui = True
    area.spaces.active.shading.type = "SOLID"
    area.spaces.active.overlay.show_overlays = False


def import_volume(path, low, high):
    hand.clear_scene()
    values = np.load(path)
    raw = f"{path}.raw"
    values.tofile(raw)
    bpy.ops.leaflight.import_volume(
        filepath=raw, dims=values.shape[::-1], value_type=str(values.dtype), spacing=(1, 1, 1)
    )
    bpy.ops.leaflight.stage()
    draw_unlit()
    hand.view().spaces.active.region_3d.view_perspective = "CAMERA"
    settings = bpy.context.object.leaflight
    settings.light_walls = False
    settings.limit_isovalue((float(values.min()), float(values.max())), (low, high), low)
    settings.low, settings.high = low, high
    # Show few triangles until the slider is found.
    settings.isovalue = float(values.max()) - 1.0
    settings.bake_folder = os.path.dirname(path)
    # The bake must last for the whole drag.
    settings.resolution = 192
    settings.error = 0.01


def draw_unlit():
    """Without a graphics card, a lit viewport takes too much time beside the surface."""
    hand.view().spaces.active.shading.type = "SOLID"


def drive():
    window = bpy.context.window_manager.windows[0]
    yield from stepwise.wait(1.0)
    yield from choose_last_tab(window)
    region, obj = hand.region("UI"), bpy.context.object
    x, top = region.x + region.width // 3, region.y + region.height
    rows = range(top - 30, top - 160, -8)
    place = yield from mouse.find_slider(window, x, rows, lambda: obj.leaflight.isovalue)
    settings = bpy.context.object.leaflight
    settings.isovalue = 0.5 * (settings.low + settings.high)
    limit = surface_object.MOVING_TRIANGLES
    for name in ("whole", "coarse", "whole again", "coarse again"):
        surface_object.MOVING_TRIANGLES = limit if name.startswith("coarse") else 10**9
        yield from rest()
        yield from drag(window, place, name)
        yield from rest(name)
    bpy.context.window.cursor_warp(*place)
    yield from begin_bake(window)
    yield from bake_alone()
    jobs.running().cancel()
    yield from stepwise.until(lambda: jobs.running() is None)
    bpy.ops.leaflight.throw_bake_away()
    # Start another bake, because a fast machine may have nearly finished the first.
    yield from begin_bake(window)
    yield from drag(window, place, "baking")
    found["baking"]["bakes"] = jobs.running() is not None
    yield from rest("baking")


def choose_last_tab(window):
    """Clicks through the tabs of the sidebar; Blender's own is above ours."""
    region = hand.region("UI")
    x, top = region.x + region.width - 14, region.y + region.height
    for y in range(top - 20, top - 200, -12):
        yield from mouse.gesture(window, [(x, y)])


def drag(window, place, name):
    x, y = place
    out = [x + PIXELS * k for k in range(STEPS)]
    there_and_back = (out + out[::-1]) * TURNS
    obj = bpy.context.object
    pictures.clear()
    values, triangles, times = set(), [], []
    start, processor = time.perf_counter(), time.process_time()
    for pause in mouse.gesture(window, [(at, y) for at in there_and_back]):
        values.add(obj.leaflight.isovalue)
        triangles.append(len(obj.data.polygons))
        times.append(surface_object.is_coarse(obj.data))
        yield pause
    end = time.perf_counter()
    shown = [t for t in pictures if start <= t <= end]
    found[name] = {
        "gaps": [float(b - a) for a, b in zip(shown, shown[1:])],
        "seconds": end - start,
        "processor_seconds": time.process_time() - processor,
        "isovalues": len(values),
        "triangles": int(np.median(triangles)),
        "coarse": float(np.mean(times)),
    }


def rest(name=None):
    """Waits for full detail; records its delay after the last move."""
    start = time.perf_counter()
    yield 0.05
    while surface_object.is_coarse(bpy.context.object.data):
        yield 0.02
    if name is not None:
        found[name]["whole_after"] = time.perf_counter() - start
        found[name]["whole_triangles"] = len(bpy.context.object.data.polygons)
        print(name, found[name], flush=True)
    yield from stepwise.wait(0.5)


def begin_bake(window):
    """Starts a bake, and waits until it has shown a pass."""
    with bpy.context.temp_override(window=window, area=hand.view(), region=hand.region("UI")):
        bpy.ops.leaflight.bake("INVOKE_DEFAULT")
    # A bake shows its light in the viewport.
    draw_unlit()
    yield from rest()
    while not bpy.context.object.data.get("leaflight_shown", "").count('"pass '):
        if jobs.running() is None:
            raise RuntimeError("The bake has shown no pass.")
        yield 0.05


def bake_alone():
    """Lets the bake show passes for a while, without mouse events."""
    pictures.clear()
    start, before, passes = time.perf_counter(), None, 0
    statuses = set()
    while time.perf_counter() < start + 5.0:
        label = surface_object.label_of(bpy.context.object.data)
        passes, before = passes + (label != before), label
        statuses.add(jobs.running().status())
        yield 0.02
    found["bake alone"] = {"pictures": len(pictures), "passes": passes, "statuses": len(statuses)}


assert leaflight.__version__
main()
