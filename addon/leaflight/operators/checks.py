# SPDX-License-Identifier: GPL-3.0-or-later
"""Conditions that several operators share, each with the reason that a greyed button shows."""


def in_object_mode(operator, context):
    if context.mode != "OBJECT":
        operator.poll_message_set("Leave Edit Mode first")
        return False
    return True


def has_volume(operator, context):
    obj = context.object
    if obj is None or not obj.leaflight.is_volume:
        operator.poll_message_set(
            "Select a Leaflight volume first (File > Import > Volume for Leaflight)"
        )
        return False
    return in_object_mode(operator, context)


class VolumeOperator:
    """An operator on the volume that is active."""

    @classmethod
    def poll(cls, context):
        return has_volume(cls, context)


def has_flatland(operator, context):
    obj = context.object
    if obj is None or not obj.leaflight_flat.is_flatland:
        operator.poll_message_set(
            "Select the graph of an image first (File > Import > Image for Leaflight)"
        )
        return False
    return in_object_mode(operator, context)


def has_bake(operator, context):
    if not has_volume(operator, context):
        return False
    if not context.object.leaflight.bake_id:
        operator.poll_message_set("Bake the flattened illumination first")
        return False
    return True
