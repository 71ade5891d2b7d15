# SPDX-License-Identifier: GPL-3.0-or-later
"""The labels of a label map: names, colors and eyes. The object of the map stores them."""

import bpy
import numpy as np
from leaflight import LeaflightError
from leaflight.srgb import linear_from_srgb
from leaflight.volume.label_table import labels_of

from ..props import BoolProperty, ColorProperty, IntProperty
from ..store import cache
from . import surface_object, texture


def _colored_by(label_map):
    """Returns the objects whose isosurfaces have the colors of a label map."""
    volumes = (obj for obj in bpy.data.objects if obj.leaflight.is_volume)
    of_labels = (obj for obj in volumes if obj.leaflight.texture_kind == "LABELS")
    return [obj for obj in of_labels if texture.volumes_that_color(obj) == [label_map]]


class LeaflightLabel(bpy.types.PropertyGroup):
    """A label of a label map. Blender searches its list by the name."""

    number: IntProperty("Number", "Value of the label in the file")
    color: ColorProperty(
        "Color",
        "Color of the isosurface at this label",
        update=lambda label, _context: show_colors(label.id_data),
    )
    is_shown: BoolProperty(
        "Show",
        "Show the surface of this label. A bake keeps its labels, so bake again",
        True,
        update=lambda label, _context: show_eyes(label.id_data),
    )


def fill(label_map, labels):
    """Gives the object of a label map the names and colors of these labels. All are shown."""
    items = label_map.leaflight.labels
    items.clear()
    for label in labels:
        items.add().name = label.name
    # This calls no update functions.
    colors = linear_from_srgb(np.array([label.color for label in labels], np.float32))
    items.foreach_set("number", np.array([label.number for label in labels], np.int32))
    items.foreach_set("color", colors.ravel().astype(np.float32))


def fill_if_empty(label_map):
    """Lists the labels of a map that has none in its list, unless its values are no labels."""
    if label_map.leaflight.labels:
        return
    try:
        volume = cache.volume_of(label_map)
        fill(label_map, labels_of(volume.values, volume.labels))
    except LeaflightError:
        # The isosurface that it colors reports why.
        return


def show_colors(label_map):
    """Shows the colors of the list on all isosurfaces with the colors of a label map."""
    for obj in _colored_by(label_map):
        surface_object.update_all(obj)


def show_eyes(label_map):
    """Shows the surfaces of the labels whose eyes are open in the list of a label map."""
    hidden = " ".join(
        str(label.number) for label in label_map.leaflight.labels if not label.is_shown
    )
    for obj in _colored_by(label_map):
        if obj.leaflight.field == "labels":
            obj.leaflight.hide = hidden
