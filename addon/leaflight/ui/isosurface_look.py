# SPDX-License-Identifier: GPL-3.0-or-later
"""Editing how the isosurfaces look: stops of the color ramp, and looks by name."""

import bpy
from bpy.props import EnumProperty
from leaflight import LeaflightError

from ..operators import checks
from ..operators.checks import active_volume
from ..show import isosurfaces, isovalues, surface_object
from ..stage import background
from . import looks

_PLAIN = {"isosurface_scattering": "DIFFUSE", "isosurface_emission_strength": 0.0}


def _items(looks):
    return [(key, look.name, look.text) for key, look in looks.items()]


class LEAFLIGHT_OT_isosurface_preset(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.isosurface_preset"
    bl_label = "Look"
    bl_description = (
        "Give the isosurfaces a look by its name: color or color map, gloss, and the color of the "
        "stage's backdrop"
    )

    preset: EnumProperty(name="Look", items=_items(looks.LOOKS) + _items(looks.MAPS))

    def run(self, context):
        volume = active_volume(context)
        settings, shown = volume.leaflight, volume.leaflight_look
        chosen = {**looks.LOOKS, **looks.MAPS}[self.preset]
        settings.isosurface_stops.clear()
        for name, value in {**_PLAIN, **chosen.settings}.items():
            setattr(settings, name, value)
        for part, color in chosen.stops:
            isosurfaces.add_stop(settings, isovalues.isovalue_at(settings, part), color)
        if chosen.background is not None:
            background.paint(context.scene, chosen.background)
        shown.gloss, shown.roughness = chosen.gloss, chosen.roughness
        surface_object.shade_all(volume)


class LEAFLIGHT_OT_add_stop(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.add_stop"
    bl_label = "Add Color Stop"
    bl_description = (
        "Add a stop at the present isovalue, with its present color; the first stop replaces the "
        "single albedo"
    )

    def run(self, context):
        volume = active_volume(context)
        settings = volume.leaflight
        isovalue = settings.isovalue
        if any(stop.isovalue == isovalue for stop in settings.isosurface_stops):
            raise LeaflightError(f"There is a stop at isovalue {isovalue:g}: move the isovalue.")
        isosurfaces.add_stop(settings, isovalue, isosurfaces.albedo_at(volume, isovalue))
        surface_object.shade_all(volume)


class LEAFLIGHT_OT_remove_stop(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.remove_stop"
    bl_label = "Remove Color Stop"
    bl_description = (
        "Remove the chosen stop; without stops the albedo is the same for all isovalues"
    )

    conditions = (
        *checks.VOLUME,
        checks.needs(
            lambda context: active_volume(context).leaflight.isosurface_stops,
            "There is no stop to remove",
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


CLASSES = (LEAFLIGHT_OT_isosurface_preset, LEAFLIGHT_OT_add_stop, LEAFLIGHT_OT_remove_stop)
