# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python drag_blend.py -- FILE.blend: opens an exported .blend
without the add-on, and drags the isovalue's slider among the modifier's inputs with the mouse.

Prints a line WINDOW and a JSON object: a list for each step of the drag, with the isovalue and the
vertices of the isosurface. Exits with status 1 if there is no slider.
"""

import json
import os
import sys
import traceback

import bpy

STEPS, PIXELS, PAUSE = 12, 6, 0.1


def main():
    view = bpy.context.preferences.view
    view.show_splash = view.use_save_prompt = False
    view.ui_scale = 1.0
    bpy.context.preferences.system.viewport_aa = "OFF"
    bpy.app.timers.register(step, first_interval=1.0, persistent=True)


def step(script=[]):  # noqa: B006 - the generator lives as long as the timer
    try:
        if not script:
            script.append(drive())
        return next(script[0])
    except StopIteration as end:
        print("WINDOW", json.dumps(end.value), flush=True)
        os._exit(0)
    except Exception:
        traceback.print_exc()
        os._exit(1)


def drive():
    bpy.ops.wm.open_mainfile(filepath=sys.argv[-1])
    yield 2.0
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "PROPERTIES"
    yield 1.0
    area.spaces.active.context = "MODIFIER"
    yield 1.0
    place = yield from slider(window, area)
    seen = []
    x, y = place
    for at in gesture(window, [(x + PIXELS * k, y) for k in range(STEPS)]):
        yield at
        seen.append(state())
    return seen


def state():
    """Returns the isovalue and the number of vertices of the isosurface."""
    shown = bpy.context.view_layer.objects.active
    modifier = shown.modifiers["Leaflight"]
    (item,) = (i for i in modifier.node_group.interface.items_tree if i.name == "Isovalue")
    inputs = getattr(modifier, "properties", None)
    if inputs is None:
        isovalue = modifier[item.identifier]
    else:
        isovalue = getattr(inputs.inputs, item.identifier).value
    graph = bpy.context.evaluated_depsgraph_get()
    geometry = shown.evaluated_get(graph).evaluated_geometry()
    return isovalue, len(geometry.mesh.vertices)


def slider(window, area):
    """Presses and drags slightly in each row until the isovalue moves; returns the position."""
    region = next(region for region in area.regions if region.type == "WINDOW")
    x = region.x + region.width * 2 // 3
    for y in range(region.y + region.height - 10, region.y + 10, -8):
        before = state()
        yield from gesture(window, [(x + 3 * k, y) for k in range(6)])
        yield 0.3
        if state() != before:
            return x, y
    raise RuntimeError("There is no slider of the isovalue among the modifier's inputs.")


def gesture(window, places):
    """Presses the mouse at the first position, and releases it at the last."""
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=places[0][0], y=places[0][1])
    yield PAUSE
    window.event_simulate(type="LEFTMOUSE", value="PRESS", x=places[0][0], y=places[0][1])
    for x, y in places[1:]:
        yield PAUSE
        window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    yield PAUSE
    window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=places[-1][0], y=places[-1][1])


main()
