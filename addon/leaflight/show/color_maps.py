# SPDX-License-Identifier: GPL-3.0-or-later
"""The package's color maps as linear colors."""

from leaflight import color_maps
from mathutils import Color


def _linear(hexadecimal):
    color = Color(byte / 255 for byte in bytes.fromhex(hexadecimal))
    return tuple(color.from_srgb_to_scene_linear())


# (name, description, nine colors, evenly spaced)
MAPS = {
    key: (name, text, tuple(map(_linear, colors)))
    for key, (name, text, colors) in color_maps.MAPS.items()
}
