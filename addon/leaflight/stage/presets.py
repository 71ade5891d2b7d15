# SPDX-License-Identifier: GPL-3.0-or-later
"""What Stage may put around the volumes: scene files of the package, fitted and turned."""

from dataclasses import dataclass, replace

import leaflight
import numpy as np
from leaflight.io.scene_file import packaged_scene

MY_SCENE = "MY_SCENE"

# How far above the floor of a scene file the common box of the volumes ends, in its coordinates.
_GAP = 0.02


@dataclass(frozen=True)
class Preset:
    """A stage: its name, what it is for, its icon, and its scene file, None for the user's own.

    elevation: from where the camera looks down at the volumes, in degrees; filled: the share of
    its frame that they fill.
    """

    name: str
    text: str
    icon: str
    file: str
    elevation: float
    filled: float


PRESETS = {
    "CORNELL": Preset(
        "Cornell Box",
        "A red and a green wall, whose light bleeds onto the isosurface, and one wide lamp",
        "CUBE",
        "cornell_stage.json",
        elevation=6.0,
        filled=0.6,
    ),
    "OPEN_FLOOR": Preset(
        "Open Floor",
        "A floor and a backdrop with a key light and a weaker fill light, as in a photo studio",
        "LIGHT_AREA",
        "open_floor.json",
        elevation=12.0,
        filled=0.7,
    ),
    "LIGHT_TENT": Preset(
        "Light Tent",
        "White walls and soft light from all sides: shows the shape, with hardly a shadow",
        "LIGHT_HEMI",
        "light_tent.json",
        elevation=6.0,
        filled=0.7,
    ),
    "DARK_ROOM": Preset(
        "Dark Room",
        "Dark walls and one small lamp: sharp, deep shadows",
        "LIGHT_POINT",
        "dark_room.json",
        elevation=6.0,
        filled=0.7,
    ),
    MY_SCENE: Preset(
        "My Scene",
        "Your own objects and lights in a collection; nothing is built but a missing camera",
        "SCENE_DATA",
        None,
        elevation=8.0,
        filled=0.7,
    ),
}

ITEMS = [
    (key, preset.name, preset.text, preset.icon, number)
    for number, (key, preset) in enumerate(PRESETS.items())
]


def fitted(preset, volumes, isovalues):
    """The SceneDescription of a preset, fitted around volumes in world coordinates.

    It is as large as fit_scene() makes it, and moved so that its floor lies just below the lowest
    place where a volume has its isovalue or more: what is flat, or has margins, does not float.
    isovalues: of each volume, the lowest that is baked. Raises LeaflightError.
    """
    description = packaged_scene(PRESETS[preset].file)
    low, high = bounds(volumes)
    scale = 0.5 * float((high - low).max())
    floor = min(float(mesh.vertices[:, 2].min()) for mesh in description.meshes)
    lowest = 0.5 * (low + high)[2] + floor * scale
    foot = min(_foot(volume, isovalue) for volume, isovalue in zip(volumes, isovalues))
    return moved(leaflight.fit_scene(description, volumes), (foot - _GAP * scale) - lowest)


def _foot(volume, isovalue):
    """The z of the lowest corner of the box of the voxels of an isovalue or more."""
    inside = np.asarray(volume.values) >= isovalue
    if not inside.any():
        return float(bounds([volume])[0][2])
    ends = []
    for axis in (2, 1, 0):  # x first
        others = tuple(other for other in range(3) if other != axis)
        found = np.flatnonzero(inside.any(axis=others))
        # The isosurface lies up to a voxel further out.
        ends.append((max(found[0] - 1, 0), min(found[-1] + 1, inside.shape[axis] - 1)))
    corners = np.stack(np.meshgrid(*ends, indexing="ij"), axis=-1).reshape(-1, 3)
    matrix = np.asarray(volume.index_to_world)
    return float((corners @ matrix[2, :3] + matrix[2, 3]).min())


def bounds(volumes):
    """Lowest and highest corner, each (3,), of the common box of volumes in world coordinates."""
    boxes = np.array([volume.field().bounds for volume in volumes], np.float64)
    return boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)


def moved(description, up):
    """The description, in world coordinates, moved upwards."""
    offset = np.array([0.0, 0.0, up])

    def light(one):
        for name in ("corner", "position"):
            if hasattr(one, name):
                place = np.asarray(getattr(one, name)) + offset
                return replace(one, **{name: tuple(place.tolist())})
        return one

    def mesh(one):
        return replace(one, vertices=(one.vertices + offset).astype(np.float32))

    return replace(
        description,
        meshes=[mesh(one) for one in description.meshes],
        lights=[light(one) for one in description.lights],
    )
