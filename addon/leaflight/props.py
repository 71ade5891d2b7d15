# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's properties, which take name, description and default by position, and their drawing.

Library overrides may change them all.
"""

from functools import partial

import bpy


def _maker(prop, *order, override=("LIBRARY_OVERRIDABLE",)):
    """Returns a function that makes properties. order: names of its positional arguments."""

    def make(*values, **options):
        return prop(**dict(zip(order, values)), override={*override}, **options)

    return make


_WORDS = ("name", "description")
BoolProperty = _maker(bpy.props.BoolProperty, *_WORDS, "default")
BoolVectorProperty = _maker(bpy.props.BoolVectorProperty, *_WORDS, "size")
CollectionProperty = _maker(
    bpy.props.CollectionProperty, "type", *_WORDS, override=("LIBRARY_OVERRIDABLE", "USE_INSERTION")
)
EnumProperty = _maker(bpy.props.EnumProperty, *_WORDS, "items")
FloatProperty = _maker(bpy.props.FloatProperty, *_WORDS, "default")
FloatVectorProperty = _maker(bpy.props.FloatVectorProperty, *_WORDS, "size")
IntProperty = _maker(bpy.props.IntProperty, *_WORDS, "default")
IntVectorProperty = _maker(bpy.props.IntVectorProperty, *_WORDS, "size")
PointerProperty = _maker(bpy.props.PointerProperty, "type", *_WORDS)
StringProperty = _maker(bpy.props.StringProperty, *_WORDS, "default")

# Properties of a surface: a share of 0 to 1, and a color with channels of 0 to 1.
ShareProperty = partial(FloatProperty, subtype="FACTOR", min=0.0, max=1.0)
ColorProperty = partial(
    FloatVectorProperty, subtype="COLOR", default=(0.8, 0.8, 0.8), min=0.0, max=1.0
)


def draw(layout, owner, *names):
    """Draws properties below each other."""
    for name in names:
        layout.prop(owner, name)
