# SPDX-License-Identifier: GPL-3.0-or-later
"""The color of a stage's backdrop."""

from ..show import shader
from .stage import is_staged

# The name that scene files give it.
_BACKDROP = "backdrop"


def paint(scene, color):
    """Gives a linear color (r, g, b) to the backdrop of the stage, where it has one."""
    for obj in scene.objects:
        if is_staged(obj) and obj.name.partition(".")[0] == _BACKDROP:
            for material in obj.data.materials:
                shader.set_albedo(material, color)
                material.diffuse_color = (*color, 1.0)
