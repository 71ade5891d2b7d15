# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets of Stage: scene files of the package, fitted to the volumes.

Scene.leaflight_stage stores the choices of a scene.
"""

from dataclasses import dataclass

import bpy
import numpy as np
from leaflight.io.scene_file import packaged_scene
from leaflight.scene import scene

from ..props import (
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    PointerProperty,
    StringProperty,
)

MY_SCENE = "MY_SCENE"

# Gap between the floor of a scene file and isosurfaces, in its coordinates. Without it, light would
# end within a facet of the floor, with a jagged edge.
_GAP = 0.02


@dataclass(frozen=True)
class Preset:
    """A stage: its name, its purpose, its icon, and its scene file (None for the user's own)."""

    name: str
    text: str
    icon: str
    file: str


PRESETS = {
    "STUDIO": Preset(
        "Studio",
        "Seamless backdrop with a warm key light, a cool fill light and a rim light",
        "LIGHT_AREA",
        "studio.json",
    ),
    "CORNELL": Preset(
        "Cornell Box",
        "Red and green walls with color bleeding, and one wide lamp",
        "CUBE",
        "cornell_stage.json",
    ),
    "OPEN_FLOOR": Preset(
        "Open Floor",
        "Floor and backdrop with a key light and a weaker fill light",
        "MESH_PLANE",
        "open_floor.json",
    ),
    "LIGHT_TENT": Preset(
        "Light Tent",
        "White walls and soft light from all sides, hardly any shadows",
        "LIGHT_HEMI",
        "light_tent.json",
    ),
    "DARK_ROOM": Preset(
        "Dark Room",
        "Dark walls and one small lamp, with sharp, deep shadows",
        "LIGHT_POINT",
        "dark_room.json",
    ),
    MY_SCENE: Preset(
        "My Scene",
        "Your objects and lights in a collection; adds a missing camera",
        "SCENE_DATA",
        None,
    ),
}

ITEMS = [
    (key, preset.name, preset.text, preset.icon, number)
    for number, (key, preset) in enumerate(PRESETS.items())
]


def fitted(preset, points, height=0.0):
    """Returns the SceneDescription of a preset around points (n, 3), in their coordinates.

    The scene is fitted to the box of the points, which then stand just above its floor. height: By
    which they float above that.
    """
    description = packaged_scene(PRESETS[preset].file)
    fit = scene.Fit.of_box(points.min(axis=0), points.max(axis=0))
    floor = min(float(mesh.vertices[:, 2].min()) for mesh in description.meshes)
    center = (*fit.center[:2], points[:, 2].min() - height - (floor + _GAP) * fit.scale)
    return scene.fitted(description, scene.Fit(np.array(center), fit.scale))


class LeaflightStage(bpy.types.PropertyGroup):
    preset: EnumProperty("Stage", "Objects that Stage adds around the volumes", ITEMS)
    collection: PointerProperty(
        bpy.types.Collection,
        "Collection",
        "Collection of your objects and lights around the volumes",
    )
    height: FloatProperty(
        "Float",
        "Height of the isosurfaces above the floor, for the next Stage or Frame Isosurface",
        min=0.0,
        unit="LENGTH",
    )
    albedo: FloatVectorProperty("Color of the Volumes Set by Stage", size=3)
    warnings: StringProperty("Differences Between Bake and Cycles, One per Line")
    # World and camera of the scene before it was staged.
    own_world: PointerProperty(bpy.types.World)
    own_camera: PointerProperty(bpy.types.Object)


PROPERTIES = ((bpy.types.Scene, "leaflight_stage", PointerProperty(LeaflightStage)),)
