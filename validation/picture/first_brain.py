# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- FOLDER. Takes pictures of the window after each of the four clicks."""

import os
import sys

import bpy
import hand
import stepwise
from leaflight_addon.operators import jobs
from leaflight_addon.show import surface_object

FOLDER = sys.argv[sys.argv.index("--") + 1]
# Position of the tab Leaflight, from the right edge of the viewport and from its top.
TAB = 10, 175


def drive():
    yield from open_tab()
    call(bpy.ops.leaflight.open_example)
    yield 2.0
    picture("first_brain_imported")
    yield 0.5
    call(bpy.ops.leaflight.stage)
    yield 30.0  # shaders are compiled
    picture("first_brain_staged")
    yield 0.5
    yield from bake()
    picture("first_brain_baked")
    yield 0.5
    settings = bpy.context.object.leaflight
    settings.isovalue = settings.low + 0.5 * (settings.high - settings.low)
    yield 1.0
    while surface_object.is_coarse(bpy.context.object.data):
        yield 0.5
    yield 1.0
    picture("first_brain_scrubbed")
    yield 0.5


def bake():
    call(bpy.ops.leaflight.bake)
    while jobs.running() is not None:
        yield 0.5
    while surface_object.is_coarse(bpy.context.object.data):
        yield 0.5
    yield 2.0


def call(operator, how="INVOKE_DEFAULT", **options):
    with hand.in_view():
        assert operator(how, **options) & {"FINISHED", "RUNNING_MODAL"}


def open_tab():
    """Opens the tab; before 4.2, only mouse events can choose one."""
    hand.view().spaces.active.show_region_ui = True
    yield 1.0
    region = hand.region("UI")
    x, y = region.x + region.width - TAB[0], region.y + region.height - TAB[1]
    hand.window().event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    yield 0.2
    for value in ("PRESS", "RELEASE"):
        hand.window().event_simulate(type="LEFTMOUSE", value=value, x=x, y=y)
        yield 0.2
    yield 1.0


def picture(name):
    with bpy.context.temp_override(window=hand.window()):
        bpy.ops.screen.screenshot(filepath=os.path.join(FOLDER, f"{name}.png"))


if __name__ == "__main__":
    stepwise.run(drive(), {})
