# SPDX-License-Identifier: GPL-3.0-or-later
"""From where a volume is looked at: three quarters from its front, slightly from above."""

import math

import numpy as np

from . import orientation

# From the front towards the viewer's right, where the light comes from the left.
THREE_QUARTERS = math.radians(35.0)
ELEVATION = math.radians(10.0)


def direction(obj):
    """The way to the camera of a stage, in radians counterclockwise from -y.

    A front that stands askew is taken to be its nearest quarter.
    """
    front = np.array(obj.matrix_world, np.float64)[:3, :3] @ orientation.front_of(obj)
    if math.hypot(front[0], front[1]) < 1e-3 * np.linalg.norm(front):
        return THREE_QUARTERS
    quarters = round((math.degrees(math.atan2(front[1], front[0])) + 90.0) / 90.0) % 4
    return math.radians(90.0) * quarters + THREE_QUARTERS
