# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes after the first: Continue, Finer Texels, Resume after a crash, and Bake All Frames."""

import bpy
import leaflight
from leaflight import LeaflightError
from leaflight.bake.checkpoint import read_recipe

from .. import versions
from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..show import isovalues, lamps
from ..stage import staleness
from ..store import cache, preferences
from . import bake, stopped


class ContinueJob(bake.BakeJob):
    """A bake that continues the bake of an object, with its present target error and time limit."""

    def __init__(self, context, obj, resume=False):
        """Exports the scene. Raises LeaflightError as BakeJob, or if the bake is not found."""
        super().__init__(context, obj, resume)
        self._previous = cache.whole_of(obj)
        self._seconds_before = cache.light_of(obj).statistics.seconds
        settings = obj.leaflight
        self._arguments = {
            "error": settings.error,
            "time": bake.time_limit(settings),
            "threads": preferences.threads(),
        }

    def _recipe(self, obj):
        return {"previous": obj.leaflight.bake_id}

    def _light(self, **how):
        arguments = {**self._arguments, "checkpoint": self.checkpoint}
        return leaflight.refine(self._previous(how["progress"]), **arguments, **how)


def _relit(obj):
    if not lamps.factors_of(obj.leaflight):
        return ""
    return "Lamps have changed since the bake: set them back to continue it, or bake again"


def _is_unchanged(operator, context):
    obj = active_volume(context)
    change = staleness.known_change(obj) or _relit(obj)
    if change:
        operator.poll_message_set(change)
    return not change


_BAKE = (jobs.is_free, stopped.is_decided, *checks.BAKE)


class LEAFLIGHT_OT_continue_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Continue"
    bl_description = (
        "Refine this bake to the target error or the time limit. Esc stops it, and you "
        "can keep the finished light"
    )
    conditions = (
        *_BAKE,
        checks.volume_needs(
            lambda volume: volume.leaflight.bake_target,
            "Only a bake with a target error can be continued",
        ),
        _is_unchanged,
    )

    def start(self, context):
        obj = active_volume(context)
        change = staleness.change_since_bake(context, obj) or _relit(obj)
        if change:
            raise LeaflightError(f"{change}.")
        return ContinueJob(context, obj)


class LEAFLIGHT_OT_finer_texels(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Finer Texels"
    bl_description = (
        "Bake again with twice as many texels along each axis, with up to eight times the "
        "memory and the time"
    )
    conditions = _BAKE

    def start(self, context):
        obj = active_volume(context)
        grid = cache.grid_of(obj)
        obj.leaflight.resolution = 2 * max(grid.resolution) - 1
        return bake.BakeJob(context, obj)


def suited(obj):
    """Returns the operator that can reduce the error of a bake to the target, or None."""
    settings = obj.leaflight
    if not settings.bake_target or settings.bake_error <= settings.error:
        return None
    return LEAFLIGHT_OT_finer_texels if settings.bake_needs_texels else LEAFLIGHT_OT_continue_bake


class LEAFLIGHT_OT_resume_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Resume"
    bl_description = (
        "Resume the bake that was interrupted when Blender or the computer stopped. The "
        "result is that of an uninterrupted bake"
    )
    conditions = (
        *bake.LEAFLIGHT_OT_bake.conditions,
        checks.volume_needs(
            lambda volume: is_interrupted(volume), "No bake of this volume was interrupted"
        ),
    )

    def start(self, context):
        obj = active_volume(context)
        path = bake.checkpoint_path(obj)
        recipe = read_recipe(path)
        if "previous" not in recipe:
            return bake.BakeJob(context, obj, resume=True)
        if recipe["previous"] != obj.leaflight.bake_id:
            raise LeaflightError(
                f"{path}: the bake that was continued no longer lights the volume: bake again."
            )
        return ContinueJob(context, obj, resume=True)


def is_interrupted(obj):
    """True if a bake with the settings of an object was interrupted and left a checkpoint."""
    return bake.checkpoint_path(obj).is_file()


class LEAFLIGHT_OT_bake_frames(background.BackgroundOperator, bpy.types.Operator):
    bl_label = "Bake All Frames"
    bl_description = (
        "Bake each frame of the volume in the scene at its time. Esc stops, and finished "
        "frames stay baked"
    )
    conditions = (
        *bake.LEAFLIGHT_OT_bake.conditions,
        checks.volume_needs(
            lambda volume: volume.leaflight.frames > 1,
            "The file of this volume holds only one frame",
        ),
    )

    def start(self, context):
        self._name, self._scene_frame = active_volume(context).name, context.scene.frame_current
        self._steps = _each_frame(self._name)
        next(self._steps)
        return bake.BakeJob(context, active_volume(context))

    def next_job(self, context):
        obj = context.scene.objects.get(self._name)
        if obj is None or next(self._steps, None) is None:
            context.scene.frame_set(self._scene_frame)
            return None
        return bake.BakeJob(context, obj)


def _each_frame(name):
    """Shows each frame of a volume in the present scene once, and yields its number.

    Looks up volume and scene for each frame, because undo may replace them meanwhile.
    """
    volume = _volume(name)
    frames = volume.leaflight.frames
    if not versions.is_animated(volume, isovalues.FRAME_PATH):
        for frame in range(frames):
            _volume(name).leaflight.shown_frame = frame
            yield frame
        return
    done = set()
    scene = bpy.context.scene
    for scene_frame in range(scene.frame_start, scene.frame_end + 1):
        bpy.context.scene.frame_set(scene_frame)
        frame = _volume(name).leaflight.frame
        if frame not in done:
            done.add(frame)
            yield frame
        if len(done) == frames:
            return


def _volume(name):
    return bpy.context.scene.objects[name]
