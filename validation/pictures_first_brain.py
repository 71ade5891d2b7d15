# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of validation/pictures_first_brain that runs within Blender: ... -- ADDON.zip FOLDER."""

import os
import sys
import traceback

import bpy

ADDON, FOLDER = sys.argv[sys.argv.index("--") + 1 :][:2]
# The tab Leaflight in the sidebar, from the right edge of the viewport and from its top.
TAB = 10, 175


def run(drive):
    """Installs the add-on, then runs a script, which yields the seconds before its next step."""
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.ui_scale = 1.0
    bpy.ops.preferences.addon_install(filepath=ADDON)
    bpy.ops.preferences.addon_enable(module="leaflight_addon")
    script = drive()

    def step():
        try:
            return next(script)
        except StopIteration:
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)

    bpy.app.timers.register(step, first_interval=1.0)


def drive():
    from leaflight_addon.show import surface_object

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
    from leaflight_addon.operators import jobs
    from leaflight_addon.show import surface_object

    call(bpy.ops.leaflight.bake)
    while jobs.running() is not None:
        yield 0.5
    while surface_object.is_coarse(bpy.context.object.data):
        yield 0.5
    yield 2.0


def view():
    window = bpy.context.window_manager.windows[0]
    return window, next(area for area in window.screen.areas if area.type == "VIEW_3D")


def call(operator, how="INVOKE_DEFAULT", **options):
    window, area = view()
    with bpy.context.temp_override(window=window, area=area):
        assert operator(how, **options) & {"FINISHED", "RUNNING_MODAL"}


def open_tab():
    """Before 4.2 only the mouse can choose a tab."""
    window, area = view()
    area.spaces.active.show_region_ui = True
    yield 1.0
    region = next(region for region in area.regions if region.type == "UI")
    x, y = region.x + region.width - TAB[0], region.y + region.height - TAB[1]
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    yield 0.2
    for value in ("PRESS", "RELEASE"):
        window.event_simulate(type="LEFTMOUSE", value=value, x=x, y=y)
        yield 0.2
    yield 1.0


def picture(name):
    window, _ = view()
    with bpy.context.temp_override(window=window):
        bpy.ops.screen.screenshot(filepath=os.path.join(FOLDER, f"{name}.png"))


if __name__ == "__main__":
    run(drive)
