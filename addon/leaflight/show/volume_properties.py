# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of Object.leaflight about the file of a volume."""

from leaflight.volume.units import METERS

from .. import versions
from . import isovalues, surface_object
from .overridable import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    IntVectorProperty,
    StringProperty,
)

_UNKNOWN = "UNKNOWN"
# Units as (symbol, identifier, description). Blender's identifiers are ASCII.
_NAMED_UNITS = [
    ("mm", "mm", "Millimeters, as CT and MRI have"),
    ("µm", "um", "Micrometers, as microscopes have"),
    ("nm", "nm", "Nanometers"),
    ("Å", "angstrom", "Angstroms, as molecules have"),
    ("bohr", "bohr", "Atomic units"),
    ("cm", "cm", "Centimeters"),
    ("m", "m", "Meters"),
]
assert {unit for unit, _, _ in _NAMED_UNITS} == {*METERS}
UNIT_ITEMS = [
    (_UNKNOWN, "Not Known", "The file does not say"),
    *((key, unit, text) for unit, key, text in _NAMED_UNITS),
]
_UNITS = ["", *(unit for unit, _, _ in _NAMED_UNITS)]
_UNIT_KEYS = [key for key, _, _ in UNIT_ITEMS]


def unit_of(key):
    """Returns the unit of an item: a key of METERS or an empty text."""
    return _UNITS[_UNIT_KEYS.index(key)]


def unit_number(unit):
    """Returns the index of the item of a unit."""
    return _UNITS.index(unit)


def unit_at(number):
    """Returns the unit of the item at an index."""
    return _UNITS[number]


VALUE_TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")
VALUE_TYPE_ITEMS = [(name, name, f"Values of type {name}") for name in VALUE_TYPES]
ENDIAN_ITEMS = [
    ("little", "Little Endian", "Least significant byte first"),
    ("big", "Big Endian", "Most significant byte first"),
]


def shape_changed(settings, _context):
    if settings.is_volume:
        surface_object.update(settings.id_data, settings.isovalue)
        surface_object.update_all(settings.id_data)


def _frame_changed(settings, _context):
    if settings.is_volume:
        isovalues.show_frame(settings.id_data)


class ReadingChoices:
    """Which volume of a file is read, and how: as it was, and as it is to be on import."""

    dims: IntVectorProperty(
        name="Dimensions", description="Voxels along x, y and z of a .raw file", size=3, min=0
    )
    value_type: EnumProperty(
        name="Type",
        description="Type of the values in a .raw file",
        items=VALUE_TYPE_ITEMS,
    )
    endian: EnumProperty(
        name="Byte Order",
        description="Byte order of the values in a .raw file",
        items=ENDIAN_ITEMS,
    )
    skip: IntProperty(
        name="Skip",
        description="Bytes before the values in a .raw file; -1 if the values are its end",
        default=0,
        min=-1,
    )
    spacing: FloatVectorProperty(
        name="Voxel Size",
        description="Distance of the voxels along x, y and z",
        size=3,
        default=(1.0, 1.0, 1.0),
        min=1e-9,
    )
    frame: IntProperty(
        name="Frame",
        description="Which volume of a series to read, counted from 0; -1 for a single volume",
        default=-1,
        min=-1,
    )
    channel: IntProperty(
        name="Channel",
        description="Which of several values a voxel has to read, counted from 0; -1 where it has "
        "one",
        default=-1,
        min=-1,
    )
    level: IntProperty(
        name="Level", description="Which of several resolutions to read; 0 is the finest", min=0
    )


class VolumeSource(ReadingChoices):
    """The file of a volume, and how it is read."""

    source: StringProperty(
        name="Volume",
        description="File that the volume was read from",
        subtype="FILE_PATH",
        options=versions.RELATIVE_PATH,
    )
    use_spacing: BoolProperty(
        name="Own Voxel Size",
        description="The voxel size was given, and not taken from the file",
        default=True,
    )
    frames: IntProperty(
        name="Frames",
        description="Volumes of the file over time",
        default=1,
        min=1,
    )
    shown_frame: IntProperty(
        name="Frame",
        description="Which volume of the file's series over time is shown, counted from 0. "
        "Keyframes play them. Each frame has a bake of its own",
        min=0,
        update=_frame_changed,
    )
    frame_bakes: StringProperty(name="Bakes of the Other Frames")
    dataset: StringProperty(name="Dataset")
    downsample: IntProperty(name="Downsample", default=1, min=1, max=8)
    smooth: FloatProperty(
        name="Smooth",
        description="Standard deviation, in voxels, of the Gaussian that smooths the values",
        default=0.0,
        min=0.0,
        max=10.0,
        options=set(),
        update=shape_changed,
    )
    smooth_normals: FloatProperty(
        name="Smooth Normals",
        description="The same of the normals alone",
        default=0.0,
        min=0.0,
        max=10.0,
        options=set(),
        update=shape_changed,
    )
    origin: FloatVectorProperty(
        name="Origin",
        description="Place of the object's origin in the coordinates of the file, its middle",
        size=3,
    )
    unit: StringProperty(name="Unit", description="What the file measures lengths in")
    unit_choice: EnumProperty(
        name="Unit",
        description="What the coordinates of the file are measured in",
        items=UNIT_ITEMS,
        get=lambda settings: unit_number(settings.unit),
        set=lambda settings, number: setattr(settings, "unit", unit_at(number)),
    )
