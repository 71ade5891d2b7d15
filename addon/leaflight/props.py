# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's properties, which take name, description and default by position."""

import bpy


def _maker(prop, *order):
    """Returns a function that makes properties. order: names of its positional arguments."""

    def make(*values, **options):
        return prop(**dict(zip(order, values)), **options)

    return make


_WORDS = ("name", "description")
BoolProperty = _maker(bpy.props.BoolProperty, *_WORDS, "default")
BoolVectorProperty = _maker(bpy.props.BoolVectorProperty, *_WORDS, "size")
CollectionProperty = _maker(bpy.props.CollectionProperty, "type", *_WORDS)
EnumProperty = _maker(bpy.props.EnumProperty, *_WORDS, "items")
FloatProperty = _maker(bpy.props.FloatProperty, *_WORDS, "default")
FloatVectorProperty = _maker(bpy.props.FloatVectorProperty, *_WORDS, "size")
IntProperty = _maker(bpy.props.IntProperty, *_WORDS, "default")
IntVectorProperty = _maker(bpy.props.IntVectorProperty, *_WORDS, "size")
PointerProperty = _maker(bpy.props.PointerProperty, "type", *_WORDS)
StringProperty = _maker(bpy.props.StringProperty, *_WORDS, "default")
