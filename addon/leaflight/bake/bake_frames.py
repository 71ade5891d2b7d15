# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake All Frames: one bake for each frame of a volume that changes over time."""

import bpy

from .. import versions
from ..operators import background, checks
from ..operators.checks import active_volume
from ..show import isovalues
from . import bake


class LEAFLIGHT_OT_bake_frames(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.bake_frames"
    bl_label = "Bake All Frames"
    bl_description = (
        "Bake every frame of the volume, one after the other, each in the scene as it is when the "
        "animation shows that frame. Esc ends it; the frames that are done stay"
    )
    conditions = (
        *bake.LEAFLIGHT_OT_bake.conditions,
        checks.needs(
            lambda context: active_volume(context).leaflight.frames > 1,
            "The file of this volume holds one frame",
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
    """Shows each frame of a volume of the present scene once, and yields its number.

    Volume and scene are looked up anew for each: undo may replace them meanwhile.
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


CLASSES = (LEAFLIGHT_OT_bake_frames,)
