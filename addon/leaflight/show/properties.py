# SPDX-License-Identifier: GPL-3.0-or-later
"""What an object remembers about its volume and its bake: Object.leaflight."""

import bpy

from . import isovalues, walls
from .bake_options import BakeOptions
from .bake_record import BakeRecord
from .isosurface_properties import Isosurfaces, LeaflightColorStop
from .overridable import BoolProperty, PointerProperty
from .source_properties import VolumeSource

ISOVALUE_PATH = isovalues.ISOVALUE_PATH


def _walls_changed(_settings, context):
    walls.refresh(context.scene)


class LeaflightSettings(
    VolumeSource, Isosurfaces, BakeOptions, BakeRecord, bpy.types.PropertyGroup
):
    """The volume of an object, how it is baked, and the bake that lights it.

    The isovalue is an ID property, because only these take their limits from the data; `isovalue`
    reads and writes it in scripts, ISOVALUE_PATH animates it.
    """

    is_volume: BoolProperty(name="Leaflight Volume")

    @property
    def isovalue(self):
        """The isovalue in data units; of an evaluated object, with its animation applied."""
        return self["isovalue"]

    @isovalue.setter
    def isovalue(self, value):
        self["isovalue"] = float(value)
        self.id_data.update_tag()
        isovalues.set_isovalue(self.id_data, float(value))

    def limit_isovalue(self, data_range, isovalue_range, default):
        """Limits the slider to the range of the data, and softly to the isovalue range."""
        low, high = data_range
        self.property_overridable_library_set('["isovalue"]', True)
        self.id_properties_ui("isovalue").update(
            description="Isovalue of the displayed surface, in data units",
            min=low,
            max=high,
            soft_min=max(low, isovalue_range[0]),
            soft_max=min(high, isovalue_range[1]),
            default=default,
            step=max((high - low) / 255.0, 1e-6),
            precision=3 if high - low > 1.0 else 6,
        )


class LeaflightSceneSettings(bpy.types.PropertyGroup):
    """What concerns all volumes of a scene: Scene.leaflight."""

    show_walls: bpy.props.BoolProperty(
        name="Show Lit Walls",
        description="Show the walls with the light of the present isosurface in place of "
        "the objects that were baked. Turn it off to edit these",
        default=True,
        update=_walls_changed,
    )
    active_volume: bpy.props.StringProperty(name="Volume That Was Active Last")


CLASSES = (LeaflightColorStop, LeaflightSettings, LeaflightSceneSettings)
PROPERTIES = (
    (bpy.types.Object, "leaflight", PointerProperty(type=LeaflightSettings)),
    (bpy.types.Scene, "leaflight", bpy.props.PointerProperty(type=LeaflightSceneSettings)),
)
