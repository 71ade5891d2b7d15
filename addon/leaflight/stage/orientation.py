# SPDX-License-Identifier: GPL-3.0-or-later
"""The axes of a volume that point up and to the viewer: Object.leaflight_orientation.

The object's transform gives the axis that points up. The front is stored as a property, because a
stage turns to the front of a patient.
"""

import bpy
import numpy as np
from mathutils import Matrix

from ..operators import checks, jobs
from ..operators.checks import active_volume
from ..props import BoolProperty, EnumProperty, IntProperty, PointerProperty
from ..show import isosurfaces, isovalues
from ..store import cache, source_files
from . import stage
from .facing import (
    AXES,
    FRONT,
    ITEMS,
    NAMES,
    PATIENTS_FRONT,
    along,
    scaled,
    vector,
    with_front,
    with_up,
)

UP_TEXT = "Axis of the volume that points up"
FRONT_TEXT = "Axis of the volume that points to the viewer of a stage"


def _up(group):
    heights = np.array(group.id_data.matrix_world, np.float64)[2, :3] @ np.array([*AXES.values()]).T
    return int(np.argmax(heights))


def _chooser(turned):
    """Returns a function that sets an axis. turned: with_up() or with_front()."""

    def choose(group, number):
        up, front = _axes_of(group)
        if turned(up, front, vector(number)) == (up, front):
            group.is_unknown = False
        else:
            _turn(group.id_data, *turned(up, front, vector(number)))

    return choose


def _axes_of(group):
    """Returns (up, front), at a right angle even after the user has rotated the volume."""
    up, front = vector(_up(group)), vector(group.front_axis)
    if along(up, front):
        front = AXES[FRONT] if not along(up, AXES[FRONT]) else AXES["NEG_X"]
    return up, front


class LeaflightOrientation(bpy.types.PropertyGroup):
    up: EnumProperty("Up", UP_TEXT, ITEMS, get=_up, set=_chooser(with_up))
    front: EnumProperty(
        "Front", FRONT_TEXT, ITEMS, get=lambda group: group.front_axis, set=_chooser(with_front)
    )
    front_axis: IntProperty("Number of the Front", default=NAMES.index(FRONT))
    is_unknown: BoolProperty("No Orientation in the File or Chosen")


_WAYS = [
    ("TIP", "Tip", "Turn the top towards the viewer"),
    ("ROLL", "Roll", "Turn the top to the viewer's right"),
    ("TURN", "Turn", "Turn the front to the viewer's right"),
]


class LEAFLIGHT_OT_turn_volume(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Turn 90 Degrees"
    bl_description = "Turn the volume by 90 degrees as the viewer of a stage sees it"
    conditions = (jobs.is_free, *checks.VOLUME)

    way: EnumProperty("Way", items=_WAYS)

    @classmethod
    def description(cls, _context, properties):
        texts = {key: text for key, _, text in _WAYS}
        return texts[properties.way]

    def run(self, context):
        obj = active_volume(context)
        was_lit = bool(obj.leaflight.bake_id)
        orientation = obj.leaflight_orientation
        up, front = _axes_of(orientation)
        left = tuple(np.cross(front, up).tolist())
        # New (up, front) of each way.
        axes = {"TIP": (scaled(front, -1), up), "ROLL": (left, front), "TURN": (up, left)}
        _turn(obj, *axes[self.way])
        if was_lit:
            self.report({"INFO"}, "The volume was turned since its bake: bake again")


def begin(obj, is_patient, up, front):
    """Orients a volume after its import.

    up, front: keys of AXES, or empty for the axes of the file.
    """
    orientation = obj.leaflight_orientation
    orientation.front_axis = NAMES.index(PATIENTS_FRONT if is_patient else FRONT)
    orientation.is_unknown = not (is_patient or up or front)
    up_axis, front_axis = _axes_of(orientation)
    if up:
        up_axis, front_axis = with_up(up_axis, front_axis, AXES[up])
    if front:
        up_axis, front_axis = with_front(up_axis, front_axis, AXES[front])
    if up or front:
        orient(obj, up_axis, front_axis)


def take_over(obj, other):
    """Gives a volume the front of another volume, to which it is registered."""
    obj.leaflight_orientation.front_axis = other.leaflight_orientation.front_axis


def _turn(obj, up, front):
    """Orients a volume, and builds its stage again if it has one. Waits for the volumes' files."""
    with cache.waiting():
        orient(obj, up, front)
        if obj.leaflight.is_volume:
            stage.follow(bpy.context, obj)


def orient(obj, up, front):
    """Rotates a volume so that the axis `up` points up and the axis `front` to -y.

    up, front: (3,), at a right angle. The box of the volume keeps its place on the floor. Volumes
    that are registered to it and its clip boxes rotate with it.
    """
    bpy.context.view_layer.update()
    before = obj.matrix_world.copy()
    others = _turning_with(obj)
    low, high = isosurfaces.world_box(obj)
    for volume in (obj, *others):
        volume.leaflight_orientation.front_axis = [*AXES.values()].index(front)
        volume.leaflight_orientation.is_unknown = False
    turn = Matrix([np.cross(up, front).tolist(), scaled(front, -1), up])
    obj.matrix_world = turn.to_4x4() @ Matrix.Diagonal((*before.to_scale(), 1.0))
    bpy.context.view_layer.update()
    new_low, new_high = isosurfaces.world_box(obj)
    shift = 0.5 * (low + high - new_low - new_high)
    shift[2] = low[2] - new_low[2]
    obj.matrix_world = Matrix.Translation(shift) @ obj.matrix_world
    change = obj.matrix_world @ before.inverted()
    boxes = {volume.leaflight_look.box for volume in (obj, *others)} - {None}
    for other in (*others, *(box for box in boxes if box.parent is None)):
        other.matrix_world = change @ other.matrix_world
    bpy.context.view_layer.update()


def _turning_with(obj):
    """Returns the other volumes whose files have the same coordinates as that of a volume."""
    volumes = {other for scene in obj.users_scene for other in isovalues.volumes(scene)}
    return [o for o in volumes - {obj} if o.parent is None and _is_same_space(o, obj)]


def _is_same_space(*objects):
    """True if the coordinates of the files of two volumes have the same place in the world."""
    one, other = map(source_files.place_of_file, objects)
    return np.allclose(one, other, rtol=1e-6, atol=1e-6 * np.abs(one).max())


PROPERTIES = ((bpy.types.Object, "leaflight_orientation", PointerProperty(LeaflightOrientation)),)
