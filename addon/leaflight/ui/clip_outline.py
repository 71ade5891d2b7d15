# SPDX-License-Identifier: GPL-3.0-or-later
"""The outline of the clip box, drawn while its panel is open and Blender's overlays are off.

Stage turns overlays off, which hides the Empty of the clip box.
"""

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import versions
from ..operators.checks import active_volume
from ..show import look

_COLOR = (1.0, 0.6, 0.15, 1.0)
_EDGES = [(a, a ^ bit) for bit in (1, 2, 4) for a in range(8) if not a & bit]

# Addresses of the areas whose sidebar showed the panel at its last draw, and of those whose
# viewport was redrawn for it.
_shown: set[int] = set()
_outlined: set[int] = set()
_handles = []


def begin_sidebar(context):
    """Forgets that the panel is open in a sidebar, at the start of each draw of the sidebar."""
    if context.area is None:
        return
    area = context.area.as_pointer()
    if area in _outlined - _shown:
        _outlined.discard(area)
        _redraw_view(context.area)
    _shown.discard(area)


def panel_is_open(context):
    """Records that the panel of the clip box is drawn, and redraws the viewport if needed."""
    if context.area is None:
        return
    area = context.area.as_pointer()
    _shown.add(area)
    if area not in _outlined:
        _outlined.add(area)
        _redraw_view(context.area)


def is_drawn(context):
    """True if a viewport shows the outline."""
    sidebar = next(region for region in context.area.regions if region.type == "UI")
    is_open = sidebar.width > 1 and context.area.as_pointer() in _shown
    return is_open and not context.space_data.overlay.show_overlays


def _redraw_view(area):
    for region in area.regions:
        if region.type == "WINDOW":
            region.tag_redraw()


def _draw():
    context = bpy.context
    volume = active_volume(context)
    box = look.box_of(volume) if volume is not None else None
    if box is None or not is_drawn(context):
        return
    low, high = look.bounds_of(box)
    ends = np.array([low, high])
    corners = np.array([[ends[i >> axis & 1, axis] for axis in range(3)] for i in range(8)])
    matrix = np.array(box.matrix_world, np.float64)
    places = corners @ matrix[:3, :3].T + matrix[:3, 3]
    shader = gpu.shader.from_builtin(versions.flat_shader(3))
    batch = batch_for_shader(shader, "LINES", {"pos": places.tolist()}, indices=_EDGES)
    shader.bind()
    shader.uniform_float("color", _COLOR)
    batch.draw(shader)


def register():
    if not bpy.app.background:
        handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")
        _handles.append(handle)


def unregister():
    for handle in _handles:
        bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
    _handles.clear()
    _shown.clear()
    _outlined.clear()
