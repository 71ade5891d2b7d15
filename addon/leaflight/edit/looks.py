# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators for presets of isosurfaces, and for the stops of their color ramps."""

from dataclasses import dataclass, field

import bpy
from leaflight import LeaflightError, looks

from ..operators import checks
from ..operators.checks import active_volume
from ..props import EnumProperty
from ..show import data_faces, isosurfaces, isovalues, surface_object
from ..stage import stage


@dataclass(frozen=True)
class Preset(looks.Preset):
    """A preset of isosurfaces, which need not have one color.

    settings: Values of Object.leaflight.
    stops: (share of the isovalue range, linear color) of each stop.
    """

    color: tuple = None
    settings: dict = field(default_factory=dict)
    stops: tuple = ()


def _mapped(name, text, colors):
    stops = tuple((i / (len(colors) - 1), color) for i, color in enumerate(colors))
    return Preset(name, text, stops=stops)


LOOKS = {
    **{
        key: Preset(**vars(look), settings={"isosurface_albedo": look.color})
        for key, look in looks.LOOKS.items()
    },
    "TISSUE": Preset(
        "Tissue",
        "Skin, flesh and bone, from low to high isovalues",
        stops=((0.0, (0.8, 0.55, 0.42)), (0.45, (0.6, 0.2, 0.15)), (1.0, (0.88, 0.84, 0.72))),
        gloss=0.4,
    ),
    "GLOW": Preset(
        "Glowing",
        "Emits light",
        settings={"isosurface_emission": (1.0, 0.75, 0.45), "isosurface_emission_strength": 1.0},
    ),
    "MIRROR": Preset(
        "Mirror",
        "Polished metal; reflections are rendered, not baked",
        settings={"isosurface_scattering": "MIRROR", "isosurface_albedo": (0.9, 0.9, 0.9)},
    ),
    "GLASS": Preset(
        "Glass",
        "Clear glass with caustics",
        settings={
            "isosurface_scattering": "GLASS",
            "isosurface_albedo": (1.0, 1.0, 1.0),
            "isosurface_ior": 1.45,
        },
    ),
}
MAPS = {key: _mapped(*color_map) for key, color_map in data_faces.MAPS.items()}


_PLAIN = {"isosurface_scattering": "DIFFUSE", "isosurface_emission_strength": 0.0}


def _items(presets):
    return [(key, preset.name, preset.text) for key, preset in presets.items()]


class LEAFLIGHT_OT_isosurface_preset(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Look"
    bl_description = (
        "Set color or color map and gloss of the isosurfaces, and the color of the stage's backdrop"
    )

    preset: EnumProperty("Look", items=_items(LOOKS) + _items(MAPS))

    def run(self, context):
        volume = active_volume(context)
        settings, shown = volume.leaflight, volume.leaflight_look
        chosen = {**LOOKS, **MAPS}[self.preset]
        settings.isosurface_stops.clear()
        for name, value in {**_PLAIN, **chosen.settings}.items():
            setattr(settings, name, value)
        for part, color in chosen.stops:
            isosurfaces.add_stop(settings, isovalues.isovalue_at(settings, part), color)
        if chosen.background is not None:
            stage.paint_backdrop(context.scene, chosen.background)
        shown.gloss, shown.roughness = chosen.gloss, chosen.roughness
        surface_object.shade_all(volume)


class LEAFLIGHT_OT_add_stop(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Add Color Stop"
    bl_description = (
        "Add a stop at the shown isovalue with its color. The first stop replaces the single albedo"
    )

    def run(self, context):
        volume = active_volume(context)
        settings = volume.leaflight
        isovalue = settings.isovalue
        if any(stop.isovalue == isovalue for stop in settings.isosurface_stops):
            raise LeaflightError(
                f"A stop at isovalue {isovalue:g} exists already: move the isovalue."
            )
        isosurfaces.add_stop(settings, isovalue, isosurfaces.albedo_at(volume, isovalue))
        surface_object.shade_all(volume)


class LEAFLIGHT_OT_remove_stop(checks.VolumeOperator, bpy.types.Operator):
    bl_label = "Remove Color Stop"
    bl_description = "Remove the selected stop; without stops one albedo applies to all isovalues"

    conditions = (
        *checks.VOLUME,
        checks.volume_needs(
            lambda volume: volume.leaflight.isosurface_stops, "There is no stop to remove"
        ),
    )

    def run(self, context):
        volume = active_volume(context)
        settings = volume.leaflight
        settings.isosurface_stops.remove(
            min(settings.isosurface_stop, len(settings.isosurface_stops) - 1)
        )
        settings.isosurface_stop = max(
            0, min(settings.isosurface_stop, len(settings.isosurface_stops) - 1)
        )
        surface_object.shade_all(volume)
