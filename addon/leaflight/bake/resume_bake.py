# SPDX-License-Identifier: GPL-3.0-or-later
"""Resume: go on with a bake that ended with Blender, as if nothing had been."""

import bpy
from leaflight import LeaflightError
from leaflight.bake.checkpoint import read_recipe

from ..operators import background, checks
from ..operators.checks import active_volume
from . import bake
from .continue_bake import ContinueJob


class LEAFLIGHT_OT_resume_bake(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.resume_bake"
    bl_label = "Resume"
    bl_description = (
        "Go on with the bake that did not come to its end, because Blender or the computer "
        "stopped. It becomes what it would have been"
    )
    conditions = (
        *bake.LEAFLIGHT_OT_bake.conditions,
        checks.needs(
            lambda context: is_interrupted(active_volume(context)),
            "No bake of this volume was interrupted",
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
                f"{path}: the bake that this one went on with no longer lights the volume: bake "
                "again."
            )
        return ContinueJob(context, obj, resume=True)


def is_interrupted(obj):
    """Whether a bake with the settings of an object left a checkpoint and did not end."""
    return bake.checkpoint_path(obj).is_file()


CLASSES = (LEAFLIGHT_OT_resume_bake,)
