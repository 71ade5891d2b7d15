# SPDX-License-Identifier: GPL-3.0-or-later
"""Conditions that several operators share, each with the reason that a greyed button shows."""

from typing import Any

import bpy

from .active_volume import active_volume


def in_object_mode(operator: Any, context: bpy.types.Context) -> bool:
    if context.mode != "OBJECT":
        operator.poll_message_set("Leave Edit Mode first")
        return False
    return True


def has_volume(operator: Any, context: bpy.types.Context) -> bool:
    if active_volume(context) is None:
        operator.poll_message_set(
            "Select or import a volume first (File > Import > Volume for Leaflight)"
        )
        return False
    return in_object_mode(operator, context)


class VolumeOperator:
    """An operator on the volume that is active, or was last."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_volume(cls, context)


def has_flatland(operator: Any, context: bpy.types.Context) -> bool:
    obj = context.object
    if obj is None or not obj.leaflight_flat.is_flatland:
        operator.poll_message_set(
            "Select the graph of an image first (File > Import > Image for Leaflight)"
        )
        return False
    return in_object_mode(operator, context)


def has_bake(operator: Any, context: bpy.types.Context) -> bool:
    if not has_volume(operator, context):
        return False
    if not active_volume(context).leaflight.bake_id:
        operator.poll_message_set("Bake the flattened illumination first")
        return False
    return True
