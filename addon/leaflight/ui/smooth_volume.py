# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""Smooth: reads the volume again, under a Gaussian, against noise and terraces."""

import bpy
from bpy.props import EnumProperty

from ..operators import background, checks
from ..operators.active_volume import active_volume
from ..show import added, isovalues
from ..store import cache, source_files


class SmoothJob(background.Job):
    """Reads the file of a volume object again, smoothed by so many voxels."""

    name = "Smooth"
    cancelled = "Smoothing was cancelled; nothing has changed"

    def __init__(self, obj, smooth):
        self._name, self._smooth = obj.name, smooth
        self._path = source_files.path_of(obj.leaflight)
        self._choices = {**source_files.choices_of(obj.leaflight), "smooth": smooth}

    def run(self, progress):
        self._volume = source_files.read_volume(self._path, progress=progress, **self._choices)

    def apply(self):
        obj = bpy.data.objects.get((self._name, None))
        if obj is None or not obj.leaflight.is_volume:
            return self.cancelled
        settings, volume = obj.leaflight, self._volume
        # Stored before the setting's update looks it up.
        settings["smooth"] = self._smooth
        cache.keep_volume(obj, volume.capped() if settings.capped else volume)
        settings.smooth = self._smooth
        for surface in (obj, *added.added_to(obj)):
            isovalues.limit(surface)
        cache.forget_unused()
        return f"{obj.name}: smoothed by {self._smooth:g} voxels"


class LEAFLIGHT_OT_smooth(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.smooth"
    bl_label = "Smooth"
    bl_description = (
        "Smooth the values by a Gaussian, against noise and against terraces of 8-bit values. A "
        "bake keeps the values that it was made of: bake again after a change"
    )
    bl_options = {"REGISTER", "UNDO"}

    amount: EnumProperty(
        name="Smooth",
        items=[
            ("0", "Not Smoothed", "The values of the file"),
            ("0.5", "By 0.5 Voxels", "Standard deviation of the Gaussian"),
            ("1", "By 1 Voxel", "Standard deviation of the Gaussian: right for most 8-bit scans"),
            ("1.5", "By 1.5 Voxels", "Standard deviation of the Gaussian"),
            ("2", "By 2 Voxels", "Standard deviation of the Gaussian"),
            ("3", "By 3 Voxels", "Standard deviation of the Gaussian"),
        ],
        default="1",
    )

    @classmethod
    def poll(cls, context):
        if not (cls.is_free() and checks.has_volume(cls, context)):
            return False
        volume = active_volume(context)
        if volume.library is not None or not volume.leaflight.source:
            cls.poll_message_set("The volume has no file of its own here: import it")
            return False
        return True

    def start(self, context):
        return SmoothJob(active_volume(context), float(self.amount))


def register():
    bpy.utils.register_class(LEAFLIGHT_OT_smooth)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_OT_smooth)
