# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of Object.leaflight about the file of a volume."""

from leaflight.volume.units import METERS

from .. import versions
from ..props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    IntVectorProperty,
    StringProperty,
)
from . import display, isovalues, surface_object

_UNKNOWN = "UNKNOWN"
# Units as (symbol, identifier, description). Blender's identifiers are ASCII.
_NAMED_UNITS = [
    ("mm", "mm", "Millimeters, as in CT and MRI"),
    ("µm", "um", "Micrometers, as in microscopy"),
    ("nm", "nm", "Nanometers"),
    ("Å", "angstrom", "Angstroms, as in chemistry"),
    ("bohr", "bohr", "Atomic units"),
    ("cm", "cm", "Centimeters"),
    ("m", "m", "Meters"),
]
assert {unit for unit, _, _ in _NAMED_UNITS} == {*METERS}
UNIT_ITEMS = [
    (_UNKNOWN, "Not Known", "Unit of the file is unknown"),
    *((key, unit, text) for unit, key, text in _NAMED_UNITS),
]
_UNITS = ["", *(unit for unit, _, _ in _NAMED_UNITS)]
_UNIT_KEYS = [key for key, _, _ in UNIT_ITEMS]


def unit_of(key):
    """Returns the unit of an item: a key of METERS or an empty text."""
    return _UNITS[_UNIT_KEYS.index(key)]


VALUE_TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")
VALUE_TYPE_ITEMS = [(name, name, f"Values of type {name}") for name in VALUE_TYPES]
ENDIAN_ITEMS = [
    ("little", "Little Endian", "Least significant byte first"),
    ("big", "Big Endian", "Most significant byte first"),
]


@display.on_volume
def shape_changed(obj):
    surface_object.update(obj, obj.leaflight.isovalue)
    surface_object.update_all(obj)


class ReadingChoices:
    """The form of the values in a file, for its reading at import or since."""

    dims: IntVectorProperty("Dimensions", "Voxels along x, y and z of a .raw file", 3, min=0)
    value_type: EnumProperty("Type", "Type of the values in a .raw file", VALUE_TYPE_ITEMS)
    endian: EnumProperty("Byte Order", "Byte order of the values in a .raw file", ENDIAN_ITEMS)
    skip: IntProperty(
        "Skip",
        "Bytes before the values of a .raw file; -1 if the values are at its end",
        min=-1,
    )
    spacing: FloatVectorProperty(
        "Voxel Size",
        "Distance of the voxels along x, y and z",
        3,
        default=(1.0, 1.0, 1.0),
        min=1e-9,
    )


def choice_of_part(**options):
    """Returns a class with the choice of a volume in a file. options: of its properties."""

    class Part:
        frame: IntProperty(
            "Frame",
            "Number of the volume in its series, counted from 0; -1 for a single volume",
            -1,
            min=-1,
            **options,
        )
        channel: IntProperty(
            "Channel",
            "Number of the channel to read, from 0; -1 if there is only one",
            -1,
            min=-1,
            **options,
        )
        level: IntProperty(
            "Level", "Number of the resolution to read; 0 is the finest", min=0, **options
        )

    return Part


class VolumeSource(ReadingChoices, choice_of_part()):
    """The file of a volume, and how it is read."""

    source: StringProperty(
        "Volume",
        "File that the volume was read from",
        subtype="FILE_PATH",
        options=versions.RELATIVE_PATH,
    )
    use_spacing: BoolProperty(
        "Own Voxel Size", "Use the given voxel size instead of the file's", True
    )
    frames: IntProperty("Frames", "Number of volumes over time in the file", 1, min=1)
    shown_frame: IntProperty(
        "Frame",
        "Number of the shown volume in the series over time, from 0. Keyframes play "
        "the series. Each frame has its own bake",
        min=0,
        update=display.on_volume(isovalues.show_frame),
    )
    frame_bakes: StringProperty("Bakes of the Other Frames")
    frame_regions: StringProperty("Regions of Each Frame")
    dataset: StringProperty("Dataset")
    brightest: IntVectorProperty("Channels", size=3, default=(-1, -1, -1), min=-1)
    downsample: IntProperty("Downsample", default=1, min=1, max=8)
    field: StringProperty("Field")
    regions: StringProperty("Regions", update=shape_changed)
    hide: StringProperty(
        "Hidden Labels", "Numbers of the labels that have no surface", update=shape_changed
    )
    smooth: FloatProperty(
        "Smooth",
        "Standard deviation, in voxels, of the Gaussian that smooths the values",
        min=0.0,
        max=10.0,
        options=set(),
        update=shape_changed,
    )
    smooth_normals: FloatProperty(
        "Smooth Normals",
        "Standard deviation, in voxels, of the Gaussian on the normals",
        min=0.0,
        max=10.0,
        options=set(),
        update=shape_changed,
    )
    origin: FloatVectorProperty(
        "Origin", "Position of the object's origin in the coordinates of the file", 3
    )
    unit: StringProperty("Unit", "Unit of lengths in the file")
    unit_choice: EnumProperty(
        "Unit",
        "Unit of the coordinates in the file",
        UNIT_ITEMS,
        get=lambda settings: _UNITS.index(settings.unit),
        set=lambda settings, number: setattr(settings, "unit", _UNITS[number]),
    )
