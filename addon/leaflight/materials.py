# SPDX-License-Identifier: GPL-3.0-or-later
"""What the node trees of materials, lights and worlds say in the terms of the bake.

Nodes are found by type and sockets by identifier: both stay the same in every language.
"""

import numpy as np

from . import core

LeaflightError = core.LeaflightError

# The colour in which Cycles renders a mesh without a material.
DEFAULT_ALBEDO = (0.8, 0.8, 0.8)

# Parts of the Principled BSDF that are not a reflection of its base colour in all directions.
_FORBIDDEN = ("Metallic", "Transmission", "Transmission Weight", "Subsurface", "Subsurface Weight")
_GLOSSY = ("Specular", "Specular IOR Level", "Sheen", "Sheen Weight", "Clearcoat", "Coat Weight")


def diffuse_albedo(owner, material):
    """The albedo (r, g, b) of a material on the object called `owner`, and a warning or None.

    Raises LeaflightError for anything but a Diffuse or Principled BSDF of one colour.
    """
    if material is None:
        return DEFAULT_ALBEDO, None
    if not material.use_nodes:
        return tuple(material.diffuse_color[:3]), None
    what = f'Material "{material.name}" of "{owner}"'
    shader = _linked(material.node_tree, "Surface")
    if shader is None:
        return (0.0, 0.0, 0.0), None
    if shader.type == "BSDF_DIFFUSE":
        return _colour(what, _input(shader, "Color")), None
    if shader.type != "BSDF_PRINCIPLED":
        raise LeaflightError(
            f"{what} ends in a {shader.bl_label} node, but the bake models a Diffuse or Principled "
            "BSDF: change it, or disable the object in renders."
        )
    for identifier in _FORBIDDEN:
        if _value(shader, identifier) > 0:
            raise LeaflightError(
                f"{what} has {identifier} above zero, which the bake cannot model: set it to zero."
            )
    if _value(shader, "Alpha", 1.0) < 1:
        raise LeaflightError(f"{what} is transparent, which the bake cannot model: set Alpha to 1.")
    emission = _input(shader, "Emission") or _input(shader, "Emission Color")
    if emission is not None and _value(shader, "Emission Strength", 1.0) > 0:
        if emission.is_linked or max(emission.default_value[:3]) > 0:
            raise LeaflightError(
                f"{what} emits light, but the bake models Area lights only: set Emission to black."
            )
    glossy = [name for name in _GLOSSY if _value(shader, name) > 0]
    warning = None
    if glossy:
        warning = f"{what} is baked without its {' and '.join(glossy)}: set it to zero for a match"
    return _colour(what, _input(shader, "Base Color")), warning


def light_tint(owner, light):
    """The factor (3,) that a light's nodes put on its colour. Raises LeaflightError."""
    if not light.use_nodes:
        return np.ones(3)
    what = f'Light "{owner}"'
    emission = _linked(light.node_tree, "Surface")
    if emission is None:
        return np.zeros(3)
    if emission.type != "EMISSION":
        raise LeaflightError(
            f"{what} ends in a {emission.bl_label} node, but the bake models Emission: change it."
        )
    strength = _input(emission, "Strength")
    if strength.is_linked:
        raise LeaflightError(f"{what} has a textured strength: disconnect it, or bake without it.")
    return np.array(_colour(what, _input(emission, "Color"))) * strength.default_value


def world_radiance(world):
    """The largest radiance (3,) that a world may send; infinite when its nodes do not tell."""
    if not world.use_nodes:
        return np.array(world.color[:3])
    background = _linked(world.node_tree, "Surface")
    if background is None:
        return np.zeros(3)
    if background.type != "BACKGROUND":
        return np.full(3, np.inf)
    strength, colour = _input(background, "Strength"), _input(background, "Color")
    if not strength.is_linked and strength.default_value == 0:
        return np.zeros(3)
    if strength.is_linked or colour.is_linked:
        return np.full(3, np.inf)
    return np.array(colour.default_value[:3]) * strength.default_value


def _linked(tree, identifier):
    """The node that feeds a socket of the output which Cycles renders, or None."""
    output = tree.get_output_node("CYCLES")
    socket = _input(output, identifier) if output else None
    while socket is not None and socket.is_linked:
        node = socket.links[0].from_node
        if node.type != "REROUTE":
            return node
        socket = node.inputs[0]
    return None


def _input(node, identifier):
    return next((s for s in node.inputs if s.identifier == identifier), None)


def _value(node, identifier, absent=0.0):
    """The number at a socket; one that is fed by other nodes counts as above any limit."""
    socket = _input(node, identifier)
    if socket is None:
        return absent
    return np.inf if socket.is_linked else socket.default_value


def _colour(what, socket):
    if socket.is_linked:
        raise LeaflightError(
            f"{what} has a textured color, but the bake models one color per material: "
            "disconnect its texture and choose a color."
        )
    return tuple(float(x) for x in socket.default_value[:3])
