# SPDX-License-Identifier: GPL-3.0-or-later
# flake8: noqa: F722,F821  (Blender declares properties as annotations)
"""What an object remembers about its volume and its bake: Object.leaflight."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    IntVectorProperty,
    PointerProperty,
    StringProperty,
)

from .. import versions
from . import isovalues, surface_object, walls

VALUE_TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")

ISOVALUE_PATH = isovalues.ISOVALUE_PATH
VALUE_TYPE_ITEMS = [(name, name, f"Values of type {name}") for name in VALUE_TYPES]
ENDIAN_ITEMS = [
    ("little", "Little Endian", "Least significant byte first"),
    ("big", "Big Endian", "Most significant byte first"),
]


SCATTERING_ITEMS = [
    ("DIFFUSE", "Diffuse", "Reflects light alike in all directions"),
    ("MIRROR", "Mirror", "Reflects light as a polished mirror"),
    ("GLASS", "Glass", "Reflects and refracts light as polished glass, denser inside"),
]


# What users choose from, each with the error that it stands for, in percent.
QUALITIES = {"DRAFT": 4.0, "GOOD": 1.5, "FINAL": 0.7}
QUALITY_ITEMS = [
    ("DRAFT", "Draft", "A quick look, with grain"),
    ("GOOD", "Good", "Hardly any grain: right for most work"),
    ("FINAL", "Final", "For stills that are looked at closely: several times the time of Good"),
    ("CUSTOM", "Custom", "The error that is set under Advanced"),
]

# Of the property Error, in percent of the displayable range.
ERROR = {
    "subtype": "PERCENTAGE",
    "default": QUALITIES["GOOD"],
    "min": 0.01,
    "soft_min": 0.2,
    "soft_max": 10.0,
    "max": 100.0,
    "precision": 2,
}

# A library override may have other settings, and a bake of its own.
_OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}
_INSERTABLE = {"LIBRARY_OVERRIDABLE", "USE_INSERTION"}


def _shading_changed(settings, _context):
    if settings.id_data.leaflight.is_volume:
        surface_object.shade_all(settings.id_data)


def _quality(settings):
    """The number of the item that the error stands for."""
    near = (n for n, error in enumerate(QUALITIES.values()) if abs(settings.error - error) < 1e-3)
    return next(near, len(QUALITIES))


def _set_quality(settings, number):
    if number < len(QUALITIES):
        settings.error = list(QUALITIES.values())[number]


def _switches_on(name):
    """Setting a value enables it."""

    def changed(settings, _context):
        setattr(settings, name, True)

    return changed


def _shape_changed(settings, _context):
    if settings.is_volume:
        surface_object.update(settings.id_data, settings.isovalue)
        surface_object.update_all(settings.id_data)


def _frame_changed(settings, _context):
    if settings.is_volume:
        isovalues.show_frame(settings.id_data)


def _walls_changed(_settings, context):
    walls.refresh(context.scene)


class LeaflightColorStop(bpy.types.PropertyGroup):
    """The albedo at one isovalue; between two stops it is blended linearly."""

    isovalue: FloatProperty(
        name="Isovalue",
        description="Isovalue whose isosurface has this color, in data units",
        update=_shading_changed,
        override=_OVERRIDABLE,
    )
    color: FloatVectorProperty(
        name="Color",
        description="Share of the light that the isosurface reflects",
        subtype="COLOR",
        default=(0.8, 0.8, 0.8),
        min=0.0,
        max=1.0,
        update=_shading_changed,
        override=_OVERRIDABLE,
    )


class LeaflightSettings(bpy.types.PropertyGroup):
    """The volume of an object, how it is baked, and the bake that lights it.

    The isovalue is an ID property, because only these take their limits from the data; `isovalue`
    reads and writes it in scripts, ISOVALUE_PATH animates it.
    """

    source: StringProperty(
        name="Volume",
        description="File that the volume was read from",
        subtype="FILE_PATH",
        options=versions.RELATIVE_PATH,
        override=_OVERRIDABLE,
    )
    dims: IntVectorProperty(name="Dimensions", size=3, min=0, override=_OVERRIDABLE)
    value_type: EnumProperty(name="Type", items=VALUE_TYPE_ITEMS, override=_OVERRIDABLE)
    endian: EnumProperty(name="Byte Order", items=ENDIAN_ITEMS, override=_OVERRIDABLE)
    spacing: FloatVectorProperty(
        name="Voxel Size", size=3, default=(1.0, 1.0, 1.0), override=_OVERRIDABLE
    )
    use_spacing: BoolProperty(
        name="Own Voxel Size",
        description="The voxel size was given, and not taken from the file",
        default=True,
        override=_OVERRIDABLE,
    )
    frame: IntProperty(name="Frame", default=-1, min=-1, override=_OVERRIDABLE)
    frames: IntProperty(
        name="Frames",
        description="Volumes of the file over time",
        default=1,
        min=1,
        override=_OVERRIDABLE,
    )
    shown_frame: IntProperty(
        name="Frame",
        description="Which volume of the file's series over time is shown, counted from 0. "
        "Keyframes play them. Each frame has a bake of its own",
        min=0,
        update=_frame_changed,
        override=_OVERRIDABLE,
    )
    frame_bakes: StringProperty(name="Bakes of the Other Frames", override=_OVERRIDABLE)
    channel: IntProperty(name="Channel", default=-1, min=-1, override=_OVERRIDABLE)
    level: IntProperty(name="Level", default=0, min=0, override=_OVERRIDABLE)
    dataset: StringProperty(name="Dataset", override=_OVERRIDABLE)
    downsample: IntProperty(name="Downsample", default=1, min=1, max=8, override=_OVERRIDABLE)
    smooth: FloatProperty(
        name="Smooth",
        description="Standard deviation, in voxels, of the Gaussian that smooths the values",
        default=0.0,
        min=0.0,
        max=10.0,
        options=set(),
        update=_shape_changed,
        override=_OVERRIDABLE,
    )
    unit: StringProperty(
        name="Unit", description="What the file measures lengths in", override=_OVERRIDABLE
    )

    low: FloatProperty(
        name="Lowest Isovalue",
        description="Lowest isovalue that the bake shall light",
        override=_OVERRIDABLE,
    )
    high: FloatProperty(
        name="Highest Isovalue",
        description="Highest isovalue that the bake shall light",
        override=_OVERRIDABLE,
    )
    isosurface_scattering: EnumProperty(
        name="Material", items=SCATTERING_ITEMS, update=_shading_changed, override=_OVERRIDABLE
    )
    isosurface_albedo: FloatVectorProperty(
        name="Albedo",
        description="Share of the light that the isosurfaces reflect; the color of mirror or glass",
        subtype="COLOR",
        default=(0.8, 0.8, 0.8),
        min=0.0,
        max=1.0,
        update=_shading_changed,
        override=_OVERRIDABLE,
    )
    isosurface_stops: CollectionProperty(
        type=LeaflightColorStop,
        name="Color Ramp",
        description="Albedo as a function of the isovalue",
        override=_INSERTABLE,
    )
    isosurface_stop: IntProperty(name="Active Stop", override=_OVERRIDABLE)
    isosurface_ior: FloatProperty(
        name="IOR",
        description="Index of refraction of the inside of the isosurfaces",
        default=1.45,
        min=1.0,
        soft_max=3.0,
        update=_shading_changed,
        override=_OVERRIDABLE,
    )
    isosurface_emission: FloatVectorProperty(
        name="Emission",
        description="Color of the light that the isosurfaces send by themselves",
        subtype="COLOR",
        default=(1.0, 1.0, 1.0),
        min=0.0,
        max=1.0,
        update=_shading_changed,
        override=_OVERRIDABLE,
    )
    isosurface_emission_strength: FloatProperty(
        name="Strength",
        description="Radiance that the isosurfaces send by themselves; 0 for none",
        default=0.0,
        min=0.0,
        soft_max=100.0,
        update=_shading_changed,
        override=_OVERRIDABLE,
    )
    capped: BoolProperty(
        name="Capped",
        description="Close the isosurfaces where the border of the volume cuts them",
        update=_shape_changed,
        override=_OVERRIDABLE,
    )
    linked: BoolProperty(
        name="Linked",
        description="Move with the isovalues of the other volumes in the scene, so that all show "
        "the same coordinate c of the bake",
        default=True,
        override=_OVERRIDABLE,
    )
    use_resolution: BoolProperty(
        name="Own Resolution",
        description="Choose the number of texels yourself, where a volume is too large for the "
        "memory or the time at hand. Otherwise it follows from the voxels",
        override=_OVERRIDABLE,
    )
    resolution: IntProperty(
        name="Texels",
        description="Texels along the longest side of the volume. Fewer are faster and blur the "
        "light",
        default=128,
        min=2,
        soft_max=1024,
        update=_switches_on("use_resolution"),
        override=_OVERRIDABLE,
    )
    quality: EnumProperty(
        name="Quality",
        description="How exact the bake shall be",
        items=QUALITY_ITEMS,
        get=_quality,
        set=_set_quality,
    )
    error: FloatProperty(
        name="Error",
        description="The bake goes on until its error is this, in percent of the displayable "
        "range. Change it where Draft, Good and Final leave too much grain or take too long",
        **ERROR,
        override=_OVERRIDABLE,
    )
    use_time_limit: BoolProperty(
        name="Time Limit",
        description="End the bake after some time, whatever its error is then. Continue goes on "
        "with it later",
        override=_OVERRIDABLE,
    )
    time_limit: FloatProperty(
        name="Seconds",
        description="Seconds after which the bake ends with what it has",
        subtype="TIME_ABSOLUTE",
        default=60.0,
        min=0.1,
        soft_max=600.0,
        precision=1,
        update=_switches_on("use_time_limit"),
        override=_OVERRIDABLE,
    )
    seed: IntProperty(
        name="Seed",
        description="Start of the random numbers. Another seed gives other noise, which shows "
        "noise from detail",
        min=0,
        override=_OVERRIDABLE,
    )
    both_sides: BoolProperty(
        name="Both Sides",
        description="Bake the backs of the isosurfaces, too: for volumes that are cut open. Nearly "
        "doubles the time",
        override=_OVERRIDABLE,
    )
    light_walls: BoolProperty(
        name="Light the Walls",
        description="Bake the light on the walls for every isovalue, too: their shadows and color "
        "bleeding then follow the isosurface",
        override=_OVERRIDABLE,
    )
    bake_folder: StringProperty(
        name="Folder",
        description="Folder that keeps the bakes, each in a file of its own; empty is the folder "
        "leaflight beside the .blend",
        subtype="DIR_PATH",
        options=versions.RELATIVE_PATH,
        override=_OVERRIDABLE,
    )

    shading: EnumProperty(
        name="Shading",
        description="How the surface gets its colors from the baked radiance",
        items=[
            ("ATTRIBUTE", "Vertex Attribute", "Interpolate the radiance at the mesh's vertices"),
            ("ATLAS", "Volume Texture", "Look up the baked texels, whose shadows are blurred"),
        ],
        update=_shading_changed,
        override=_OVERRIDABLE,
    )

    bake_path: StringProperty(
        name="Bake", subtype="FILE_PATH", options=versions.RELATIVE_PATH, override=_OVERRIDABLE
    )
    bake_matrix: FloatVectorProperty(
        name="Transform at the Bake, Row by Row", size=16, override=_OVERRIDABLE
    )
    bake_fingerprint: StringProperty(name="Scene at the Bake", override=_OVERRIDABLE)
    bake_lamps: StringProperty(name="Lamps at the Bake", override=_OVERRIDABLE)
    bake_id: StringProperty(name="Bake Identifier", override=_OVERRIDABLE)
    bake_home: StringProperty(name="Folder Where the Bake Was Last", override=_OVERRIDABLE)
    bake_values: StringProperty(name="Hash of the Values at the Bake", override=_OVERRIDABLE)
    bake_file_state: StringProperty(name="Volume File at the Bake", override=_OVERRIDABLE)
    bake_smooth: FloatProperty(name="Smoothing at the Bake", override=_OVERRIDABLE)
    bake_index: IntProperty(name="Place Among the Volumes Baked Together", override=_OVERRIDABLE)
    bake_low: FloatProperty(name="Lowest Isovalue of the Bake", override=_OVERRIDABLE)
    bake_high: FloatProperty(name="Highest Isovalue of the Bake", override=_OVERRIDABLE)
    bake_walls: BoolProperty(name="Walls Lit by the Bake", override=_OVERRIDABLE)
    bake_seconds: FloatProperty(name="Bake Time", override=_OVERRIDABLE)
    bake_outcome: StringProperty(name="Error That the Bake Reached", override=_OVERRIDABLE)
    bake_error: FloatProperty(name="Estimated Error of the Bake", override=_OVERRIDABLE)
    bake_target: FloatProperty(name="Target of the Bake", override=_OVERRIDABLE)
    bake_warnings: StringProperty(name="Warnings of the Bake", override=_OVERRIDABLE)
    comparison: StringProperty(name="Last Comparison", override=_OVERRIDABLE)
    atlas_columns: IntProperty(
        name="Columns of the Atlas, 0 if There Is None", override=_OVERRIDABLE
    )
    isosurface_material: PointerProperty(type=bpy.types.Material, override=_OVERRIDABLE)
    baked_material: PointerProperty(type=bpy.types.Material, override=_OVERRIDABLE)

    is_volume: BoolProperty(name="Leaflight Volume", override=_OVERRIDABLE)

    @property
    def isovalue(self):
        """The isovalue in data units; of an evaluated object, with its animation applied."""
        return self["isovalue"]

    @isovalue.setter
    def isovalue(self, value):
        self["isovalue"] = float(value)
        self.id_data.update_tag()
        isovalues.set_isovalue(self.id_data, float(value))

    def limit_isovalue(self, data_range, isovalue_range, default):
        """Limits the slider to the range of the data, and softly to the isovalue range."""
        low, high = data_range
        self.property_overridable_library_set('["isovalue"]', True)
        self.id_properties_ui("isovalue").update(
            description="Isovalue of the displayed surface, in data units",
            min=low,
            max=high,
            soft_min=max(low, isovalue_range[0]),
            soft_max=min(high, isovalue_range[1]),
            default=default,
            step=max((high - low) / 255.0, 1e-6),
            precision=3 if high - low > 1.0 else 6,
        )


class LeaflightSceneSettings(bpy.types.PropertyGroup):
    """What concerns all volumes of a scene: Scene.leaflight."""

    show_walls: BoolProperty(
        name="Show Lit Walls",
        description="Show the walls with the light of the present isosurface in place of "
        "the objects that were baked. Turn it off to edit these",
        default=True,
        update=_walls_changed,
    )
    active_volume: StringProperty(name="Volume That Was Active Last")


_CLASSES = (LeaflightColorStop, LeaflightSettings, LeaflightSceneSettings)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.leaflight = PointerProperty(type=LeaflightSettings, override=_OVERRIDABLE)
    bpy.types.Scene.leaflight = PointerProperty(type=LeaflightSceneSettings)


def unregister():
    del bpy.types.Scene.leaflight
    del bpy.types.Object.leaflight
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
