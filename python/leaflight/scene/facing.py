# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns scenes in box coordinates so that their open side faces the volume's front."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..volume.first_isovalue import default_isovalue
from ..volume.volume import Volume
from .lights import Light, PointLight, Vector
from .scene import IDENTITY, SceneDescription

# Ratio of the visible widths from two sides above which a scene turns to the wider one.
CLEARLY_WIDER = 1.3
_MOST_VOXELS = 1 << 24


def faced(description: SceneDescription, volumes: Sequence[Volume]) -> SceneDescription:
    """Returns a scene in box coordinates, open towards -y, turned about z; any other unchanged.

    Patients face +y (Volume.patient). A volume that is clearly wider seen along x is seen along x.
    """
    if description.coordinates == "world":
        return description
    return turned(description, quarter_turns(volumes))


def quarter_turns(volumes: Sequence[Volume]) -> int:
    """Returns the number of turns by 90 degrees, counterclockwise: 0 to 3."""
    if any(volume.patient for volume in volumes):
        return 2
    return 1 if len(volumes) == 1 and _is_wider_along_x(volumes[0]) else 0


def turned(description: SceneDescription, turns: int) -> SceneDescription:
    """Returns the SceneDescription after this number of quarter turns about the z axis."""
    if turns % 4 == 0:
        return description
    x, y = ((1, 0), (0, 1), (-1, 0), (0, -1))[turns % 4]
    matrix = np.array([[x, -y, 0.0], [y, x, 0.0], [0.0, 0.0, 1.0]])

    def vector(v: Vector) -> Vector:
        return tuple((matrix @ v).tolist())

    def light(one: Light) -> Light:
        names = ("corner", "edge_u", "edge_v", "position", "direction")
        found: dict[str, Any] = {
            name: vector(getattr(one, name)) for name in names if hasattr(one, name)
        }
        if isinstance(one, PointLight) and one.cone is not None:
            found["cone"] = replace(one.cone, axis=vector(one.cone.axis))
        return replace(one, **found)

    environment = description.environment
    if environment is not None and environment.image is not None:
        to_image = np.array(environment.world_to_image or IDENTITY) @ matrix.T
        a, b, c = map(tuple, to_image.tolist())
        environment = replace(environment, world_to_image=(a, b, c))
    meshes = [
        replace(mesh, vertices=(mesh.vertices @ matrix.T).astype(np.float32))
        for mesh in description.meshes
    ]
    lights = [light(one) for one in description.lights]
    return replace(description, meshes=meshes, lights=lights, environment=environment)


def _is_wider_along_x(volume: Volume) -> bool:
    """Returns True if the default isosurface covers clearly more seen along the world's x axis."""
    matrix = np.asarray(volume.index_to_world, np.float64)[:3, :3]
    axes = np.abs(matrix).argmax(axis=0)  # World axis of each index axis.
    if sorted(axes) != [0, 1, 2]:
        return False
    step = max(1, round((volume.values.size / _MOST_VOXELS) ** (1 / 3)))
    inside = volume.values[::step, ::step, ::step] >= default_isovalue(volume)
    lengths = np.linalg.norm(matrix, axis=0)
    along = {}
    for index, world in enumerate(axes):
        seen = inside.any(axis=2 - index)
        along[world] = seen.sum() * np.prod(lengths) / lengths[index]
    return bool(along[0] > CLEARLY_WIDER * along[1])
