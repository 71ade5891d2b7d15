# SPDX-License-Identifier: GPL-3.0-or-later
"""Clicks and times the steps of stage.py in a window of Blender.

Arguments: volume, stage, 1 for lit walls, isovalue, quality, folder of bakes.
"""

import statistics
import sys
import time

import bpy
import hand
import seen
import stepwise
from leaflight import blender
from leaflight_addon.operators import jobs
from leaflight_addon.show import surface_object, whole_detail
from leaflight_addon.stage import staleness

VOLUME, STAGE, WALLS, ISOVALUE, QUALITY, FOLDER = sys.argv[-6:]
# Steps of the isovalue, and the relative change in each.
STEPS, CHANGE = 10, 1e-3

found = {"steps": []}


def main():
    hand.clear_scene()
    stepwise.run(clicks(), found)


class Clock:
    """Measures a step from its making to add()."""

    def __init__(self):
        self._start = time.perf_counter(), time.process_time()

    def time(self):
        """Returns the seconds and the processor seconds since the start."""
        now = time.perf_counter(), time.process_time()
        return [end - start for end, start in zip(now, self._start)]

    def add(self, name):
        found["steps"].append([name, *self.time()])


def clicks():
    view = hand.view().spaces.active
    # Without a graphics card, a picture of the isosurface takes seconds, also that in a file, and
    # smooth edges draw each picture eight times.
    view.shading.type, view.overlay.show_overlays = "SOLID", False
    bpy.context.preferences.filepaths.file_preview_type = "NONE"
    bpy.context.preferences.system.viewport_aa = "OFF"
    yield from stepwise.wait(1.0)
    clock = Clock()
    obj = blender.import_volume(VOLUME)
    clock.add("import")
    clock = Clock()
    blender.stage(obj, STAGE)
    clock.add("stage")
    draw_little()
    settings = obj.leaflight
    settings.light_walls, settings.bake_folder = WALLS == "1", FOLDER
    settings.isovalue, settings.quality = float(ISOVALUE), QUALITY
    yield from stepwise.wait(1.0)
    yield from bake()
    yield from isovalues()
    yield from lamp()
    yield from cut()
    yield from save_and_open()


def draw_little():
    """Draws boxes without light in place of the surfaces."""
    hand.view().spaces.active.shading.type = "SOLID"
    for obj in bpy.context.scene.objects:
        obj.display_type = "BOUNDS"


def shown():
    return surface_object.label_of(hand.volume().data)


def bake():
    before, clock, first, seen_until = shown(), Clock(), True, None
    hand.press(bpy.ops.leaflight.bake)
    # A bake shows its light in the viewport.
    draw_little()
    while jobs.running() is not None:
        yield 0.01
        if jobs.running() is not None and shown() != before:
            before, seen_until = shown(), clock.time()
            if first:
                clock.add("bake, first light")
            first = False
    # A quick bake may end before a pass is shown.
    found["steps"].append(["bake, last pass", *(seen_until or clock.time())])
    clock.add("bake, files written")
    yield from stepwise.until(lambda: not surface_object.is_coarse(hand.volume().data))


def isovalues():
    may_follow = whole_detail.may_follow
    for name, follows in (("isovalue, at rest", False), ("isovalue, while it moves", True)):
        whole_detail.may_follow = lambda *_, is_so=follows: is_so
        times = []
        for step in range(STEPS + 2):
            obj = hand.volume()
            obj.leaflight["isovalue"] = float(ISOVALUE) * (1 + CHANGE * step)
            obj.update_tag()
            start = time.perf_counter(), time.process_time()
            bpy.context.view_layer.update()
            times.append((time.perf_counter() - start[0], time.process_time() - start[1]))
            yield 0.01
        # The first two steps still depend on the mesh before them.
        found["steps"].append([name, *map(statistics.median, zip(*times[2:]))])
    whole_detail.may_follow = may_follow
    yield from stepwise.wait(1.0)
    yield from stepwise.until(lambda: not surface_object.is_coarse(hand.volume().data))


def lamp():
    bpy.context.scene.leaflight_live = True
    yield from stepwise.until(seen.at_rest)
    before, clock, first = shown(), Clock(), True
    light = hand.lamp()
    light.location.x -= 0.3 * abs(light.location.x) + 0.1
    bpy.context.view_layer.update()
    while first or not seen.at_rest():
        yield 0.01
        if first and shown() != before:
            clock.add("lamp, direct light")
            first = False
    clock.add("lamp, whole")


def box():
    return hand.volume().leaflight_look.box


def cut():
    with hand.in_view():
        bpy.ops.leaflight.add_clip_box()
    clock = Clock()
    hand.press(bpy.ops.leaflight.cut_data)
    yield from stepwise.until(lambda: jobs.running() is None and seen.cut_is_shown())
    clock.add("cut")
    yield from stepwise.until(seen.at_rest)
    clock, left = Clock(), ["cut moved, at once", "cut moved, direct light"]
    box().location.z += 0.1 * box().scale.z
    bpy.context.view_layer.update()
    # The passes of a small volume may end before its direct light is shown.
    while staleness.change_since_bake(bpy.context, hand.volume()) or not seen.at_rest():
        yield 0.01
        if left and seen.cut_is_shown() and (len(left) == 2 or seen.surface()["moved"]):
            clock.add(left.pop(0))
    clock.add("cut moved, whole")
    bpy.context.scene.leaflight_live = False


def save_and_open():
    clock, path = Clock(), f"{FOLDER}.blend"
    bpy.ops.wm.save_as_mainfile(filepath=path)
    clock.add("save")
    clock = Clock()
    bpy.ops.wm.open_mainfile(filepath=path)
    clock.add("open, last surface")
    obj = hand.volume()
    obj.leaflight["isovalue"] = 1.01 * float(ISOVALUE)
    obj.update_tag()
    bpy.context.view_layer.update()
    yield from stepwise.until(lambda: not surface_object.is_coarse(hand.volume().data))
    clock.add("open, a new isovalue")


main()
