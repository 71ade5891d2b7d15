# SPDX-License-Identifier: GPL-3.0-or-later
"""The display of a volume or an added isosurface: Object.leaflight_look."""

import bpy

from . import data_faces, display, surface_object
from .overridable import (
    BoolProperty,
    BoolVectorProperty,
    ColorProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    PointerProperty,
    ShareProperty,
)


def _changed(look, _context):
    if display.is_isosurface(look.id_data):
        surface_object.shade(look.id_data)
        data_faces.update_cut(display.volume_object(look.id_data))


def _all_changed(look, _context):
    if look.id_data.leaflight.is_volume:
        surface_object.shade_all(look.id_data)
        data_faces.update_cut(look.id_data)


def _slices_changed(look, _context):
    if look.id_data.leaflight.is_volume:
        data_faces.update_slices(look.id_data)


def _shape_changed(look, _context):
    obj = look.id_data
    if display.is_isosurface(obj):
        surface_object.update(obj, surface_object.shown_isovalue(obj))


def _color_chosen(look, _context):
    # Setting a color enables it.
    look.use_color = True


def _has_box(_look, obj):
    return not display.is_isosurface(obj) and obj.type not in {"LIGHT", "CAMERA", "SPEAKER"}


class LeaflightLook(bpy.types.PropertyGroup):
    opacity: ShareProperty(
        name="Opacity",
        description="How much of what lies behind the isosurface it hides. Its light is that of an "
        "opaque one: isosurfaces that are shown together neither light nor shade each other",
        default=1.0,
        update=_changed,
    )
    use_color: BoolProperty(
        name="Own Color",
        description="Show this isosurface in a color of its own instead of the albedo that its "
        "volume has there",
        update=_changed,
    )
    color: ColorProperty(
        name="Color",
        description="Share of the light that this isosurface reflects. The light that falls on it "
        "stays that of the bake; for light of its own color, add a stop to the volume's color ramp "
        "here, and bake",
        update=_color_chosen,
    )
    dust: FloatProperty(
        name="Hide Dust",
        description="Hide separate parts of the isosurface that are shorter than so many voxels; 0 "
        "shows all. The light is that of the whole isosurface",
        default=0.0,
        min=0.0,
        soft_max=50.0,
        precision=1,
        update=_shape_changed,
        options=set(),
    )
    gloss: ShareProperty(
        name="Gloss",
        description="A clear coat over the baked light, in which the scene's own lamps shine; 1 is "
        "that of glazed china. Comparisons leave it out",
        update=_changed,
        options=set(),
    )
    roughness: ShareProperty(
        name="Roughness",
        description="How wide the highlights of the coat are",
        default=0.3,
        min=0.02,
        update=_changed,
        options=set(),
    )
    is_cut: BoolProperty(
        name="Cut",
        description="The clip box cuts this isosurface",
        default=True,
        update=_changed,
    )
    box: PointerProperty(
        name="Clip Box",
        description="Object whose bounding box, or Empty whose cube, cuts the isosurfaces. Their "
        "light stays that of the whole ones: what is cut away still throws its shadow",
        type=bpy.types.Object,
        poll=_has_box,
        update=_all_changed,
    )
    keep: EnumProperty(
        name="Keep",
        description="Part of the isosurfaces that stays",
        items=[
            ("OUTSIDE", "Outside", "Cut away what lies in the box"),
            ("INSIDE", "Inside", "Show only what lies in the box"),
        ],
        update=_all_changed,
    )
    cut_colors: EnumProperty(
        name="Cut",
        description="Appearance of the isosurfaces where the clip box cuts them open",
        items=data_faces.CUT_COLORS,
        default=data_faces.GRAY,
        update=_all_changed,
    )
    slice_axes: BoolVectorProperty(
        name="Slices",
        description="Show the data on a plane across this axis. Bakes do not see it",
        size=3,
        update=_slices_changed,
    )
    slice_places: FloatVectorProperty(
        name="Place",
        description="Where the plane is, from one end of the volume to the other",
        size=3,
        default=(0.5, 0.5, 0.5),
        min=0.0,
        max=1.0,
        update=_slices_changed,
    )
    slice_colors: EnumProperty(
        name="Colors",
        description="Colors of the values on the planes, over the volume's range of isovalues",
        items=data_faces.COLORS,
        default=data_faces.GRAY,
        update=_slices_changed,
    )
    slices_inside: BoolProperty(
        name="Inside Only",
        description="Show only what lies within the isosurface; else all values from Lowest on",
        update=_slices_changed,
    )


CLASSES = (LeaflightLook,)
PROPERTIES = ((bpy.types.Object, "leaflight_look", PointerProperty(type=LeaflightLook)),)
