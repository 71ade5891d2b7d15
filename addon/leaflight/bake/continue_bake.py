# SPDX-License-Identifier: GPL-3.0-or-later
"""Continue: go on with the bake that lights a volume, to a smaller error or for longer."""

import bpy
import leaflight

from ..operators import background, checks
from ..operators.active_volume import active_volume
from ..show import lamps
from ..stage import staleness
from ..store import cache, preferences
from . import bake, stopped


class ContinueJob(bake.BakeJob):
    """A bake that goes on where the one of an object ended, with its present error and time."""

    def __init__(self, context, obj, resume=False):
        """Raises LeaflightError when the bake is not found, or as BakeJob does."""
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
        return leaflight.resume(self._previous(how["progress"]), **arguments, **how)


class LEAFLIGHT_OT_continue_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.continue_bake"
    bl_label = "Continue"
    bl_description = (
        "Refine this bake until it reaches the target error or the time limit. Esc stops it, and "
        "the finished light can be kept"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not (cls.is_free() and stopped.is_decided(cls) and checks.has_bake(cls, context)):
            return False
        obj = active_volume(context)
        if not obj.leaflight.bake_outcome:
            cls.poll_message_set("Only a bake that goes by its error can be continued")
            return False
        change = staleness.known_change(obj) or _relit(obj)
        if change:
            cls.poll_message_set(change)
        return not change

    def start(self, context):
        obj = active_volume(context)
        change = staleness.change_since_bake(context, obj) or _relit(obj)
        if change:
            raise leaflight.LeaflightError(f"{change}.")
        return ContinueJob(context, obj)


def _relit(obj):
    if not lamps.factors_of(obj.leaflight):
        return ""
    return "Lamps have changed since the bake: set them back to continue it, or bake again"


class LEAFLIGHT_OT_finer_texels(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.finer_texels"
    bl_label = "Finer Texels"
    bl_description = (
        "Bake again with twice as many texels along each axis, which takes up to eight times the "
        "memory and the time"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return cls.is_free() and stopped.is_decided(cls) and checks.has_bake(cls, context)

    def start(self, context):
        obj = active_volume(context)
        grid = cache.grid_of(obj)
        obj.leaflight.resolution = 2 * max(grid.resolution) - 1
        return bake.BakeJob(context, obj)


def suited(obj):
    """The operator that brings the error of an object's bake to the present target, or None."""
    settings = obj.leaflight
    if not settings.bake_outcome or settings.bake_error <= settings.error:
        return None
    return LEAFLIGHT_OT_finer_texels if settings.bake_needs_texels else LEAFLIGHT_OT_continue_bake


_CLASSES = (LEAFLIGHT_OT_continue_bake, LEAFLIGHT_OT_finer_texels)
register, unregister = bpy.utils.register_classes_factory(_CLASSES)
