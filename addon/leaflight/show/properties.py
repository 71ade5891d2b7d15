# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of an object about its volume and its bake: Object.leaflight."""

from contextlib import suppress

import bpy
from leaflight import LeaflightError
from leaflight.color_maps import CATEGORICAL, MAPS
from leaflight.scene.volume_texture import MOST_STEPS

from ..props import (
    BoolProperty,
    CollectionProperty,
    ColorProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
)
from . import color_bar, display, isovalues, label_list, surface_object, texture, walls
from .bake_properties import BakeOptions, BakeRecord
from .volume_properties import VolumeSource, shape_changed

# Color map of slices.
_GRAY = "CET_L1"
SCATTERING_ITEMS = [
    ("DIFFUSE", "Diffuse", "Reflects light equally in all directions"),
    ("MIRROR", "Mirror", "Reflects light like a polished mirror"),
    ("GLASS", "Glass", "Reflects and refracts light like polished glass"),
]


_shading_changed = display.on_volume(surface_object.shade_all)


# The ends of a color map before a volume is chosen.
_NO_RANGE = 0.0, 1.0


def _can_color(settings, obj):
    return obj.leaflight.is_volume and obj != settings.id_data


def _texture_chosen(settings, context):
    """Hides the volumes of the colors, and shows their whole range, or the labels."""
    _show_whole_range(settings)
    others = texture.volumes_that_color(settings.id_data)
    if others and others[0].leaflight.labels:
        settings.texture_kind = "LABELS"
    _texture_changed(settings, context)


def _show_whole_range(settings):
    obj = settings.id_data
    ranges = [texture.begin(other) for other in texture.volumes_that_color(obj)]
    if ranges:
        lows, highs = zip(*ranges)
        settings["texture_low"], settings["texture_high"] = min(lows), max(highs)
    elif settings.texture_kind in texture.OWN and settings.is_volume:
        # An unreadable volume shows its error elsewhere.
        with suppress(LeaflightError):
            settings["texture_low"], settings["texture_high"] = texture.own_range(obj)


def _channel_chosen(settings, context):
    chosen = settings.texture_low, settings.texture_high
    _show_whole_range(settings)
    if chosen != _NO_RANGE:
        settings["texture_low"], settings["texture_high"] = chosen
    _texture_changed(settings, context)


def _kind_changed(settings, context):
    if settings.texture_kind == "LABELS":
        for other in texture.volumes_that_color(settings.id_data):
            label_list.fill_if_empty(other)
    else:
        if settings.texture_kind == "SLICES" and not settings.is_property_set("texture_map"):
            settings.texture_map = _GRAY
        _show_whole_range(settings)
    _texture_changed(settings, context)


@display.on_volume
def _texture_changed(obj):
    surface_object.update_all(obj)
    color_bar.update(obj)


class LeaflightColorStop(bpy.types.PropertyGroup):
    """The albedo at one isovalue. It is linear between two stops."""

    isovalue: FloatProperty(
        "Isovalue",
        "Isovalue whose isosurface has this color, in data units",
        update=_shading_changed,
    )
    color: ColorProperty(
        "Color", "Share of the light that the isosurface reflects", update=_shading_changed
    )


class Isosurfaces:
    """The material of the isosurfaces, and their shading."""

    isosurface_scattering: EnumProperty("Material", items=SCATTERING_ITEMS, update=_shading_changed)
    isosurface_albedo: ColorProperty(
        "Albedo", "Albedo of the isosurfaces, or color of mirror or glass", update=_shading_changed
    )
    isosurface_stops: CollectionProperty(
        LeaflightColorStop, "Color Ramp", "Albedo as a function of the isovalue"
    )
    isosurface_stop: IntProperty("Active Stop")
    texture_volume: PointerProperty(
        bpy.types.Object,
        "Color By",
        "Volume whose values color the isosurfaces of this one. It is hidden",
        poll=_can_color,
        update=_texture_chosen,
    )
    texture_map: EnumProperty(
        "Color Map",
        "Colors from the lowest to the highest value",
        [(key, name, text) for key, (name, text, _) in {**MAPS, **CATEGORICAL}.items()],
        update=_texture_changed,
    )
    texture_low: FloatProperty(
        "From", "Value at the lower end of the color map, in data units", update=_texture_changed
    )
    texture_high: FloatProperty(
        "To",
        "Value at the upper end of the color map, in data units",
        _NO_RANGE[1],
        update=_texture_changed,
    )
    texture_reverse: BoolProperty(
        "Reversed", "Exchange the ends of the color map", update=_texture_changed
    )
    texture_symmetric: BoolProperty(
        "Symmetric",
        "Extend the range to be even about 0, so that the middle of the color map is 0",
        update=_texture_changed,
    )
    texture_steps: IntProperty(
        "Steps",
        "Number of separate colors; 0 is smooth",
        min=0,
        max=MOST_STEPS,
        soft_max=12,
        update=_texture_changed,
    )
    texture_kind: EnumProperty(
        "Colors",
        "Source and meaning of the colors",
        [
            ("MAP", "Color Map", "A color map over the values"),
            ("LABELS", "Labels", "Each whole number has its own color, without colors between"),
            ("CHANNELS", "Red, Green, Blue", "Three volumes are red, green and blue"),
            ("GRADIENT", "Gradient", "A color map over the change of the values per length"),
            ("HEIGHT", "Height", "A color map over the height, in the coordinates of the file"),
            ("SLICES", "Slices on Cuts", "A color map over the uncut values, on flat cuts only"),
        ],
        update=_kind_changed,
    )
    texture_green: PointerProperty(
        bpy.types.Object,
        "Green",
        "Volume whose values are green. It is hidden",
        poll=_can_color,
        update=_channel_chosen,
    )
    texture_blue: PointerProperty(
        bpy.types.Object,
        "Blue",
        "Volume whose values are blue. It is hidden",
        poll=_can_color,
        update=_channel_chosen,
    )
    texture_srgb: BoolProperty(
        "sRGB",
        "Take the values for those of a picture, whose bytes follow the curve of sRGB",
        update=_texture_changed,
    )
    isosurface_ior: FloatProperty(
        "IOR",
        "Index of refraction of the inside of the isosurfaces",
        1.45,
        min=1.0,
        soft_max=3.0,
        update=_shading_changed,
    )
    isosurface_emission: ColorProperty(
        "Emission",
        "Color of the light that the isosurfaces emit",
        default=(1.0, 1.0, 1.0),
        update=_shading_changed,
    )
    isosurface_emission_strength: FloatProperty(
        "Strength",
        "Radiance that the isosurfaces emit; 0 is none",
        min=0.0,
        soft_max=100.0,
        update=_shading_changed,
    )
    capped: BoolProperty(
        "Capped", "Close the isosurfaces at the border of the volume", update=shape_changed
    )
    linked: BoolProperty(
        "Linked",
        "Move the isovalue together with those of the other volumes, so that all show "
        "the same common isovalue",
        True,
    )
    shading: EnumProperty(
        "Shading",
        "Method of coloring the surface by the baked radiance",
        [
            ("ATTRIBUTE", "Vertices", "Interpolate the radiance at the mesh's vertices"),
            ("ATLAS", "Volume Texture", "Look up the baked texels, whose shadows are blurred"),
        ],
        update=_shading_changed,
    )
    isosurface_material: PointerProperty(bpy.types.Material)
    baked_material: PointerProperty(bpy.types.Material)


ISOVALUE_PATH = isovalues.ISOVALUE_PATH


def _walls_changed(_settings, context):
    walls.refresh(context.scene)


class LeaflightSettings(
    VolumeSource, Isosurfaces, BakeOptions, BakeRecord, bpy.types.PropertyGroup
):
    """The volume of an object, the settings of its bake, and the bake that lights it.

    The isovalue is an ID property, because only these can take their limits from the data. Scripts
    read and write it as `isovalue`. ISOVALUE_PATH animates it.
    """

    is_volume: BoolProperty("Leaflight Volume")
    labels: CollectionProperty(
        label_list.LeaflightLabel, "Labels", "Labels of a label map, with names and colors"
    )
    label: IntProperty("Active Label")

    @property
    def isovalue(self):
        """The isovalue in data units. An evaluated object has the animated value."""
        return self["isovalue"]

    @isovalue.setter
    def isovalue(self, value):
        self["isovalue"] = float(value)
        self.id_data.update_tag()
        isovalues.set_isovalue(self.id_data, float(value))

    def limit_isovalue(self, data_range, isovalue_range, default):
        """Limits the slider to the data range, and softly to the isovalue range."""
        low, high = data_range
        self.property_overridable_library_set('["isovalue"]', True)
        self.id_properties_ui("isovalue").update(
            description="Isovalue of the displayed surface, in data units",
            min=low,
            max=high,
            default=default,
            step=max((high - low) / 255.0, 1e-6),
            precision=3 if high - low > 1.0 else 6,
        )
        self.limit_softly(isovalue_range)

    def limit_softly(self, isovalue_range):
        """Limits the slider softly to the isovalue range, within the data range of before."""
        limits = self.id_properties_ui("isovalue")
        low, high = (limits.as_dict()[end] for end in ("min", "max"))
        limits.update(soft_min=max(low, isovalue_range[0]), soft_max=min(high, isovalue_range[1]))


class LeaflightSceneSettings(bpy.types.PropertyGroup):
    """Settings for all volumes of a scene: Scene.leaflight."""

    show_walls: bpy.props.BoolProperty(
        name="Show Lit Walls",
        description="Show walls with the baked light of the shown isosurface, instead of the "
        "original objects. Turn it off to edit these",
        default=True,
        update=_walls_changed,
    )
    active_volume: bpy.props.StringProperty(name="Volume That Was Active Last")


PROPERTIES = (
    (bpy.types.Object, "leaflight", PointerProperty(LeaflightSettings)),
    (bpy.types.Scene, "leaflight", bpy.props.PointerProperty(type=LeaflightSceneSettings)),
)
