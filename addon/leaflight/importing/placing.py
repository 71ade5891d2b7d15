# SPDX-License-Identifier: GPL-3.0-or-later
"""How large an imported volume is, and where it stands: its object's transform alone.

Vertices keep the coordinates of the file, for patients right, front and up, so that volumes of one
file's space stay registered to each other wherever their objects have the same transform.
"""

import leaflight
import numpy as np
from leaflight.io.readers import METERS
from mathutils import Matrix

LeaflightError = leaflight.LeaflightError

SIZE_ITEMS = [
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
    """Puts a volume that was fitted to the floor where another mode says. Raises LeaflightError.

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
        obj.matrix_world = Matrix.Scale(scale, 4)
    elif mode == "SAME":
        other = context.scene.objects[partner]
        ratio = unit / meters(other.leaflight.unit)
        obj.matrix_world = other.matrix_world @ Matrix.Scale(ratio, 4)


def longest_side(volume):
    low, high = np.asarray(volume.field().bounds, np.float64)
    return float((high - low).max())


def volume_names(context):
    """Of the volumes that one can go together with, the active one first."""
    names = [obj.name for obj in context.scene.objects if _is_volume(obj)]
    active = context.object
    if active is not None and active.name in names:
        names.remove(active.name)
        names.insert(0, active.name)
    return names


def _is_volume(obj):
    return obj is not None and obj.leaflight.is_volume
