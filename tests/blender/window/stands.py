# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python stands.py -- FOLDER: what made the window stand still.

A scan whose background is noise is lit, and then: its file is opened again, a clip box is added,
the isovalue goes among the noise, and a picture is rendered. Prints a line WINDOW and a JSON
object. Each step has the longest time that the window stood and what Leaflight did then. The step
into the noise also has the number of triangles at first. "beside walls": the clip box was there
before the light of the walls, which is computed when a bake is read. "walls": that light came.
"""

import os
import sys
import threading
from pathlib import Path

import bpy
import numpy as np
from leaflight_addon.operators import jobs
from leaflight_addon.show import surface_object
from leaflight_addon.stage import viewport
from leaflight_addon.store import cache, reading

sys.path.insert(0, os.path.dirname(__file__))
import hand  # noqa: E402
import heartbeat  # noqa: E402
import seen  # noqa: E402
import stepwise  # noqa: E402

FOLDER = Path(sys.argv[-1])
NODES = 96
# Isovalues of the blob, and of the noise around it.
BLOB, NOISE = 50.0, 5.0

found = {}


def main():
    view = bpy.context.preferences.view
    view.show_splash = view.use_save_prompt = False
    bpy.context.preferences.system.viewport_aa = "OFF"
    x = np.linspace(-1.0, 1.0, NODES)
    distance = np.sqrt(x[:, None, None] ** 2 + x[:, None] ** 2 + x**2)
    noise = np.random.default_rng(1).normal(NOISE, 2.0, distance.shape)
    # Without a graphics card each picture of materials takes many seconds.
    viewport._show_materials = lambda _shading: None
    np.save(FOLDER / "scan.npy", np.where(distance < 0.6, 100.0 - 100.0 * distance, noise))
    stepwise.run(drive(), found)


def drive():
    yield from stepwise.wait(1.0)
    beat = heartbeat.Heartbeat()
    yield from light()
    for name, step in (
        ("reopened", reopen),
        ("clip box", add_clip_box),
        ("among noise", go_among_noise),
        ("rendered", render),
    ):
        print(f"Step: {name}", flush=True)
        beat.start()
        at_first = yield from step()
        yield from settle()
        found[name] = {"seconds": beat.seconds, "where": beat.where, "at first": at_first}


def light():
    with hand.in_view():
        bpy.ops.leaflight.import_volume(filepath=str(FOLDER / "scan.npy"))
        settings = seen.volume().leaflight
        settings.use_resolution, settings.resolution, settings.error = True, 9, 50.0
        settings.low, settings.high, settings.isovalue = 2.0, 60.0, BLOB
        bpy.ops.leaflight.stage()
        settings.use_time_limit, settings.time_limit = True, 1.0
        bpy.ops.leaflight.bake("INVOKE_DEFAULT")
    yield from settle()
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "scene.blend"))


def reopen():
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "scene.blend"))
    yield from hand.steps(2)


def add_clip_box():
    """The file has just been opened: the walls of its bake have no light before it is there."""
    may_go_on, with_walls = threading.Event(), reading.with_walls
    reading.with_walls = lambda *read: may_go_on.wait() and with_walls(*read)
    with hand.in_view():
        bpy.ops.leaflight.add_clip_box()
    yield from hand.steps(2)
    has_box = seen.volume().leaflight_look.box is not None
    found["beside walls"] = has_box and bool(cache._readings)
    may_go_on.set()
    yield from stepwise.until(lambda: not cache._readings)
    found["walls"] = cache.bake_of(seen.volume()).walls is not None


def go_among_noise():
    # As the slider does.
    seen.volume().leaflight["isovalue"] = NOISE
    seen.volume().update_tag()
    bpy.context.view_layer.update()
    triangles = len(seen.volume().data.polygons)
    yield from hand.steps(2)
    return triangles


def render():
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 16
    done = []
    bpy.app.handlers.render_complete.append(lambda *_: done.append(True))
    with hand.in_view():
        bpy.ops.render.render("INVOKE_DEFAULT")
    yield from stepwise.until(lambda: done)


def settle():
    yield from hand.steps(8)
    coarse = lambda: surface_object.is_coarse(seen.volume().data)  # noqa: E731
    yield from stepwise.until(lambda: jobs.running() is None and not coarse())


main()
