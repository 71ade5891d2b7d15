# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between the versions of Blender, for the add-on: the only place that asks.

What the add-on shares with the package's own scenes for Cycles is in
leaflight.measure.blender_versions.
"""

import bpy
import leaflight
from leaflight.measure import blender_versions

give_nodes = blender_versions.give_nodes
node_tree = blender_versions.node_tree
set_loop_starts = blender_versions.set_loop_starts
set_normals = blender_versions.set_normals

# Of a path property whose paths may be relative to the .blend; 4.5 and later want to be told.
RELATIVE_PATH = {"ANIMATABLE"}
if bpy.app.version >= (4, 5, 0):
    RELATIVE_PATH |= {"PATH_SUPPORTS_BLEND_RELATIVE"}

# Grease pencil is GPENCIL before 4.3.
UNSEEN_TYPES = {
    "EMPTY",
    "CAMERA",
    "ARMATURE",
    "LATTICE",
    "SPEAKER",
    "GPENCIL",
    "GREASEPENCIL",
    "LIGHT_PROBE",
}


def light_units():
    """The LightUnits of this Blender. Raises LeaflightError."""
    units = blender_versions.light_units(bpy.app.version)
    if units is None:
        raise leaflight.LeaflightError("Leaflight needs Blender 3.4 or later.")
    return units


def lights_are_checked():
    return bpy.app.version[:2] in blender_versions.CHECKED


def casts_shadow(light):
    """Until 4.1 Cycles has a switch of its own, and ignores the light's."""
    return getattr(light.cycles, "cast_shadow", light.use_shadow)


def temperature_color(light):
    """The colour (r, g, b) that a temperature gives a light, from 4.4 on."""
    return tuple(light.temperature_color) if getattr(light, "use_temperature", False) else (1, 1, 1)


def exposure(light):
    """In stops, from 4.4 on."""
    return getattr(light, "exposure", 0.0)


def is_normalized(light):
    """Whether a light's power is that of all of it; from 4.4 on it may be that of a unit area."""
    return getattr(light, "normalize", True)


def falls_off_softly(light):
    """Whether E = I / (d^2 + r^2) at the distance d from a point light of radius r."""
    always = light_units().soft_points
    return light.use_soft_falloff if always is None else always


def harden_falloff(light):
    """Lets E = I / d^2 at the distance d from a point light, where Blender offers that."""
    if light_units().soft_points is None:
        light.use_soft_falloff = False


def links_light(obj):
    """Whether a light or mesh lights or shades only some objects, from 4.0 on."""
    linking = getattr(obj, "light_linking", None)
    return linking is not None and (
        linking.receiver_collection is not None or linking.blocker_collection is not None
    )


def working_space():
    """The linear colours that renders compute in; a choice of the file's from 5.0 on."""
    space = getattr(bpy.data, "colorspace", None)
    return "Linear Rec.709" if space is None else space.working_space


def do_not_sample_as_light(material):
    """Paths find what emits by themselves; as a light of many triangles it would add noise."""
    if hasattr(material.cycles, "emission_sampling"):  # from 3.5 on
        material.cycles.emission_sampling = "NONE"
    else:
        material.cycles.sample_as_light = False


def principled_glass_color(base):
    """What of each color passes a surface of Principled glass: from 4.0 on two make the base."""
    if bpy.app.version < (4, 0, 0):
        return base
    return tuple(min(x, 1.0) ** 0.5 for x in base)


def principled_is_lambertian(shader):
    """Whether its diffuse part is so, to 2 %; until 3.6 that depends on its Roughness."""
    roughness = shader.inputs["Roughness"]
    lambertian = not roughness.is_linked and abs(roughness.default_value - 0.5) < 0.1
    return bpy.app.version >= (4, 0, 0) or lambertian


def principled_metal_edges(shader, base):
    """Whether a Principled metal has another color at grazing angles; until 3.6 by its Specular."""
    if bpy.app.version < (4, 0, 0):
        return min(base) < 1 and shader.inputs["Specular"].default_value > 0
    tint = shader.inputs["Specular Tint"]
    return min(base) < 1 or tint.is_linked or min(tint.default_value[:3]) < 1


def fcurves(owner):
    """The curves that animate a data-block; from 4.4 on those of its slot in the action."""
    data = owner.animation_data
    if data is None or data.action is None:
        return []
    if not hasattr(data.action, "layers"):
        return list(data.action.fcurves)
    slot = data.action_slot
    strips = [strip for layer in data.action.layers for strip in layer.strips]
    bags = [strip.channelbag(slot) for strip in strips if slot is not None]
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def image_format(**values):
    """Settings of an image to write; from 5.0 on a medium comes first, and decides the formats."""
    medium = {"media_type": "IMAGE"}
    known = bpy.types.ImageFormatSettings.bl_rna.properties
    return {**(medium if "media_type" in known else {}), **values}


def plain_view():
    """Settings of a view that shows linear colours through the sRGB curve, and nothing else."""
    view = {"view_transform": "Standard", "look": "None", "gamma": 1.0, "use_curve_mapping": False}
    known = bpy.types.ColorManagedViewSettings.bl_rna.properties
    return {**view, **({"use_white_balance": False} if "use_white_balance" in known else {})}


def new_geometry_tree(name):
    """Geometry nodes with one geometry going in and one coming out."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    if hasattr(tree, "interface"):  # from 4.0 on
        for direction in ("INPUT", "OUTPUT"):
            tree.interface.new_socket(
                "Geometry", in_out=direction, socket_type="NodeSocketGeometry"
            )
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    return tree
