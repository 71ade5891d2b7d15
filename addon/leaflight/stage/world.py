# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of Blender's world as the environment of the bake: one color or a panorama image."""

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.scene import Environment

from .. import versions
from . import images, nodes


def export_world(world):
    """Returns the Environment of a world, None for a dark or missing one. Raises LeaflightError."""
    if world is None:
        return None
    what = f'World "{world.name}"'
    tree = versions.node_tree(world)
    if tree is None:
        return _environment(what, world.name, tuple(world.color))
    background = nodes.shader(what, tree)
    if background is None:
        return None
    if background.type != "BACKGROUND":
        raise LeaflightError(
            f"{what} ends in a {background.bl_label} node, but the bake models Background: connect "
            "that, with a color or an Environment Texture."
        )
    strength = nodes.constant(what, background, "Strength")
    if strength == 0:
        return None
    end = nodes.socket(background, "Color")
    texture = nodes.source(end)
    if texture is None:
        color = nodes.color(what, end)
        return _environment(what, world.name, tuple(strength * x for x in color))
    if texture.type != "TEX_ENVIRONMENT":
        raise LeaflightError(
            f"{what} has a {texture.bl_label} node in its color, but the bake models one color or "
            "an Environment Texture: bake it to an image, or choose a color."
        )
    if texture.projection != "EQUIRECTANGULAR":
        raise LeaflightError(
            f"{what} has an image of the kind Mirror Ball, but the bake models Equirectangular "
            "ones: convert the image."
        )
    pixels = images.linear_pixels(what, texture.image)
    turn = _world_to_image(what, nodes.socket(texture, "Vector"))
    return _environment(what, world.name, (strength,) * 3, pixels, turn)


def is_dark(world):
    """True if a world emits no light or is None. False if the bake cannot model the world."""
    try:
        return export_world(world) is None
    except LeaflightError:
        return False


def _environment(what, name, radiance, image=None, world_to_image=np.eye(3)):
    if not min(radiance) >= 0 or (image is not None and image.min() < 0):
        raise LeaflightError(f"{what} emits negative light: make it zero or positive.")
    if max(radiance) == 0 or (image is not None and image.max() == 0):
        return None
    red, green, blue = map(float, radiance)
    x, y, z = ((float(a), float(b), float(c)) for a, b, c in world_to_image)
    return Environment(name, (red, green, blue), image, (x, y, z))


def _world_to_image(what, end):
    """Returns the rotation (3, 3) that Mapping nodes apply to the directions of an image."""
    node = nodes.source(end)
    if node is None:
        return np.eye(3)
    if node.type == "TEX_COORD" and nodes.source_socket(end).identifier == "Generated":
        return np.eye(3)
    if node.type != "MAPPING":
        raise LeaflightError(
            f"{what} uses a {node.bl_label} node for its image, but the bake models a Mapping of "
            "Generated coordinates: use these."
        )
    matrix = nodes.mapping(what, node)
    if not nodes.is_rotation(matrix):
        raise LeaflightError(
            f"{what} has a Mapping node with location or scale, but the bake models rotations: "
            "reset its location and scale."
        )
    return matrix[:3, :3] @ _world_to_image(what, nodes.socket(node, "Vector"))
