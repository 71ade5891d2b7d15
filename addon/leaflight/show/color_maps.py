# SPDX-License-Identifier: GPL-3.0-or-later
"""The package's color maps as linear colors."""

from leaflight import color_maps
from mathutils import Color


def _linear(hexadecimal):
    color = Color(byte / 255 for byte in bytes.fromhex(hexadecimal))
    return tuple(color.from_srgb_to_scene_linear())


# Black to white in steps that look even.
GRAY = tuple(_linear(3 * f"{round(255 * i / 8):02x}") for i in range(9))
# (name, description, nine colors, evenly spaced)
MAPS = {
    key: (name, text, tuple(map(_linear, colors)))
    for key, (name, text, colors) in color_maps.MAPS.items()
}
