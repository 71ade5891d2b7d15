# SPDX-License-Identifier: GPL-3.0-or-later
"""The display of a volume or an added isosurface: Object.leaflight_look."""

from contextlib import suppress

import bpy
import numpy as np
from leaflight import LeaflightError

from ..props import (
    BoolProperty,
    BoolVectorProperty,
    ColorProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    PointerProperty,
    ShareProperty,
)
from ..store import cache
from . import data_faces, display, exploded, surface_object


def _changed(look, _context):
    if display.is_isosurface(look.id_data):
        surface_object.shade(look.id_data)
        data_faces.update_cut(display.volume_object(look.id_data))


@display.on_volume
def _all_changed(volume):
    surface_object.shade_all(volume)
    data_faces.update_cut(volume)


_slices_changed = display.on_volume(data_faces.update_slices)


def _shape_changed(look, _context):
    obj = look.id_data
    if display.is_isosurface(obj):
        surface_object.update(obj, surface_object.shown_isovalue(obj))


@display.on_volume
def _axis_chosen(volume):
    axis, look = exploded.axis_of(volume), volume.leaflight_look
    if axis is not None and look.explode_distance == 0:
        with suppress(LeaflightError):
            low, high = np.asarray(cache.volume_of(volume).field().bounds, np.float64)
            look.explode_distance = float((high - low) @ axis)
    surface_object.update_all(volume)
    _all_changed(look, None)


@display.on_volume
def _distance_changed(volume):
    for obj in display.surfaces_of(volume):
        surface_object.explode(obj, volume.leaflight_look.explode_distance)


def _color_chosen(look, _context):
    # Setting a color enables it.
    look.use_color = True


def _has_box(_look, obj):
    return not display.is_isosurface(obj) and obj.type not in {"LIGHT", "CAMERA", "SPEAKER"}


class LeaflightIsosurfaceDisplay(bpy.types.PropertyGroup):
    opacity: ShareProperty(
        "Opacity",
        "Opacity of the isosurface. Its light is that of an opaque one: isosurfaces "
        "that are shown together neither light nor shade each other",
        1.0,
        update=_changed,
    )
    use_color: BoolProperty(
        "Own Color",
        "Show this isosurface in another color than the albedo of the volume",
        update=_changed,
    )
    color: ColorProperty(
        "Color",
        "Albedo of this isosurface. The light that falls on it stays that of the "
        "bake. To bake the color, add a stop to the volume's color ramp",
        update=_color_chosen,
    )
    dust: FloatProperty(
        "Hide Dust",
        "Hide separate parts that are shorter than this many voxels; 0 shows all. "
        "Hidden parts still cast their shadows",
        min=0.0,
        soft_max=50.0,
        precision=1,
        update=_shape_changed,
        options=set(),
    )
    explode_axis: EnumProperty(
        "Explode",
        "Move connected parts apart along an axis of the data. Each keeps its baked light, that "
        "of the closed arrangement",
        exploded.AXES,
        update=_axis_chosen,
        options=set(),
    )
    explode_distance: FloatProperty(
        "Distance",
        "Distance by which the two outermost parts move apart, in the unit of the data. The "
        "parts between move in proportion",
        min=0.0,
        update=_distance_changed,
    )
    gloss: ShareProperty(
        "Gloss",
        "Weight of a clear coat that reflects the scene's lamps; 1 is glazed china. "
        "Comparisons leave it out",
        update=_changed,
        options=set(),
    )
    roughness: ShareProperty(
        "Roughness",
        "Roughness of the coat, which widens its highlights",
        0.3,
        min=0.02,
        update=_changed,
        options=set(),
    )
    is_cut: BoolProperty("Cut", "Cut this isosurface by the clip box", True, update=_changed)
    box: PointerProperty(
        bpy.types.Object,
        "Clip Box",
        "Object whose bounding box, or Empty whose cube, cuts the isosurfaces. Their "
        "light does not change: parts that are cut away still cast their shadows",
        poll=_has_box,
        update=_all_changed,
    )
    keep: EnumProperty(
        "Keep",
        "Part of the isosurfaces to keep",
        [
            ("OUTSIDE", "Outside", "Parts outside the box"),
            ("INSIDE", "Inside", "Parts inside the box"),
        ],
        update=_all_changed,
    )
    cut_colors: EnumProperty(
        "Cut",
        "Appearance of the faces where the clip box cuts",
        data_faces.CUT_COLORS,
        default=data_faces.GRAY,
        update=_all_changed,
    )
    slice_axes: BoolVectorProperty(
        "Slices",
        "Show the data on a plane across this axis. Bakes ignore the plane",
        3,
        update=_slices_changed,
    )
    slice_places: FloatVectorProperty(
        "Place",
        "Position of the plane, from one end of the volume to the other",
        3,
        default=(0.5, 0.5, 0.5),
        min=0.0,
        max=1.0,
        update=_slices_changed,
    )
    slice_colors: EnumProperty(
        "Colors",
        "Colors of the values on the planes, over the volume's isovalue range",
        data_faces.COLORS,
        default=data_faces.GRAY,
        update=_slices_changed,
    )
    slices_inside: BoolProperty(
        "Inside Only",
        "Show only data within the isosurface. Otherwise all values from Lowest on are shown",
        update=_slices_changed,
    )


PROPERTIES = ((bpy.types.Object, "leaflight_look", PointerProperty(LeaflightIsosurfaceDisplay)),)
