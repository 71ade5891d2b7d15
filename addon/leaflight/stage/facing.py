# SPDX-License-Identifier: GPL-3.0-or-later
"""The axes of a volume, and the direction from which the camera of a stage looks at it.

The camera stands at three quarters of the front, slightly above.
"""

import math

import numpy as np

_ROWS = [
    ("POS_X", "+X", "To the right of a patient", (1, 0, 0)),
    ("NEG_X", "-X", "To the left of a patient", (-1, 0, 0)),
    ("POS_Y", "+Y", "To the front of a patient", (0, 1, 0)),
    ("NEG_Y", "-Y", "To the back of a patient", (0, -1, 0)),
    ("POS_Z", "+Z", "To the head of a patient; the slice axis of most files", (0, 0, 1)),
    ("NEG_Z", "-Z", "To the feet of a patient", (0, 0, -1)),
]
ITEMS = [row[:3] for row in _ROWS]
AXES = {row[0]: row[3] for row in _ROWS}
NAMES = list(AXES)

# Front axis of volumes without an orientation, and of patients. Readers store a patient's axes as
# right, front and up.
FRONT, PATIENTS_FRONT = "NEG_Y", "POS_Y"

# Angle from the front to the viewer's right. The light comes from the left.
THREE_QUARTERS = math.radians(35.0)
ELEVATION = math.radians(10.0)


def direction(obj):
    """Returns the direction to the camera of a stage, in radians counterclockwise from -y.

    The front is rounded to the nearest quarter turn.
    """
    front = np.array(obj.matrix_world, np.float64)[:3, :3] @ front_of(obj)
    if math.hypot(front[0], front[1]) < 1e-3 * np.linalg.norm(front):
        return THREE_QUARTERS
    quarters = round((math.degrees(math.atan2(front[1], front[0])) + 90.0) / 90.0) % 4
    return math.radians(90.0) * quarters + THREE_QUARTERS


def vector(number):
    """Returns the axis (3,) at an index of NAMES."""
    return AXES[NAMES[number]]


def front_of(obj):
    """Returns the axis (3,), in the object's coordinates, that faces the viewer."""
    return vector(obj.leaflight_orientation.front_axis)


def with_up(up, front, new):
    """Returns (up, front), each an axis (3,), with another axis up.

    If the new axis was the front or the back, the volume is tipped over.
    """
    toward = along(new, front)
    return new, scaled(up, -toward) if toward else front


def with_front(up, front, new):
    """Returns (up, front) with another axis in front.

    If the new axis pointed up or down, the volume is tipped over.
    """
    toward = along(new, up)
    return scaled(front, -toward) if toward else up, new


def along(a, b):
    return sum(x * y for x, y in zip(a, b))


def scaled(axis, factor):
    return tuple(factor * x for x in axis)
