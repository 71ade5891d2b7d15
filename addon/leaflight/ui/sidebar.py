# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels of the Leaflight tab share: their place, and sentences that wrap."""

from ..operators.checks import active_volume
from ..translations import draw_wrapped

# Pixels that a letter takes on average, and those beside the text, both at a scale of 1.
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
    """Names left, values right, as in Blender's own panels."""
    layout.use_property_split = True
    layout.use_property_decorate = False


def sentence(context, layout, text, icon="NONE"):
    """A text that is translated already, as wide as the sidebar."""
    scale = context.preferences.system.ui_scale
    width = max(16, int((context.region.width / scale - _MARGIN) / _LETTER))
    draw_wrapped(layout.column(align=True), text, width, icon)


def optional(layout, settings, switch, value):
    """A value that counts only where its switch is on, on one line with it."""
    name = settings.bl_rna.properties[switch].name
    row = layout.row(align=True, heading=name)
    row.prop(settings, switch, text="")
    column = row.row()
    column.active = getattr(settings, switch)
    column.prop(settings, value, text="")
