# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera."""

import json
import math
import sys
from dataclasses import asdict, dataclass

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Bake
from ..io.json_object import read_text
from ..paths import AnyPath
from ..scene.lights import Vector

# Angle of view across the picture's shorter side: a portrait lens, as in the add-on's stages.
ANGLE = 26.0
_LARGEST = sys.float_info.max


@dataclass(frozen=True)
class Camera:
    """A perspective camera.

    position, target: World positions of the camera and of the center of the picture.
    up: Direction that is upright in the picture.
    angle: Angle of view across the shorter side of the picture, in degrees.
    """

    position: Vector
    target: Vector
    up: Vector = (0.0, 0.0, 1.0)
    angle: float = ANGLE

    def axes(self) -> Array:
        """Returns unit vectors to the right, up and forward: (3, 3)."""
        forward = _unit(np.subtract(self.target, self.position))
        right = np.cross(forward, self.up)
        if not np.linalg.norm(right) > 1e-9:
            raise LeaflightError(
                "The camera looks along its up direction: choose another up direction."
            )
        right = _unit(right)
        return np.array([right, np.cross(right, forward), forward])

    def directions(self, width: int, height: int, rows: range, samples: int = 1) -> Array:
        """Returns unit directions of rays through pixels.

        rows: A range of rows from the top.
        samples: Evenly spaced rays along each side of a pixel.
        The result is float64 (len(rows) samples, width samples, 3).
        """
        right, up, forward = self.axes()
        scale = 2.0 * math.tan(math.radians(0.5 * self.angle)) / min(width, height)
        step = (np.arange(samples) + 0.5) / samples
        x = (np.arange(width)[:, None] + step).ravel() - 0.5 * width
        y = 0.5 * height - (np.asarray(rows)[:, None] + step).ravel()
        directions = forward + scale * x[None, :, None] * right + scale * y[:, None, None] * up
        unit: Array = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
        return unit


def bounds_of(bake: Bake) -> tuple[Array, Array]:
    """Returns the corners (low, high) of the box around a Bake's volumes, float64 (3,) each."""
    bounds = np.array([volume.field().bounds for volume in bake.volumes])
    return bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)


def load_camera(path: AnyPath) -> Camera:
    """Reads a JSON object with the names and values of a Camera's fields. Raises LeaflightError."""
    text = read_text(path)
    try:
        known = asdict(Camera(**json.loads(text)))
    except (RecursionError, TypeError, ValueError):
        known = {}
    angle = known.pop("angle", None)
    right = isinstance(angle, (int, float)) and 0.0 < angle < 180.0
    for value in known.values():
        right = right and isinstance(value, (list, tuple)) and len(value) == 3
        # Integers in JSON may be too large for floating point.
        right = right and all(isinstance(x, (int, float)) and abs(x) <= _LARGEST for x in value)
    if not right:
        raise LeaflightError(
            f'{path}: this is not a camera: give {{"position": [x, y, z], "target": [x, y, z]}}, '
            'and optionally "up" and the "angle" of view in degrees.'
        )
    position, target, up = (
        (float(x), float(y), float(z))
        for x, y, z in (known[name] for name in ("position", "target", "up"))
    )
    return Camera(position, target, up, float(angle))


def _unit(vector: Array) -> Array:
    length = np.linalg.norm(vector)
    if not length > 0.0:
        raise LeaflightError("The camera's position equals its target: move one of them.")
    unit: Array = vector / length
    return unit
