# SPDX-License-Identifier: GPL-3.0-or-later
"""Animations in one click: isovalue sweep, turntable, and wipes of the picture or the data."""

import math

import bpy
import mathutils
import numpy as np
from leaflight import LeaflightError, blender
from leaflight.volume.regions import Box, record_of

from .. import versions
from ..operators import checks
from ..operators.checks import active_volume
from ..props import EnumProperty, IntProperty
from ..show import display, isosurfaces, isovalues
from ..stage import camera as stage_camera
from ..store import frame_bakes, source_files

_PIVOT = "leaflight_turntable"
# Name of the cut of a lit wipe, in place of a clip box.
_CUT_NAME = "Lit Wipe"
# Step in degrees between tested camera positions, and view in degrees to each side of the volume.
_STEP, _BESIDE = 5, 28


class LEAFLIGHT_OT_animate(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Animate"
    bl_description = "Keyframe an animation of the volume"

    kind: EnumProperty(
        "Animation",
        items=[
            ("SWEEP", "Sweep", "Isovalue from the lowest to the highest of its range"),
            (
                "TURNTABLE",
                "Turntable",
                "Camera once around the volume, or back and forth between walls",
            ),
            ("WIPE", "Wipe", "Clip box through the volume from one side to the other"),
            (
                "LIT_WIPE",
                "Lit Wipe",
                "Cut of the data through the isosurface from one side to the other. Bake All "
                "Frames lights each frame; before, light near the cut is an estimate",
            ),
        ],
    )
    frames: IntProperty("Frames", "Length of the animation", 120, min=2)

    def run(self, context):
        _ANIMATIONS[self.kind](context, active_volume(context), self.frames)


def _sweep(context, volume, frames):
    low, high = isovalues.isovalue_range(volume.leaflight)
    blender.animate(volume, np.linspace(low, high, frames))


def _turntable(context, volume, frames):
    scene = context.scene
    camera = scene.camera
    if camera is None:
        raise LeaflightError("The scene has no camera: add one, or use Stage.")
    pivot = camera.parent
    if pivot is None or _PIVOT not in pivot:
        middle = isosurfaces.world_box(volume).mean(axis=0)
        pivot = bpy.data.objects.new("Turntable", None)
        pivot[_PIVOT] = True
        pivot.location = middle
        scene.collection.objects.link(pivot)
        place = camera.matrix_world.copy()
        camera.parent = pivot
        camera.matrix_parent_inverse = mathutils.Matrix.Translation(middle).inverted()
        camera.matrix_basis = place
    pivot.animation_data_clear()
    free = _free_degrees(context, volume, camera, pivot)
    if free >= 180:
        # The frame after the last equals the first.
        angles = np.linspace(0, 360, frames + 1)[:-1]
    else:
        angles = free * np.sin(np.linspace(0, 2 * np.pi, frames + 1)[:-1])
    _keyframe(pivot, "rotation_euler", [(0.0, 0.0, math.radians(a)) for a in angles], scene)


def _free_degrees(context, volume, camera, pivot):
    """Returns the degrees that the camera may move to each side.

    On the way nothing comes between camera and volume. A backdrop behind the volume stays there.
    """
    depsgraph = context.evaluated_depsgraph_get()
    middle = pivot.location
    arm = camera.matrix_world.translation - middle
    low, high = isosurfaces.world_box(volume)
    radius = 0.5 * float(np.linalg.norm(high - low))

    def cast(start, direction, **limit):
        hit, _, _, _, obj, _ = context.scene.ray_cast(depsgraph, start, direction, **limit)
        return hit and display.volume_object(obj) != volume

    def is_free(degrees):
        place = middle + _turned(arm, degrees)
        return not cast(place, middle - place, distance=arm.length)

    def is_before_something(degrees):
        directions = [-_turned(arm, degrees + side) for side in (-_BESIDE, 0, _BESIDE)]
        level = [
            mathutils.Vector((direction.x, direction.y, 0.0)).normalized()
            for direction in directions
        ]
        return all(cast(middle + radius * direction, direction) for direction in level)

    has_backdrop = is_before_something(0)
    free = 0
    for degrees in range(_STEP, 180 + _STEP, _STEP):
        for angle in (degrees, -degrees):
            if not is_free(angle) or (has_backdrop and not is_before_something(angle)):
                return free
        free = degrees
    return free


def _turned(vector, degrees):
    return mathutils.Matrix.Rotation(math.radians(degrees), 3, "Z") @ vector


def _wipe(context, volume, frames):
    """Animates the clip box across the camera's picture, through the whole volume."""
    look = volume.leaflight_look
    if look.box is None or not look.box.users_scene:
        bpy.ops.leaflight.add_clip_box()
    box = look.box
    if box.type != "EMPTY":
        raise LeaflightError(
            f'The clip box "{box.name}" is a mesh, but the animation moves only an Empty: choose '
            "one."
        )
    low, high = isosurfaces.world_box(volume)
    half, middle = 0.5 * (high - low), 0.5 * (low + high)
    axis, sign = _across(context.scene)
    step = np.zeros(3)
    step[axis] = 2.1 * half[axis] * sign
    box.animation_data_clear()
    # Extend the box beyond the volume, so that no face lies on its border.
    box.matrix_world = mathutils.Matrix.LocRotScale(
        mathutils.Vector(middle), None, mathutils.Vector(1.05 * half / box.empty_display_size)
    )
    places = [tuple(middle - step * (1 - t)) for t in np.linspace(0, 1, frames)]
    _keyframe(box, "location", places, context.scene)


# Share of the isosurface that is cut away in the last frame of a lit wipe.
_CUT_AWAY = 0.8


def _lit_wipe(context, volume, frames):
    """Makes each frame a cut of the data, whose plane moves across the camera's picture."""
    settings, scene = volume.leaflight, context.scene
    if not settings.source or volume.library is not None:
        raise LeaflightError(f'"{volume.name}" has no volume file to cut: import it.')
    if settings.frames > 1 and not settings.frame_regions:
        raise LeaflightError(
            f'"{volume.name}" changes over time: use Wipe, which cuts the picture.'
        )
    if settings.frame_regions:
        frame_bakes.end_wipe(settings)
    others = [r for r in source_files.regions_of(settings) if r.get("object") != _CUT_NAME]
    axis, sign = _across(scene)
    points = stage_camera.shown_points([volume])
    first, last = points[:, axis].min(), points[:, axis].max()
    ends = isosurfaces.world_box(volume)
    middle, reach = ends.mean(axis=0), np.ptp(ends, axis=0)
    to_file = np.linalg.inv(source_files.place_of_file(volume))
    regions = []
    for share in np.linspace(0.0, _CUT_AWAY, frames):
        low, high = middle - reach, middle + reach
        cut = share * (last - first)
        if sign > 0:
            high[axis] = first + cut
        else:
            low[axis] = last - cut
        box = record_of(Box.between(low, high, "outside").moved(to_file))
        regions.append([*others, {**box, "object": _CUT_NAME, "on": True}])
    frame_bakes.begin_wipe(settings, regions)
    scene.frame_start, scene.frame_end = 1, frames
    blender.animate_frames(volume, 1)
    scene.frame_set(1)


def _across(scene):
    """Returns the axis of the world that points most to the right of the picture, and its sign."""
    across = scene.camera.matrix_world.col[0][:3] if scene.camera else (1.0, 0.0, 0.0)
    axis = int(np.argmax(np.abs(across)))
    return axis, 1.0 if across[axis] > 0 else -1.0


def _keyframe(obj, path, values, scene):
    """Inserts a keyframe for each value from frame 1, and sets the scene's frame range."""
    for frame, value in enumerate(values, start=1):
        setattr(obj, path, value)
        obj.keyframe_insert(path, frame=frame)
    for curve in versions.fcurves(obj):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    scene.frame_start, scene.frame_end = 1, len(values)
    scene.frame_set(1)


_ANIMATIONS = {"SWEEP": _sweep, "TURNTABLE": _turntable, "WIPE": _wipe, "LIT_WIPE": _lit_wipe}
