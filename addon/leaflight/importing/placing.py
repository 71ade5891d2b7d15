# SPDX-License-Identifier: GPL-3.0-or-later
"""Size and place of an imported volume, which only its object's transform changes.

Vertices keep the axes and the unit of the file; for patients the axes are right, front and up. The
origin of the object is the middle of the volume.
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
        "Given size, on the floor: the first volume at the origin, others beside it, "
        "or over a scan of the same patient",
    ),
    ("FIT", "Fit", "Given size, on the floor at the origin"),
    (
        "LIFE",
        "Life Size",
        "Real size (one meter of the file is one meter in Blender), at the file's "
        "coordinates, so that scans of one patient align",
    ),
    (
        "SAME",
        "Together With",
        "Scale and position of another volume, so that scans of one patient align",
    ),
]
# Assumed unit of a file without one.
USUAL = "mm"
# Smallest side in meters. Blender has single precision, and viewports clip smaller objects.
SMALLEST = 1e-4
# Gap between volumes, as a share of the longest side of the new one.
GAP = 0.15
# Size of a mesh, relative to a volume, from which it counts as a room around the volume.
_ROOM = 2.0


def meters(unit):
    return METERS[unit or USUAL]


def check(context, mode, partner):
    """Raises LeaflightError if SAME has no volume as its partner."""
    if mode == "SAME" and not _is_volume(context.scene.objects.get(partner)):
        raise LeaflightError(
            f'Together With: "{partner}" is not a Leaflight volume of this scene: choose one, or '
            "another Size From."
        )


def place(context, obj, volume, mode, partner):
    """Scales and moves a volume for LIFE or SAME. Raises LeaflightError.

    partner: name of the volume that gives SAME its scale and place.
    """
    unit = meters(obj.leaflight.unit)
    if mode == "LIFE":
        scale = unit / context.scene.unit_settings.scale_length
        side = scale * longest_side(volume)
        if side < SMALLEST:
            raise LeaflightError(
                f"{volume.source}: Life Size would be {side:.2g} m, too small for Blender: choose "
                "Fit."
            )
        obj.matrix_world = Matrix.Scale(scale, 4) @ Matrix.Translation(obj.leaflight.origin)
    elif mode == "SAME":
        other = context.scene.objects[partner]
        ratio = unit / meters(other.leaflight.unit)
        matrix = source_files.place_of_file(other) @ np.diag([ratio, ratio, ratio, 1.0])
        matrix[:3, 3] += matrix[:3, :3] @ np.array(obj.leaflight.origin, np.float64)
        obj.matrix_world = Matrix(matrix.tolist())


def registered(context, obj, is_patient):
    """Returns the name of a volume of the same patient space by both headers, or empty."""
    if not is_patient:
        return ""
    for name in volume_names(context):
        other = context.scene.objects[name]
        if other != obj and source_files.is_patient(other.leaflight) and _overlap(obj, other):
            return name
    return ""


def _overlap(obj, other):
    """True if the boxes of two volumes overlap in their patients' coordinates."""
    boxes = []
    for one in (obj, other):
        box = np.asarray(cache.volume_of(one).field().bounds, np.float64) + one.leaflight.origin
        boxes.append(box * meters(one.leaflight.unit))
    (low, high), (other_low, other_high) = boxes
    return bool(np.all(low <= other_high) and np.all(other_low <= high))


def put_beside(context, obj):
    """Moves a volume to the right of all other volumes of the scene, in line with their middle.

    Without other volumes, it moves beside meshes that would hide it, such as the default cube.
    """
    context.view_layer.update()
    own_low, own_high = isosurfaces.world_box(obj)
    names = volume_names(context)
    others = [context.scene.objects[name] for name in names if name != obj.name]
    boxes = [_box_of(other) for other in others]
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


def _box_of(volume):
    """Returns the box (2, 3) of a volume, or of its isosurface if its file is gone."""
    try:
        return isosurfaces.world_box(volume)
    except LeaflightError:
        return _box_of_mesh(volume)


def _box_of_mesh(obj):
    matrix = np.array(obj.matrix_world, np.float64)
    corners = np.array(obj.bound_box) @ matrix[:3, :3].T + matrix[:3, 3]
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def _boxes_around(context, low, high):
    """Returns the boxes [(2, 3), ...] of visible meshes that overlap a box.

    Meshes that are much larger than the box count as rooms and are left out.
    """
    boxes = []
    # Leave out meshes that only touch the box, because they do not hide it.
    margin = 1e-4 * (high - low)
    low, high = low + margin, high - margin
    for other in context.visible_objects:
        if other.type != "MESH" or _is_volume(other):
            continue
        box = _box_of_mesh(other)
        is_as_large = np.max(box[1] - box[0]) < _ROOM * np.max(high - low)
        if is_as_large and np.all(low < box[1]) and np.all(box[0] < high):
            boxes.append(box)
    return boxes


def longest_side(volume):
    low, high = np.asarray(volume.field().bounds, np.float64)
    return float((high - low).max())


def volume_names(context):
    """Returns the names of the volumes of the scene, the active one first."""
    names = [obj.name for obj in context.scene.objects if _is_volume(obj)]
    active = active_volume(context)
    if active is not None and active.name in names:
        names.remove(active.name)
        names.insert(0, active.name)
    return names


def _is_volume(obj):
    return obj is not None and obj.leaflight.is_volume
