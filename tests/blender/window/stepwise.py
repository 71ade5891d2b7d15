# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs simulated user input in a window step by step, while Blender keeps working."""

import json
import os
import sys
import time
import traceback

import bpy
import gpu
import numpy as np


def run(script, found):
    """Runs a generator by a timer, then exits Blender, with status 1 after an exception.

    script: yields the seconds until its next step, also across the loading of a file. found: a dict
    that the steps fill, printed as JSON after WINDOW.
    """

    def step():
        try:
            return next(script)
        except StopIteration:
            _leave(found, 0)
        except Exception:
            traceback.print_exc()
            _leave(found, 1)

    view = bpy.context.preferences.view
    view.show_splash = view.use_save_prompt = False
    view.ui_scale = 1.0
    # 5.2 crashes when a script presses the button of a browser in a separate window.
    view.filebrowser_display_type = "SCREEN"
    bpy.app.timers.register(step, first_interval=1.0, persistent=True)


def _leave(found, status):
    print("WINDOW", json.dumps(found), flush=True)
    # A Blender without the add-on has none.
    jobs = sys.modules.get("leaflight_addon.operators.jobs")
    if jobs is not None:
        jobs.cancel_running()
    os._exit(status)


def until(is_so):
    """Yields until a condition holds; the test ends what hangs."""
    while not is_so():
        yield 0.05


def wait(seconds):
    """Yields for at least these seconds, while Blender does its own work several times."""
    end, steps = time.perf_counter() + seconds, 0
    while time.perf_counter() < end or steps < 10:
        steps += 1
        yield seconds / 10


def pixels_of(area, found):
    """Yields until an area's viewport and overlays are drawn.

    Then `found` has its pixels, float32 (height, width, 4), bottom row first. Screenshots are black
    in Blender 5.2 with OpenGL.
    """
    region = next(region for region in area.regions if region.type == "WINDOW")

    def read():
        if "pixels" not in found and bpy.context.area == area:
            buffer = gpu.state.active_framebuffer_get()
            size = region.width, region.height
            pixels = buffer.read_color(0, 0, *size, 4, 0, "FLOAT")
            found["pixels"] = np.array(pixels.to_list(), np.float32).reshape(*size[::-1], 4)

    # Run after the existing draw handlers.
    handle = bpy.types.SpaceView3D.draw_handler_add(read, (), "WINDOW", "POST_PIXEL")
    try:
        while "pixels" not in found:
            region.tag_redraw()
            yield 0.1
    finally:
        bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
