# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene remembers about its stage: Scene.leaflight_stage."""

import bpy
from bpy.props import EnumProperty, FloatVectorProperty, PointerProperty, StringProperty

from . import presets


class LeaflightStage(bpy.types.PropertyGroup):
    preset: EnumProperty(
        name="Stage",
        description="What Stage puts around the volumes",
        items=presets.ITEMS,
    )
    collection: PointerProperty(
        type=bpy.types.Collection,
        name="Collection",
        description="Objects and lights of your own that shall surround the volumes",
    )
    albedo: FloatVectorProperty(name="Color That Stage Gave to the Volumes", size=3)
    warnings: StringProperty(name="What Would Spoil the Bake, a Sentence a Line")
    # What the scene had before it was staged.
    own_world: PointerProperty(type=bpy.types.World)
    own_camera: PointerProperty(type=bpy.types.Object)


CLASSES = (LeaflightStage,)
PROPERTIES = ((bpy.types.Scene, "leaflight_stage", PointerProperty(type=LeaflightStage)),)
