# SPDX-License-Identifier: GPL-3.0-or-later
"""Resume: go on with a bake that ended with Blender, as if nothing had been."""

import bpy
import leaflight
from leaflight.bake.checkpoint import read_recipe

from ..operators import background, checks
from ..operators.active_volume import active_volume
from . import bake, stopped
from .continue_bake import ContinueJob


class LEAFLIGHT_OT_resume_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.resume_bake"
    bl_label = "Resume"
    bl_description = (
        "Go on with the bake that did not come to its end, because Blender or the computer "
        "stopped. It becomes what it would have been"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not (cls.is_free() and stopped.is_decided(cls) and checks.has_volume(cls, context)):
            return False
        if not is_interrupted(active_volume(context)):
            cls.poll_message_set("No bake of this volume was interrupted")
            return False
        return True

    def start(self, context):
        obj = active_volume(context)
        path = bake.checkpoint_path(obj)
        recipe = read_recipe(path)
        if "previous" not in recipe:
            return bake.BakeJob(context, obj, resume=True)
        if recipe["previous"] != obj.leaflight.bake_id:
            raise leaflight.LeaflightError(
                f"{path}: the bake that this one went on with no longer lights the volume: bake "
                "again."
            )
        return ContinueJob(context, obj, resume=True)


def is_interrupted(obj):
    """Whether a bake with the settings of an object left a checkpoint and did not end."""
    return bake.checkpoint_path(obj).is_file()


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_resume_bake)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_resume_bake)
