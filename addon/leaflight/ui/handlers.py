# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps every surface at its isovalue: after slider, keyframe, driver, undo and loading a file."""

import bpy
from bpy.app.handlers import persistent

from ..operators import background
from ..show import display, graph_object, isovalues, surface_object
from ..stage import images, staleness
from ..store import cache


@persistent
def _after_evaluation(scene, depsgraph):
    isovalues.update(scene, depsgraph)


@persistent
def _after_change(scene, depsgraph):
    _after_evaluation(scene, depsgraph)
    ours = [o for o in scene.objects if o.leaflight.is_volume or display.is_display(o)]
    own = {obj.data.name for obj in ours} | {obj.name for obj in ours}
    for update in depsgraph.updates:
        moved = update.is_updated_transform or update.is_updated_shading
        if moved or (update.is_updated_geometry and update.id.name not in own):
            staleness.forget()
            return


@persistent
def _after_undo(scene, _depsgraph):
    """Undo may bring back an isovalue without its surface, made after the step was stored."""
    staleness.forget()
    _after_evaluation(scene, bpy.context.evaluated_depsgraph_get())


@persistent
def _before_load(*_):
    background.cancel_running()
    cache.clear()
    graph_object.forget()
    images.forget()
    surface_object.problems.clear()
    staleness.forget()


@persistent
def _after_load(*_):
    for scene in bpy.data.scenes:
        if any(obj.leaflight.is_volume for obj in scene.objects):
            isovalues.lock_interface(scene)


_HANDLERS = (
    ("frame_change_post", _after_evaluation),
    ("depsgraph_update_post", _after_change),
    ("undo_post", _after_undo),
    ("redo_post", _after_undo),
    ("load_pre", _before_load),
    ("load_post", _after_load),
)


def register():
    for event, handler in _HANDLERS:
        getattr(bpy.app.handlers, event).append(handler)


def unregister():
    for event, handler in _HANDLERS:
        getattr(bpy.app.handlers, event).remove(handler)
    background.cancel_running()
    cache.clear()
    images.forget()
