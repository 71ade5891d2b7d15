# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's properties, which take name, description and default by position.

Library overrides may change them.
"""

from functools import partial

import bpy


def _maker(prop, *order, override=("LIBRARY_OVERRIDABLE",)):
    """Returns a function that makes properties. order: names of its positional arguments."""

    def make(*values, **options):
        return prop(**{"override": set(override), **dict(zip(order, values)), **options})

    return make


_WORDS = ("name", "description")
BoolProperty = _maker(bpy.props.BoolProperty, *_WORDS, "default")
BoolVectorProperty = _maker(bpy.props.BoolVectorProperty, *_WORDS, "size")
EnumProperty = _maker(bpy.props.EnumProperty, *_WORDS, "items")
FloatProperty = _maker(bpy.props.FloatProperty, *_WORDS, "default")
FloatVectorProperty = _maker(bpy.props.FloatVectorProperty, *_WORDS, "size")
IntProperty = _maker(bpy.props.IntProperty, *_WORDS, "default")
IntVectorProperty = _maker(bpy.props.IntVectorProperty, *_WORDS, "size")
StringProperty = _maker(bpy.props.StringProperty, *_WORDS, "default")
PointerProperty = _maker(bpy.props.PointerProperty, "type", *_WORDS)
CollectionProperty = _maker(
    bpy.props.CollectionProperty,
    *("type", *_WORDS),
    override=("LIBRARY_OVERRIDABLE", "USE_INSERTION"),
)

# Properties of a surface: a share of 0 to 1, and a color with channels of 0 to 1.
ShareProperty = partial(FloatProperty, subtype="FACTOR", min=0.0, max=1.0)
ColorProperty = partial(
    FloatVectorProperty, size=3, subtype="COLOR", default=(0.8, 0.8, 0.8), min=0.0, max=1.0
)
