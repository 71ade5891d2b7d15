# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's properties with the option that library overrides may change them."""

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

# Properties of a surface: a share of 0 to 1, and a color with channels of 0 to 1.
ShareProperty = partial(FloatProperty, subtype="FACTOR", min=0.0, max=1.0)
ColorProperty = partial(
    FloatVectorProperty, subtype="COLOR", default=(0.8, 0.8, 0.8), min=0.0, max=1.0
)
