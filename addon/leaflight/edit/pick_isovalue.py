# SPDX-License-Identifier: GPL-3.0-or-later
"""Pick Isovalue: a large histogram over the viewport, in which you drag the isovalue."""

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from leaflight import LeaflightError

from .. import versions
from ..operators import checks
from ..operators.checks import active_volume
from ..show import distribution
from . import data_picture

# Margin as a share of the viewport's width. Height and bottom in pixels of an unscaled interface.
MARGIN, HEIGHT, ABOVE_THE_FLOOR = 0.08, 130, 46
PLATE = (0.06, 0.06, 0.06, 0.82)
WINDOW = (1.0, 1.0, 1.0, 0.07)

# Full name of an object -> draw handler of the operator that runs for it.
_drawn = {}


class LEAFLIGHT_OT_pick_isovalue(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Pick in Histogram"
    bl_description = (
        "Drag the isovalue in a histogram over the viewport. Enter, or a click beside the "
        "histogram, confirms. Esc restores the isovalue"
    )

    def invoke(self, context, _event):
        if context.area is None or context.area.type != "VIEW_3D":
            self.report(
                {"ERROR"}, "Pick in Histogram works only in the 3D viewport: call it there."
            )
            return {"CANCELLED"}
        volume = active_volume(context)
        self.object_name = volume.name_full
        self.area = context.area
        self.region = next(part for part in context.area.regions if part.type == "WINDOW")
        self.before = volume.leaflight.isovalue
        self.dragging = False
        try:
            self.found = distribution.look_now(volume)
        except LeaflightError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        _remove_all()
        _drawn[self.object_name] = bpy.types.SpaceView3D.draw_handler_add(
            self._draw, (), "WINDOW", "POST_PIXEL"
        )
        context.window_manager.modal_handler_add(self)
        self.area.tag_redraw()
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        obj = bpy.data.objects.get(self.object_name)
        # Undo, another file or another histogram may have ended it meanwhile.
        if obj is None or not obj.leaflight.is_volume or self.object_name not in _drawn:
            return self._end({"CANCELLED"})
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            _set(obj, self.before)
            return self._end({"CANCELLED"})
        if event.type in {"RET", "NUMPAD_ENTER"} and event.value == "PRESS":
            return self._end({"FINISHED"})
        if event.type == "LEFTMOUSE":
            if event.value == "PRESS" and not self._is_over(context, event):
                return self._end({"FINISHED"})
            self.dragging = event.value == "PRESS"
        if self.dragging and event.type in {"LEFTMOUSE", "MOUSEMOVE"}:
            _set(obj, self._isovalue_at(context, event))
            self.area.tag_redraw()
            return {"RUNNING_MODAL"}
        # Pass other events through, so that the view can be rotated.
        return {"RUNNING_MODAL"} if event.type == "LEFTMOUSE" else {"PASS_THROUGH"}

    def cancel(self, _context):
        self._end({"CANCELLED"})

    def _end(self, result):
        _remove_all()
        try:
            self.area.tag_redraw()
        except ReferenceError:
            pass
        return result

    def _box(self, context):
        """Returns left, bottom, width and height in the region's pixels, between its overlays."""
        scale = context.preferences.system.ui_scale
        left, right = 0, self.region.width
        if context.preferences.system.use_region_overlap:
            covers = {part.type: part.width for part in self.area.regions if part.width > 1}
            left, right = covers.get("TOOLS", 0), right - covers.get("UI", 0)
        width = right - left
        bottom = ABOVE_THE_FLOOR * scale
        return left + MARGIN * width, bottom, (1 - 2 * MARGIN) * width, HEIGHT * scale

    def _is_over(self, context, event):
        left, bottom, width, height = self._box(context)
        x, y = event.mouse_x - self.region.x - left, event.mouse_y - self.region.y - bottom
        return -8 <= x <= width + 8 and -8 <= y <= height + 8

    def _isovalue_at(self, context, event):
        left, _, width, _ = self._box(context)
        share = min(max((event.mouse_x - self.region.x - left) / width, 0.0), 1.0)
        return self.found.low + share * (self.found.high - self.found.low)

    def _draw(self):
        context = bpy.context
        obj = bpy.data.objects.get(self.object_name)
        if obj is None or context.area != self.area:
            return
        left, bottom, width, height = self._box(context)
        settings = obj.leaflight
        place = [
            left + width * min(max(self.found.place_of(value), 0.0), 1.0)
            for value in (settings.low, settings.high, settings.isovalue)
        ]
        gpu.state.blend_set("ALPHA")
        _rectangles([(left - 8, bottom - 8, width + 16, height + 16)], PLATE)
        _rectangles([(place[0], bottom, place[1] - place[0], height)], WINDOW)
        heights = height * data_picture.bars(self.found.counts)
        step = width / len(heights)
        edges = left + step * np.arange(len(heights))
        inside = (edges + step > place[0]) & (edges < place[1])
        for chosen, color in ((inside, data_picture.INSIDE), (~inside, data_picture.OUTSIDE)):
            shown = np.flatnonzero(chosen & (heights > 0))
            _rectangles([(edges[i], bottom, step, heights[i]) for i in shown], (*color, 1.0))
        _rectangles([(place[2] - 1, bottom - 4, 3, height + 8)], (*data_picture.ISOVALUE, 1.0))
        gpu.state.blend_set("NONE")
        scale = context.preferences.system.ui_scale
        _text(f"{settings.isovalue:.5g}", place[2] + 6, bottom + height - 14 * scale, scale)


def _set(obj, isovalue):
    """Sets the isovalue as the slider does, with coarse surfaces while it moves."""
    obj.leaflight["isovalue"] = float(isovalue)
    obj.update_tag()


def _rectangles(boxes, color):
    """Draws filled boxes (left, bottom, width, height) in one color."""
    if not boxes:
        return
    corners, triangles = [], []
    for left, bottom, width, height in boxes:
        n = len(corners)
        right, top = left + width, bottom + height
        corners += [(left, bottom), (right, bottom), (right, top), (left, top)]
        triangles += [(n, n + 1, n + 2), (n, n + 2, n + 3)]
    shader = gpu.shader.from_builtin(versions.flat_shader())
    batch = batch_for_shader(shader, "TRIS", {"pos": corners}, indices=triangles)
    shader.bind()
    shader.uniform_float("color", color)
    batch.draw(shader)


def _text(text, x, y, scale):
    versions.text_size(0, 12 * scale)
    blf.color(0, 1.0, 1.0, 1.0, 1.0)
    blf.position(0, x, y, 0)
    blf.draw(0, text)


def _remove_all():
    for handle in _drawn.values():
        bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
    _drawn.clear()


unregister = _remove_all
