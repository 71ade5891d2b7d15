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
        self._previous = cache.bake_of(obj)
        self._seconds_before = self._previous.statistics.seconds
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
        return leaflight.resume(self._previous, **arguments, **how)


class LEAFLIGHT_OT_continue_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.continue_bake"
    bl_label = "Continue"
    bl_description = (
        "Go on with the bake that lights the volume, until its error is the present one or the "
        "time is over. Esc stops it, and the light that is finished can be kept"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not (cls.is_free() and stopped.is_decided(cls) and checks.has_bake(cls, context)):
            return False
        obj = active_volume(context)
        if not can_continue(obj):
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


def can_continue(obj):
    """Whether the bake that lights an object went by its error."""
    return bool(obj.leaflight.bake_outcome)


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_continue_bake)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_continue_bake)
