# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume that panels and operators work on, and the base classes of operators."""

from collections.abc import Callable
from typing import Any

import bpy
from leaflight import LeaflightError

from ..store import cache

# Function that is true if an operator can be called. Otherwise it sets the reason for its button.
Condition = Callable[[Any, bpy.types.Context], bool]


def active_volume(context: bpy.types.Context) -> bpy.types.Object | None:
    """Returns the active object if it is a volume, else the last active one, else any or None."""
    obj, scene = context.object, context.scene
    if obj is not None and obj.leaflight.is_volume:
        return obj
    last = scene.objects.get(scene.leaflight.active_volume)
    if last is not None and last.leaflight.is_volume:
        return last
    return next((one for one in scene.objects if one.leaflight.is_volume), None)


def remember_active(scene: bpy.types.Scene, obj: bpy.types.Object | None) -> None:
    """Stores the active object of a scene if it is a volume."""
    if obj is None or not obj.leaflight.is_volume or scene.library is not None:
        return
    # Store the name, because a pointer would keep a deleted volume in the file.
    if scene.leaflight.active_volume != obj.name:
        scene.leaflight.active_volume = obj.name


def needs(holds: Callable[[bpy.types.Context], Any], reason: str) -> Condition:
    """Returns a Condition from a function of the context, with the reason if it is false."""

    def condition(operator: Any, context: bpy.types.Context) -> bool:
        if holds(context):
            return True
        operator.poll_message_set(reason)
        return False

    return condition


def volume_needs(holds: Callable[[bpy.types.Object], Any], reason: str) -> Condition:
    """Returns needs() with a function of the active volume."""
    return needs(lambda context: holds(active_volume(context)), reason)


in_object_mode = needs(lambda context: context.mode == "OBJECT", "Leave Edit Mode first")

VOLUME: tuple[Condition, ...] = (
    needs(active_volume, "Select or import a volume first (File > Import > Volume for Leaflight)"),
    in_object_mode,
)
BAKE = (
    *VOLUME,
    volume_needs(lambda volume: volume.leaflight.bake_id, "Bake this volume first"),
)


class LeaflightOperator:
    """An operator whose run() does its work. A LeaflightError becomes a report.

    A script waits for files that are being read. A user gets a report.
    The class LEAFLIGHT_OT_x is the operator leaflight.x.
    conditions: without which it cannot be called.
    """

    bl_options: Any = {"REGISTER", "UNDO"}
    conditions: tuple[Condition, ...] = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.bl_idname = cls.__name__.lower().replace("_ot_", ".")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return all(holds(cls, context) for holds in cls.conditions)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            with cache.waiting(not self.options.is_invoke):
                self.run(context)
        except LeaflightError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class VolumeOperator(LeaflightOperator):
    """An operator on the volume that is active, or was last."""

    conditions = VOLUME
