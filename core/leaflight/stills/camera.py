# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera, and where to put one."""

import json
import math
from dataclasses import asdict, dataclass
from numbers import Real

import numpy as np

from .._core import LeaflightError
from ..io.json_object import read_text

# Of view, across the picture's shorter side: a portrait's lens, as of the add-on's stages.
ANGLE = 26.0
# From the front, a little from above.
VIEW = (0.0, 20.0)


@dataclass(frozen=True)
class Camera:
    """Sees in perspective. position, target: world; up: a direction that shall be upright.

    angle: of view, across the shorter side of the picture, in degrees.
    """

    position: tuple
    target: tuple
    up: tuple = (0.0, 0.0, 1.0)
    angle: float = ANGLE

    def axes(self):
        """Unit vectors to the right, up and forward: (3, 3)."""
        forward = _unit(np.subtract(self.target, self.position))
        right = np.cross(forward, self.up)
        if not np.linalg.norm(right) > 1e-9:
            raise LeaflightError("The camera looks along its own up direction: choose another.")
        right = _unit(right)
        return np.array([right, np.cross(right, forward), forward])

    def directions(self, width, height, rows, samples=1):
        """Of rays through pixels: float64 (len(rows) samples, width samples, 3), unit.

        rows: a range, from the top. samples: along each side of a pixel, evenly spread.
        """
        right, up, forward = self.axes()
        scale = 2.0 * math.tan(math.radians(0.5 * self.angle)) / min(width, height)
        step = (np.arange(samples) + 0.5) / samples
        x = (np.arange(width)[:, None] + step).ravel() - 0.5 * width
        y = 0.5 * height - (np.asarray(rows)[:, None] + step).ravel()
        directions = forward + scale * x[None, :, None] * right + scale * y[:, None, None] * up
        return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def camera_around(low, high, azimuth=VIEW[0], elevation=VIEW[1], zoom=1.0):
    """A Camera that sees all of a box, from degrees around +z, 0 from -y, and above the horizon.

    zoom: how much larger than just whole the box is seen. Raises LeaflightError.
    """
    if not -90.0 < elevation < 90.0:
        raise LeaflightError(f"The view is {elevation:g} degrees high: choose between -90 and 90.")
    if not zoom > 0.0:
        raise LeaflightError(f"The zoom is {zoom:g}: choose a positive number.")
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    middle, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    a, e = math.radians(azimuth), math.radians(elevation)
    back = np.array([math.sin(a) * math.cos(e), -math.cos(a) * math.cos(e), math.sin(e)])
    distance = radius / math.sin(math.radians(0.5 * ANGLE)) / zoom
    return Camera(tuple((middle + distance * back).tolist()), tuple(middle.tolist()))


def camera_around_bake(bake, azimuth=VIEW[0], elevation=VIEW[1], zoom=1.0):
    """The same around all volumes of a Bake."""
    return camera_around(*bounds_of(bake), azimuth, elevation, zoom)


def bounds_of(bake):
    """(low, high) of the box, float64 (3,) each, that the volumes of a Bake fill in the world."""
    bounds = np.array([volume.field().bounds for volume in bake.volumes])
    return bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)


def load_camera(path):
    """Reads a JSON object with the names and values of a Camera's fields. Raises LeaflightError."""
    text = read_text(path)
    try:
        given = json.loads(text)
        known = asdict(Camera(**given))
    except (TypeError, ValueError):
        known = {}
    angle = known.pop("angle", None)
    right = isinstance(angle, Real) and 0.0 < angle < 180.0
    for value in known.values():
        right = right and isinstance(value, (list, tuple)) and len(value) == 3
        right = right and all(isinstance(x, Real) and math.isfinite(x) for x in value)
    if not right:
        raise LeaflightError(
            f'{path}: this is no camera: give {{"position": [x, y, z], "target": [x, y, z]}} and '
            'if needed "up" and the "angle" of view in degrees.'
        )
    return Camera(**given)


def _unit(vector):
    length = np.linalg.norm(vector)
    if not length > 0.0:
        raise LeaflightError("The camera stands where it looks: move it.")
    return vector / length
