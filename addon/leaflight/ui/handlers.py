# SPDX-License-Identifier: GPL-3.0-or-later
"""Handlers of Blender's events.

They keep every surface at its isovalue: after a move of the slider, keyframes, drivers, undo and
loading. When the .blend is saved they move the files of its bakes along.
"""

import bpy
from bpy.app.handlers import persistent

from .. import session
from ..bake import live, stopped
from ..importing import box_cuts
from ..operators import checks, failures, jobs
from ..show import (
    data_faces,
    display,
    isovalues,
    surface_material,
    surface_object,
    walls,
    whole_detail,
)
from ..stage import staleness
from ..store import bake_files, cache, frame_bakes


def _follow(scene, depsgraph, by_hand):
    """Shows the isosurfaces of the scene as they were evaluated. Returns those that have moved.

    Lamps have the strengths of the last call of staleness.follow_lamps().
    """
    moved = isovalues.update(scene, depsgraph, by_hand)
    for volume in isovalues.volumes(scene):
        data_faces.update_cut(volume, depsgraph)
        data_faces.update_slices(volume, depsgraph)
    whole_detail.watch(isovalues.isosurfaces(scene))
    return moved


@persistent
def _after_frame(scene, depsgraph):
    staleness.follow_lamps(scene, depsgraph)
    by_hand = whole_detail.may_follow(depsgraph) and _plays()
    with cache.waiting(not by_hand):
        _follow(scene, depsgraph, by_hand)


def _plays():
    """True if a window plays or scrubs. Otherwise the frame was chosen and may be rendered."""
    screens = [window.screen for window in bpy.context.window_manager.windows]
    return any(screen.is_animation_playing or screen.is_scrubbing for screen in screens)


# Isosurfaces that were moved before Blender evaluated the change.
_moved = session.cache(list)


@persistent
def _before_change(scene, *_):
    _moved[:] = isovalues.update_before_evaluation(scene, whole_detail.may_follow())


@persistent
def _after_change(scene, depsgraph):
    if depsgraph.mode == "VIEWPORT":
        checks.remember_active(scene, depsgraph.view_layer.objects.active)
    moved = list(_moved)
    _moved.clear()
    # Copy the updates first, because Blender may free them during the changes below.
    changes = [_Change(update) for update in depsgraph.updates]
    shown_anew = any(_is_isosurface(change.what) for change in changes)
    if shown_anew:
        isovalues.complete_duplicates()
    may_shine = shown_anew or any(staleness.concerns_lamps(change.what) for change in changes)
    relit = may_shine and staleness.follow_lamps(scene, depsgraph)
    if shown_anew or relit or isovalues.any_is_behind(depsgraph):
        moved += _follow(scene, depsgraph, whole_detail.may_follow(depsgraph))
    changed, clip_boxes = {change.what for change in changes}, _clip_boxes(scene)
    # A box with a new name is no longer among those of box_cuts.
    if shown_anew or changed & (box_cuts.boxes(scene) | clip_boxes):
        box_cuts.follow(scene)
    if changed & clip_boxes:
        for volume in isovalues.volumes(scene):
            data_faces.update_cut(volume, depsgraph)
    if shown_anew or relit or moved:
        # Blender redraws only the region in which the isovalue was moved, but two regions show it.
        jobs.redraw_panels()
    for obj in filter(display.is_isosurface, isovalues.known()):
        if obj.library is None and not surface_material.shows_its_view(obj):
            surface_object.shade(obj)
    if any(_concerns_bakes(scene, change, moved) for change in changes):
        staleness.forget()
        live.changed(scene, at_once=depsgraph.mode == "VIEWPORT")
    if isovalues.orphans() or walls.are_orphans(scene):
        _remove(_remove_orphans)


def _remove_orphans():
    isovalues.remove_orphans()
    walls.remove_orphans()


def _remove(remove):
    """Calls a function that removes objects. In a window it runs after the handler has ended.

    Other handlers may read the same updates. Blender 5.2 crashes if undo has just read objects.
    """
    if bpy.app.background:
        remove()
    else:
        bpy.app.timers.register(remove, first_interval=0.0)


class _Change:
    """An update of a data-block, copied from Blender."""

    def __init__(self, update):
        self.what = update.id.original
        self.elsewhere = update.is_updated_transform or update.is_updated_shading
        self.geometry = update.is_updated_geometry


def _is_isosurface(changed):
    return isinstance(changed, bpy.types.Object) and display.is_isosurface(changed)


def _clip_boxes(scene):
    return {obj.leaflight_look.box for obj in scene.objects} - {None}


def _concerns_bakes(scene, change, moved):
    """Returns True if a change of a data-block may change the result of a bake.

    moved: volumes whose isovalue changed. Blender then reports their other properties as changed.
    """
    changed, elsewhere = change.what, change.elsewhere
    if changed in moved:
        return staleness.stands_elsewhere(changed)
    if isinstance(changed, bpy.types.Object):
        # Objects that an Empty moves report updates of their own.
        if changed.type == "EMPTY" and changed.instance_type == "NONE":
            return False
        return elsewhere or (change.geometry and not _is_ours(changed))
    if not (elsewhere or change.geometry) or surface_material.is_own(changed):
        return False
    is_mesh = isinstance(changed, bpy.types.Mesh)
    return not (is_mesh and any(_is_ours(o) for o in scene.objects if o.data == changed))


def _is_ours(obj):
    """True if Leaflight makes the geometry of an object."""
    return obj.leaflight.is_volume or display.is_display(obj)


# Name of an isosurface -> its materials that were removed before undo.
_taken_off = session.cache()


@persistent
def _before_undo(*_):
    """Removes the materials of isosurfaces before undo, for _after_undo() to restore.

    Undo removes materials that a bake has made after the step was stored. Blender 5.2 keeps meshes
    that refer to them and crashes.
    """
    own = [obj for obj in bpy.data.objects if obj.library is None and display.is_isosurface(obj)]
    _taken_off.update({obj.name: surface_material.take_off(obj) for obj in own})


def _put_on():
    for name, names in _taken_off.items():
        obj = bpy.data.objects.get((name, None))
        if obj is not None and display.is_isosurface(obj):
            surface_material.put_on(obj, names)
    _taken_off.clear()


@persistent
def _after_undo(scene, _depsgraph):
    """Updates all surfaces, because undo may restore an isovalue without its surface."""
    _put_on()
    failures.forget()
    staleness.forget()
    surface_object.forget()
    _remove(surface_material.forget_first_light)
    isovalues.complete_duplicates()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    staleness.follow_lamps(scene, depsgraph)
    _follow(scene, depsgraph, whole_detail.may_follow(depsgraph))
    for obj in isovalues.isosurfaces(scene):
        # Undo keeps older meshes, but not the materials that a bake in progress has given them.
        if obj.library is None and obj.data.materials and obj.data.materials[0] is None:
            surface_object.shade(obj)
    box_cuts.follow(scene)
    live.changed(scene)


def _show_reading(progress, has_news):
    """Shows the progress of files that are being read, None at the end, and what was read.

    Work in progress has priority in the status bar.
    """
    if jobs.running() is None:
        text = progress and jobs.status_of(progress.fraction, progress.stage)
        jobs.show_status(text and f"Leaflight  {text}")
    jobs.redraw_panels()
    if has_news:
        _show_what_was_read()


def _show_what_was_read():
    """Completes the isosurfaces, walls and checks that had to do without a file."""
    for window in bpy.context.window_manager.windows:
        # Other scenes follow once they are shown.
        _follow(window.scene, window.view_layer.depsgraph, whole_detail.may_follow())
    for scene in bpy.data.scenes:
        for obj in isovalues.isosurfaces(scene):
            if obj.library is None:
                surface_object.shade(obj)
            if obj.leaflight.is_volume:
                isovalues.limit_all(obj)
        walls.complete(scene)
    for window in bpy.context.window_manager.windows:
        box_cuts.follow(window.scene)
    staleness.forget()
    live.changed(bpy.context.scene)


@persistent
def _before_render(scene, *_):
    with cache.waiting():
        isovalues.update_before_evaluation(scene)
        walls.finish(scene)
        whole_detail.make_now([obj for obj in isovalues.isosurfaces(scene) if not obj.hide_render])


@persistent
def _before_load(*_):
    live.forget()
    jobs.abandon()
    failures.forget()
    stopped.save_offered()
    session.clear()
    staleness.forget()


@persistent
def _after_save(*_):
    """Moves the bakes along with the .blend, and saves it again with their new paths.

    Blender has the new path of the .blend only after it was saved.
    """
    ours = [o for o in bpy.data.objects if o.library is None and frame_bakes.bakes_of(o.leaflight)]
    changed, problems = bake_files.move_along(ours)
    surface_object.forget()
    for obj in ours:
        surface_object.update_all(obj)
    surface_object.problems.update(problems)
    staleness.forget()
    if changed:
        try:
            bpy.ops.wm.save_mainfile()
        except RuntimeError as error:
            sentence = f"The saved .blend lacks the new paths of its bakes: {error}"
            surface_object.problems.update({obj.name_full: sentence.strip() for obj in ours})


@persistent
def _after_load(*_):
    surface_material.forget_first_light()
    for scene in bpy.data.scenes:
        if any(obj.leaflight.is_volume for obj in scene.objects):
            isovalues.lock_interface(scene)
    scene, depsgraph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    staleness.follow_lamps(scene, depsgraph)
    # Update all surfaces, because files of bakes may have appeared or disappeared.
    _follow(scene, depsgraph, whole_detail.may_follow())
    box_cuts.follow(scene)
    live.changed(scene)


_HANDLERS = (
    ("frame_change_post", _after_frame),
    ("depsgraph_update_pre", _before_change),
    ("depsgraph_update_post", _after_change),
    ("render_pre", _before_render),
    ("undo_pre", _before_undo),
    ("redo_pre", _before_undo),
    ("undo_post", _after_undo),
    ("redo_post", _after_undo),
    ("save_post", _after_save),
    ("load_pre", _before_load),
    ("load_post", _after_load),
)


def register():
    for event, handler in _HANDLERS:
        getattr(bpy.app.handlers, event).append(handler)
    cache.watching.append(_show_reading)


def unregister():
    for event, handler in _HANDLERS:
        getattr(bpy.app.handlers, event).remove(handler)
    cache.watching.remove(_show_reading)
    jobs.abandon()
    stopped.save_offered()
    session.clear()
