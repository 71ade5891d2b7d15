# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python drag_blend.py -- FILE.blend: opens an exported .blend
without the add-on, and drags the isovalue's slider among the modifier's inputs with the mouse.

Prints a line WINDOW and a JSON object: for each step of the drag, the isovalue and the number of
vertices of the isosurface. Exits with status 1 if there is no slider.
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import mouse  # noqa: E402
import stepwise  # noqa: E402

STEPS, PIXELS = 12, 6

found = {"steps": []}


def drive():
    bpy.ops.wm.open_mainfile(filepath=sys.argv[-1])
    yield 2.0
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "PROPERTIES"
    yield 1.0
    area.spaces.active.context = "MODIFIER"
    yield 1.0
    region = next(region for region in area.regions if region.type == "WINDOW")
    rows = range(region.y + region.height - 10, region.y + 10, -8)
    x, y = yield from mouse.find_slider(window, region.x + region.width * 2 // 3, rows, state)
    for pause in mouse.gesture(window, [(x + PIXELS * k, y) for k in range(STEPS)]):
        yield pause
        found["steps"].append(state())


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


bpy.context.preferences.system.viewport_aa = "OFF"
stepwise.run(drive(), found)
