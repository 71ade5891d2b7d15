# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps every surface at its isovalue: after slider, keyframe, driver, undo and loading a file.

And keeps the files of the bakes with the .blend when it is saved.
"""

import bpy
from bpy.app.handlers import persistent

from ..bake import estimate_bake, stopped
from ..operators import background
from ..show import display, graph_object, isovalues, preview, settling, surface_object
from ..stage import images, staleness
from ..store import cache, moving, source_files


@persistent
def _after_evaluation(scene, depsgraph):
    isovalues.update(scene, depsgraph)
    settling.watch(isovalues.volumes(scene))


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
    surface_object.forget()
    _after_evaluation(scene, bpy.context.evaluated_depsgraph_get())


@persistent
def _before_render(scene, *_):
    settling.settle_now([obj for obj in isovalues.volumes(scene) if not obj.hide_render])


@persistent
def _before_load(*_):
    background.cancel_running()
    settling.forget()
    stopped.save_offered()
    preview.forget()
    estimate_bake.forget()
    cache.clear()
    graph_object.forget()
    images.forget()
    source_files.forget()
    surface_object.problems.clear()
    surface_object.forget()
    staleness.forget()


@persistent
def _after_save(*_):
    """Blender tells the new place only once the .blend is written: hence it is written again."""
    ours = [o for o in bpy.data.objects if o.leaflight.bake_id and o.library is None]
    changed, problems = moving.move_along(ours)
    surface_object.forget()
    for obj in ours:
        surface_object.update(obj, surface_object.shown_isovalue(obj))
    surface_object.problems.update(problems)
    staleness.forget()
    if changed:
        try:
            bpy.ops.wm.save_mainfile()
        except RuntimeError as error:
            sentence = f"The new places of the bakes are not in the saved .blend: {error}"
            surface_object.problems.update({obj.name_full: sentence.strip() for obj in ours})


@persistent
def _after_load(*_):
    for scene in bpy.data.scenes:
        if any(obj.leaflight.is_volume for obj in scene.objects):
            isovalues.lock_interface(scene)


_HANDLERS = (
    ("frame_change_post", _after_evaluation),
    ("depsgraph_update_post", _after_change),
    ("render_pre", _before_render),
    ("undo_post", _after_undo),
    ("redo_post", _after_undo),
    ("save_post", _after_save),
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
    settling.forget()
    stopped.save_offered()
    preview.forget()
    cache.clear()
    images.forget()
