# SPDX-License-Identifier: GPL-3.0-or-later
"""Common code of the panels in the Leaflight tab: their place, and sentences that wrap."""

from ..operators.checks import active_volume
from ..translations import draw_wrapped

# Mean width of a letter, and space beside the text, in pixels at an interface scale of 1.
_LETTER, _MARGIN = 6.6, 66


class SidebarPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Leaflight"


class VolumePanel(SidebarPanel):
    """A panel of the volume that is active, or was last."""

    bl_parent_id = "LEAFLIGHT_PT_volume"

    @classmethod
    def poll(cls, context):
        return active_volume(context) is not None


class ClosedPanel(VolumePanel):
    bl_options = {"DEFAULT_CLOSED"}


def split(layout):
    """Puts names left and values right, as in Blender's panels."""
    layout.use_property_split = True
    layout.use_property_decorate = False


def sentence(context, layout, text, icon="NONE"):
    """Draws a translated text, wrapped to the width of the sidebar."""
    scale = context.preferences.system.ui_scale
    width = max(16, int((context.region.width / scale - _MARGIN) / _LETTER))
    draw_wrapped(layout.column(align=True), text, width, icon)


def optional(layout, settings, switch, value):
    """Draws a switch and, on the same line, the value that it enables."""
    name = settings.bl_rna.properties[switch].name
    row = layout.row(align=True, heading=name)
    row.prop(settings, switch, text="")
    column = row.row()
    column.active = getattr(settings, switch)
    column.prop(settings, value, text="")
