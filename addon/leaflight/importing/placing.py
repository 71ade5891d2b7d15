# SPDX-License-Identifier: GPL-3.0-or-later
"""How large an imported volume is, and where it stands: its object's transform alone.

Vertices keep the axes and the unit of the file, for patients right, front and up. The origin of the
object is the middle of the volume, whose place in the file it keeps.
"""

import numpy as np
from leaflight import LeaflightError
from leaflight.io.readers import METERS
from mathutils import Matrix

from ..operators.checks import active_volume
from ..show import isosurfaces
from ..store import cache, source_files

SIZE_ITEMS = [
    (
        "AUTO",
        "Automatic",
        "As large as Size says, on the floor: the first volume at the origin, another one beside "
        "those that are there, or over one of the same patient",
    ),
    ("FIT", "Fit", "As large as Size says, on the floor at the origin"),
    (
        "LIFE",
        "Life Size",
        "One meter of the file is one meter in Blender, at the file's own coordinates: scans of "
        "one patient then lie over each other",
    ),
    (
        "SAME",
        "Together With",
        "At the scale and the place of a volume that was imported before, so that scans of one "
        "patient lie over each other",
    ),
]
# What a file without a unit is taken to measure in.
USUAL = "mm"
# Blender's coordinates are single precision, and its views clip what is smaller.
SMALLEST = 1e-4
# Between volumes that stand beside each other, in longest sides of the new one.
GAP = 0.15
# Meshes so many times as large as a volume are rooms in which it stands.
_ROOM = 2.0


def meters(unit):
    return METERS[unit or USUAL]


def check(context, mode, partner):
    """Raises LeaflightError where there is no volume to go together with."""
    if mode == "SAME" and not _is_volume(context.scene.objects.get(partner)):
        raise LeaflightError(
            f'Together With: "{partner}" is no Leaflight volume of this scene: choose one, or '
            "another way to find the size."
        )


def place(context, obj, volume, mode, partner):
    """Puts a volume that was fitted to the floor where LIFE or SAME says. Raises LeaflightError.

    partner: name of the volume that it goes together with.
    """
    unit = meters(obj.leaflight.unit)
    if mode == "LIFE":
        scale = unit / context.scene.unit_settings.scale_length
        side = scale * longest_side(volume)
        if side < SMALLEST:
            raise LeaflightError(
                f"{volume.source}: in life size it would be {side:.2g} m long, too small for "
                "Blender: choose Fit."
            )
        obj.matrix_world = Matrix.Scale(scale, 4) @ Matrix.Translation(obj.leaflight.origin)
    elif mode == "SAME":
        other = context.scene.objects[partner]
        ratio = unit / meters(other.leaflight.unit)
        matrix = source_files.place_of_file(other) @ np.diag([ratio, ratio, ratio, 1.0])
        matrix[:3, 3] += matrix[:3, :3] @ np.array(obj.leaflight.origin, np.float64)
        obj.matrix_world = Matrix(matrix.tolist())


def registered(context, obj, is_patient):
    """The name of a volume of the same space, by what both headers say; empty for none."""
    if not is_patient:
        return ""
    for name in volume_names(context):
        other = context.scene.objects[name]
        if other != obj and source_files.is_patient(other.leaflight) and _overlap(obj, other):
            return name
    return ""


def _overlap(obj, other):
    """Whether the boxes of two volumes have a place in common, in their patients' coordinates."""
    boxes = []
    for one in (obj, other):
        box = np.asarray(cache.volume_of(one).field().bounds, np.float64) + one.leaflight.origin
        boxes.append(box * meters(one.leaflight.unit))
    (low, high), (other_low, other_high) = boxes
    return bool(np.all(low <= other_high) and np.all(other_low <= high))


def put_beside(context, obj):
    """Moves a volume to the right of all others of the scene, in line with their middle; without
    others, of the meshes that would hide it, such as the cube of Blender's first scene."""
    context.view_layer.update()
    own_low, own_high = isosurfaces.world_box(obj)
    names = volume_names(context)
    others = [context.scene.objects[name] for name in names if name != obj.name]
    boxes = [isosurfaces.world_box(other) for other in others]
    boxes = boxes or _boxes_around(context, own_low, own_high)
    if not boxes:
        return
    low, high = np.min(boxes, axis=(0, 1)), np.max(boxes, axis=(0, 1))
    if not others:
        low[2] = own_low[2]  # the floor
    gap = GAP * float(np.max(own_high - own_low))
    shift = 0.5 * (low + high) - 0.5 * (own_low + own_high)
    shift[0], shift[2] = high[0] + gap - own_low[0], low[2] - own_low[2]
    obj.matrix_world = Matrix.Translation(shift) @ obj.matrix_world


def _boxes_around(context, low, high):
    """Lowest and highest corner (2, 3) of each visible mesh about as large as a box, within which
    it stands in part; rooms are larger."""
    boxes = []
    # Those that it merely touches do not hide it.
    margin = 1e-4 * (high - low)
    low, high = low + margin, high - margin
    for other in context.visible_objects:
        if other.type != "MESH" or _is_volume(other):
            continue
        matrix = np.array(other.matrix_world, np.float64)
        corners = np.array(other.bound_box) @ matrix[:3, :3].T + matrix[:3, 3]
        box = np.array([corners.min(axis=0), corners.max(axis=0)])
        is_as_large = np.max(box[1] - box[0]) < _ROOM * np.max(high - low)
        if is_as_large and np.all(low < box[1]) and np.all(box[0] < high):
            boxes.append(box)
    return boxes


def longest_side(volume):
    low, high = np.asarray(volume.field().bounds, np.float64)
    return float((high - low).max())


def volume_names(context):
    """Of the volumes that one can go together with, the active one first."""
    names = [obj.name for obj in context.scene.objects if _is_volume(obj)]
    active = active_volume(context)
    if active is not None and active.name in names:
        names.remove(active.name)
        names.insert(0, active.name)
    return names


def _is_volume(obj):
    return obj is not None and obj.leaflight.is_volume
