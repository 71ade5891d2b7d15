# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's properties, for objects whose library overrides may have values of their own."""

from functools import partial
from typing import Literal

import bpy

_OVERRIDABLE: set[Literal["LIBRARY_OVERRIDABLE"]] = {"LIBRARY_OVERRIDABLE"}

BoolProperty = partial(bpy.props.BoolProperty, override=_OVERRIDABLE)
BoolVectorProperty = partial(bpy.props.BoolVectorProperty, override=_OVERRIDABLE)
CollectionProperty = partial(
    bpy.props.CollectionProperty, override={"LIBRARY_OVERRIDABLE", "USE_INSERTION"}
)
EnumProperty = partial(bpy.props.EnumProperty, override=_OVERRIDABLE)
FloatProperty = partial(bpy.props.FloatProperty, override=_OVERRIDABLE)
FloatVectorProperty = partial(bpy.props.FloatVectorProperty, override=_OVERRIDABLE)
IntProperty = partial(bpy.props.IntProperty, override=_OVERRIDABLE)
IntVectorProperty = partial(bpy.props.IntVectorProperty, override=_OVERRIDABLE)
PointerProperty = partial(bpy.props.PointerProperty, override=_OVERRIDABLE)
StringProperty = partial(bpy.props.StringProperty, override=_OVERRIDABLE)

# Of a surface: a share of 0 to 1, and a color whose channels are such shares.
ShareProperty = partial(FloatProperty, subtype="FACTOR", min=0.0, max=1.0)
ColorProperty = partial(
    FloatVectorProperty, subtype="COLOR", default=(0.8, 0.8, 0.8), min=0.0, max=1.0
)
