# SPDX-License-Identifier: GPL-3.0-or-later
"""What the graph of an image remembers: Object.leaflight_flat."""

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from .. import versions
from . import graph_object
from .bake_options import ERROR


def _changed(settings, _context):
    if settings.is_flatland:
        graph_object.rebuild(settings.id_data)


class LeaflightFlatSettings(bpy.types.PropertyGroup):
    """A graph, its isolines and how they are baked: Object.leaflight_flat."""

    source: StringProperty(
        name="Image",
        description="File of the image; empty is the bump box",
        subtype="FILE_PATH",
        options=versions.RELATIVE_PATH,
    )
    nodes: IntProperty(name="Nodes", default=200, min=4)
    height: FloatProperty(
        name="Height",
        description="Height of the graph as part of its longest side",
        default=0.25,
        min=0.0,
        soft_max=1.0,
        update=_changed,
    )
    low: FloatProperty(
        name="Lowest Isovalue", description="Lowest isovalue that is lit", update=_changed
    )
    high: FloatProperty(
        name="Highest Isovalue", description="Highest isovalue that is lit", update=_changed
    )
    count: IntProperty(
        name="Isolines",
        description="Number of isolines, spread evenly between lowest and highest isovalue",
        default=12,
        min=1,
        soft_max=100,
        update=_changed,
    )
    width: FloatProperty(
        name="Line Width",
        description="Width of the isolines as part of the longest side of the image",
        default=0.008,
        min=1e-5,
        soft_max=0.1,
        update=_changed,
    )
    brightness_correction: BoolProperty(
        name="Brightness Correction",
        description="Multiply the light of the plane by 2 / pi, about as bright as the same scene "
        "in space",
        default=True,
        update=_changed,
    )
    scene_file: StringProperty(
        name="Scene",
        description="Scene file of flatland with walls and lamps; empty is the flatland box",
        subtype="FILE_PATH",
        options=versions.RELATIVE_PATH,
    )
    resolution: IntProperty(
        name="Resolution",
        description="Texels along the longest side; 0 takes as many as the image needs",
        min=0,
        soft_max=4096,
    )
    error: FloatProperty(**ERROR)
    seed: IntProperty(name="Seed", description="Seed of the random numbers", min=0)
    bake_id: StringProperty(name="Bake Identifier")
    is_flatland: BoolProperty(name="Leaflight Flatland")


CLASSES = (LeaflightFlatSettings,)
PROPERTIES = ((bpy.types.Object, "leaflight_flat", PointerProperty(type=LeaflightFlatSettings)),)
