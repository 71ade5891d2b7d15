# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of props.py with the option that library overrides may change them."""

from functools import partial

from .. import props

_OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}

BoolProperty = partial(props.BoolProperty, override=_OVERRIDABLE)
BoolVectorProperty = partial(props.BoolVectorProperty, override=_OVERRIDABLE)
CollectionProperty = partial(
    props.CollectionProperty, override={"LIBRARY_OVERRIDABLE", "USE_INSERTION"}
)
EnumProperty = partial(props.EnumProperty, override=_OVERRIDABLE)
FloatProperty = partial(props.FloatProperty, override=_OVERRIDABLE)
FloatVectorProperty = partial(props.FloatVectorProperty, override=_OVERRIDABLE)
IntProperty = partial(props.IntProperty, override=_OVERRIDABLE)
IntVectorProperty = partial(props.IntVectorProperty, override=_OVERRIDABLE)
PointerProperty = partial(props.PointerProperty, override=_OVERRIDABLE)
StringProperty = partial(props.StringProperty, override=_OVERRIDABLE)

# Properties of a surface: a share of 0 to 1, and a color with channels of 0 to 1.
ShareProperty = partial(FloatProperty, subtype="FACTOR", min=0.0, max=1.0)
ColorProperty = partial(
    FloatVectorProperty, subtype="COLOR", default=(0.8, 0.8, 0.8), min=0.0, max=1.0
)
