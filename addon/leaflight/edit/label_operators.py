# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on the labels of the label map that colors the active volume."""

import bpy
import numpy as np
from bpy_extras.io_utils import ImportHelper
from leaflight import LeaflightError
from leaflight.io.readers.label_files import matching_table
from leaflight.volume.label_table import labels_of

from ..operators import checks
from ..operators.checks import active_volume
from ..props import EnumProperty, StringProperty
from ..show import fill, label_list, texture
from ..store import cache


def label_map_of(obj):
    """Returns the object of the label map that colors a volume, or None."""
    if obj is None or obj.leaflight.texture_kind != "LABELS":
        return None
    return next(iter(texture.volumes_that_color(obj)), None)


class _LabelOperator(checks.VolumeOperator):
    conditions = (
        *checks.VOLUME,
        checks.volume_needs(label_map_of, "Choose a label map as Color By first"),
    )

    def label_map(self, context):
        """Returns the object of the label map. Raises LeaflightError if it was just deleted."""
        found = label_map_of(active_volume(context))
        if found is None:
            raise LeaflightError("The label map was deleted: import it again.")
        return found


class LEAFLIGHT_OT_show_labels(_LabelOperator, bpy.types.Operator):
    bl_label = "Show Labels"
    bl_description = "Open or close the eyes of all labels at once"

    which: EnumProperty(
        "Show",
        items=[
            ("ALL", "All", "Show all labels"),
            ("ACTIVE", "Only Active", "Hide all labels except the active one"),
            ("OTHERS", "Invert", "Show hidden labels, and hide the others"),
        ],
    )

    def run(self, context):
        label_map = self.label_map(context)
        items, active = label_map.leaflight.labels, label_map.leaflight.label
        shown = np.ones(len(items), bool)
        if self.which == "OTHERS":
            shown = ~fill.read(items, "is_shown", bool)
        elif self.which == "ACTIVE":
            shown = np.arange(len(items)) == active
        items.foreach_set("is_shown", shown)
        label_list.show_eyes(label_map)


class LEAFLIGHT_OT_read_label_table(_LabelOperator, bpy.types.Operator, ImportHelper):
    bl_label = "Read Label Table"
    bl_description = (
        "Read names and colors of labels from a table of 3D Slicer (.ctbl), FreeSurfer or "
        "ITK-SNAP (.txt) or BIDS (.tsv)"
    )

    filter_glob: StringProperty(default="*.ctbl;*.txt;*.tsv", options={"HIDDEN"})

    def run(self, context):
        label_map = self.label_map(context)
        values = cache.volume_of(label_map).values
        table = matching_table(label_map.name, values, bpy.path.abspath(self.filepath))
        label_list.fill(label_map, labels_of(values, table))
        label_list.show_eyes(label_map)
        label_list.show_colors(label_map)
