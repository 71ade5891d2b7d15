# SPDX-License-Identifier: GPL-3.0-or-later
"""The cube and the lamp with which Blender begins: nobody wants a volume lit by them."""

import numpy as np

from . import hidden

# Where Blender puts them; lengths of the cube's sides, power of the lamp.
_CUBE, _LAMP = (0.0, 0.0, 0.0), (4.0762, 1.0055, 5.9039)
_SIDE, _POWER = 2.0, 1000.0


def is_untouched(scene):
    """True if a scene has nothing to bake with its volumes but what Blender began with."""
    objects = hidden.would_render(scene, ())
    return any(map(_is_cube, objects)) and all(_is_cube(o) or _is_lamp(o) for o in objects)


def _is_cube(obj):
    if obj.type != "MESH" or len(obj.data.vertices) != 8 or obj.modifiers:
        return False
    return _stands_at(obj, _CUBE) and np.allclose(obj.dimensions, _SIDE)


def _is_lamp(obj):
    if obj.type != "LIGHT" or obj.data.type != "POINT":
        return False
    return _stands_at(obj, _LAMP) and obj.data.energy == _POWER


def _stands_at(obj, place):
    return np.allclose(obj.matrix_world.translation, place, atol=1e-3)
