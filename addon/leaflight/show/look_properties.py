# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""How an isosurface is shown: Object.leaflight_look, of volumes and of what was added to them."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty
from bpy.props import PointerProperty

from . import added, surface_object


def _changed(look, _context):
    if added.is_isosurface(look.id_data):
        surface_object.shade(look.id_data)


def _all_changed(look, _context):
    if look.id_data.leaflight.is_volume:
        surface_object.shade_all(look.id_data)


def _color_chosen(look, _context):
    # Who sets a color wants it to count.
    look.use_color = True


def _has_box(_look, obj):
    return not added.is_isosurface(obj) and obj.type not in {"LIGHT", "CAMERA", "SPEAKER"}


class LeaflightLook(bpy.types.PropertyGroup):
    opacity: FloatProperty(
        name="Opacity",
        description="How much of what lies behind the isosurface it hides. Its light is that of an "
        "opaque one: isosurfaces that are shown together neither light nor shade each other",
        subtype="FACTOR",
        default=1.0,
        min=0.0,
        max=1.0,
        update=_changed,
        override={"LIBRARY_OVERRIDABLE"},
    )
    use_color: BoolProperty(
        name="Own Color",
        description="Show this isosurface in a color of its own instead of the albedo that its "
        "volume has there",
        update=_changed,
        override={"LIBRARY_OVERRIDABLE"},
    )
    color: FloatVectorProperty(
        name="Color",
        description="Share of the light that this isosurface reflects. The light that falls upon it "
        "stays that of the bake; for light of its own color, add a stop to the volume's color ramp "
        "here, and bake",
        subtype="COLOR",
        default=(0.8, 0.8, 0.8),
        min=0.0,
        max=1.0,
        update=_color_chosen,
        override={"LIBRARY_OVERRIDABLE"},
    )
    is_cut: BoolProperty(
        name="Cut",
        description="The clip box cuts this isosurface",
        default=True,
        update=_changed,
        override={"LIBRARY_OVERRIDABLE"},
    )
    box: PointerProperty(
        name="Clip Box",
        description="Object whose bounding box, or Empty whose cube, cuts the isosurfaces. Their "
        "light stays that of the whole ones: what is cut away still throws its shadow",
        type=bpy.types.Object,
        poll=_has_box,
        update=_all_changed,
        override={"LIBRARY_OVERRIDABLE"},
    )
    keep: EnumProperty(
        name="Keep",
        description="Which part of the isosurfaces stays",
        items=[
            ("OUTSIDE", "Outside", "Cut away what lies in the box"),
            ("INSIDE", "Inside", "Show only what lies in the box"),
        ],
        update=_all_changed,
        override={"LIBRARY_OVERRIDABLE"},
    )


def register():
    bpy.utils.register_class(LeaflightLook)
    bpy.types.Object.leaflight_look = PointerProperty(
        type=LeaflightLook, override={"LIBRARY_OVERRIDABLE"}
    )


def unregister():
    del bpy.types.Object.leaflight_look
    bpy.utils.unregister_class(LeaflightLook)
