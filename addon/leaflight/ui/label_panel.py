# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of labels under Color By, with an eye, a name and a color each."""

import bpy

from ..edit import label_operators
from ..operators.checks import active_volume


class LEAFLIGHT_UL_labels(bpy.types.UIList):
    """The labels of a label map. The search is by name."""

    def draw_item(self, context, layout, _data, item, _icon, _active, _property):
        row = layout.row(align=True)
        row.use_property_split = False
        # Labels that only color a scan have no surfaces.
        if active_volume(context).leaflight.field == "labels":
            icon = "HIDE_OFF" if item.is_shown else "HIDE_ON"
            row.prop(item, "is_shown", text="", icon=icon, emboss=False)
        row.prop(item, "name", text="", emboss=False)
        color = row.row()
        color.ui_units_x = 2
        color.prop(item, "color", text="")


def draw_labels(layout, volume):
    """Draws the labels of the map that colors a volume."""
    label_map = label_operators.label_map_of(volume)
    if label_map is None:
        return
    settings = label_map.leaflight
    layout.template_list("LEAFLIGHT_UL_labels", "", settings, "labels", settings, "label", rows=6)
    if volume.leaflight.field == "labels":
        row = layout.row(align=True)
        row.use_property_split = False
        row.operator_enum(label_operators.LEAFLIGHT_OT_show_labels.bl_idname, "which")
    layout.operator(label_operators.LEAFLIGHT_OT_read_label_table.bl_idname)
