# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of Object.leaflight about the material of its isosurfaces."""

import bpy

from . import surface_object
from .overridable import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
)
from .source_properties import shape_changed

SCATTERING_ITEMS = [
    ("DIFFUSE", "Diffuse", "Reflects light alike in all directions"),
    ("MIRROR", "Mirror", "Reflects light as a polished mirror"),
    ("GLASS", "Glass", "Reflects and refracts light as polished glass, denser inside"),
]


def _shading_changed(settings, _context):
    if settings.id_data.leaflight.is_volume:
        surface_object.shade_all(settings.id_data)


class LeaflightColorStop(bpy.types.PropertyGroup):
    """The albedo at one isovalue; between two stops it is blended linearly."""

    isovalue: FloatProperty(
        name="Isovalue",
        description="Isovalue whose isosurface has this color, in data units",
        update=_shading_changed,
    )
    color: FloatVectorProperty(
        name="Color",
        description="Share of the light that the isosurface reflects",
        subtype="COLOR",
        default=(0.8, 0.8, 0.8),
        min=0.0,
        max=1.0,
        update=_shading_changed,
    )


class Isosurfaces:
    """The material of the isosurfaces, and how they are shaded."""

    isosurface_scattering: EnumProperty(
        name="Material", items=SCATTERING_ITEMS, update=_shading_changed
    )
    isosurface_albedo: FloatVectorProperty(
        name="Albedo",
        description="Share of the light that the isosurfaces reflect; the color of mirror or glass",
        subtype="COLOR",
        default=(0.8, 0.8, 0.8),
        min=0.0,
        max=1.0,
        update=_shading_changed,
    )
    isosurface_stops: CollectionProperty(
        type=LeaflightColorStop,
        name="Color Ramp",
        description="Albedo as a function of the isovalue",
    )
    isosurface_stop: IntProperty(name="Active Stop")
    isosurface_ior: FloatProperty(
        name="IOR",
        description="Index of refraction of the inside of the isosurfaces",
        default=1.45,
        min=1.0,
        soft_max=3.0,
        update=_shading_changed,
    )
    isosurface_emission: FloatVectorProperty(
        name="Emission",
        description="Color of the light that the isosurfaces send by themselves",
        subtype="COLOR",
        default=(1.0, 1.0, 1.0),
        min=0.0,
        max=1.0,
        update=_shading_changed,
    )
    isosurface_emission_strength: FloatProperty(
        name="Strength",
        description="Radiance that the isosurfaces send by themselves; 0 for none",
        default=0.0,
        min=0.0,
        soft_max=100.0,
        update=_shading_changed,
    )
    capped: BoolProperty(
        name="Capped",
        description="Close the isosurfaces where the border of the volume cuts them",
        update=shape_changed,
    )
    linked: BoolProperty(
        name="Linked",
        description="Move with the isovalues of the other volumes in the scene, so that all show "
        "the same coordinate c of the bake",
        default=True,
    )
    shading: EnumProperty(
        name="Shading",
        description="How the surface gets its colors from the baked radiance",
        items=[
            ("ATTRIBUTE", "Vertices", "Interpolate the radiance at the mesh's vertices"),
            ("ATLAS", "Volume Texture", "Look up the baked texels, whose shadows are blurred"),
        ],
        update=_shading_changed,
    )
    isosurface_material: PointerProperty(type=bpy.types.Material)
    baked_material: PointerProperty(type=bpy.types.Material)
