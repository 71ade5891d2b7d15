# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""Editing how the isosurfaces look: stops of the color ramp, and presets."""

import bpy
from bpy.props import EnumProperty

from ..operators import checks
from ..show import isovalues, leaves, surface_object

# Settings by preset; colour stops stand at a part of the window.
PRESETS = {
    "CLAY": ("Clay", "Plain light gray", {"leaf_albedo": (0.8, 0.8, 0.8)}, []),
    "TISSUE": (
        "Tissue",
        "Skin, flesh and bone from low to high isovalues",
        {},
        [(0.0, (0.8, 0.55, 0.42)), (0.45, (0.6, 0.2, 0.15)), (1.0, (0.88, 0.84, 0.72))],
    ),
    "RAINBOW": (
        "Spectrum",
        "Blue over green to red from low to high isovalues",
        {},
        [(0.0, (0.1, 0.2, 0.8)), (0.5, (0.2, 0.7, 0.2)), (1.0, (0.8, 0.15, 0.1))],
    ),
    "GLOW": (
        "Glowing",
        "Sends light of its own",
        {"leaf_emission": (1.0, 0.75, 0.45), "leaf_emission_strength": 1.0},
        [],
    ),
    "MIRROR": (
        "Mirror",
        "Polished metal; what it shows is rendered, not baked",
        {"leaf_scattering": "MIRROR", "leaf_albedo": (0.9, 0.9, 0.9)},
        [],
    ),
    "GLASS": (
        "Glass",
        "Clear glass, which throws caustics",
        {"leaf_scattering": "GLASS", "leaf_albedo": (1.0, 1.0, 1.0), "leaf_ior": 1.45},
        [],
    ),
}

_PLAIN = {"leaf_scattering": "DIFFUSE", "leaf_emission_strength": 0.0}


class LEAFLIGHT_OT_leaf_preset(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.leaf_preset"
    bl_label = "Leaf Preset"
    bl_description = "Give the isosurfaces a look that is ready made"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(
        name="Preset", items=[(key, name, text) for key, (name, text, _, _) in PRESETS.items()]
    )

    def execute(self, context):
        settings = context.object.leaflight
        _, _, values, stops = PRESETS[self.preset]
        settings.leaf_stops.clear()
        for name, value in {**_PLAIN, **values}.items():
            setattr(settings, name, value)
        for part, color in stops:
            leaves.add_stop(settings, isovalues.isovalue_at(settings, part), color)
        surface_object.shade_all(context.object)
        return {"FINISHED"}


class LEAFLIGHT_OT_add_stop(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.add_stop"
    bl_label = "Add Color Stop"
    bl_description = (
        "Add a stop at the present isovalue, with its present color; the first stop replaces the "
        "single albedo"
    )
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        settings = context.object.leaflight
        isovalue = settings.isovalue
        if any(stop.isovalue == isovalue for stop in settings.leaf_stops):
            self.report({"ERROR"}, f"There is a stop at isovalue {isovalue:g}: move the isovalue.")
            return {"CANCELLED"}
        leaves.add_stop(settings, isovalue, leaves.albedo_at(context.object, isovalue))
        surface_object.shade_all(context.object)
        return {"FINISHED"}


class LEAFLIGHT_OT_remove_stop(checks.VolumeOperator, bpy.types.Operator):
    bl_idname = "leaflight.remove_stop"
    bl_label = "Remove Color Stop"
    bl_description = (
        "Remove the chosen stop; without stops the albedo is the same for all isovalues"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not context.object.leaflight.leaf_stops:
            cls.poll_message_set("There is no stop to remove")
            return False
        return True

    def execute(self, context):
        settings = context.object.leaflight
        settings.leaf_stops.remove(min(settings.leaf_stop, len(settings.leaf_stops) - 1))
        settings.leaf_stop = max(0, min(settings.leaf_stop, len(settings.leaf_stops) - 1))
        surface_object.shade_all(context.object)
        return {"FINISHED"}


_CLASSES = (LEAFLIGHT_OT_leaf_preset, LEAFLIGHT_OT_add_stop, LEAFLIGHT_OT_remove_stop)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
