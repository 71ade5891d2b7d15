# SPDX-License-Identifier: GPL-3.0-or-later
"""What the volume holds: a slice, the histogram with its marks, and the facts of the file."""

import bpy

from ..bake import bake_frames
from ..operators.checks import active_volume
from ..store import frame_bakes
from ..translations import iface_
from . import data_picture, distribution, pick_isovalue, smooth_volume

# Pixels of an icon of scale 1, and of the sidebar beside the picture, in an unscaled interface.
ICON, BESIDE = 20, 40


class LEAFLIGHT_PT_data(bpy.types.Panel):
    bl_label = "Data"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Leaflight"
    bl_parent_id = "LEAFLIGHT_PT_volume"

    @classmethod
    def poll(cls, context):
        return active_volume(context) is not None

    def draw(self, context):
        layout = self.layout
        obj = active_volume(context)
        icon = data_picture.icon_of(obj)
        if icon:
            width = context.region.width / context.preferences.system.ui_scale
            layout.template_icon(icon_value=icon, scale=max(4.0, (width - BESIDE) / ICON))
        else:
            layout.label(text="Looking at the data", icon="TIME")
        if obj.leaflight.frames > 1:
            self._draw_frames(obj.leaflight)
        layout.operator(pick_isovalue.LEAFLIGHT_OT_pick_isovalue.bl_idname, icon="EYEDROPPER")
        _draw_smooth(layout, obj.leaflight)
        found = distribution.of(obj)
        if found is not None and not obj.leaflight.smooth:
            if found.are_labels:
                layout.label(text="A mask or labels: smooth by 1 voxel", icon="INFO")
            elif found.is_terraced:
                layout.label(text="8-bit steps show: smooth by 1 voxel", icon="INFO")

    def _draw_frames(self, settings):
        """Which frame of a series is shown, and how many are baked."""
        layout = self.layout
        layout.prop(settings, "shown_frame", text=iface_("Frame (0 to %d)") % (settings.frames - 1))
        baked = frame_bakes.count_baked(settings)
        if settings.bake_id:
            text, icon = iface_("Baked; %d of %d frames are"), "CHECKMARK"
        else:
            text, icon = iface_("Not baked; %d of %d frames are"), "ERROR"
        layout.label(text=text % (baked, settings.frames), icon=icon, translate=False)
        layout.operator(bake_frames.LEAFLIGHT_OT_bake_frames.bl_idname, icon="RENDER_ANIMATION")


def _draw_smooth(layout, settings):
    name = smooth_volume.LEAFLIGHT_OT_smooth.bl_idname
    for what, text in (
        ("smooth", iface_("Smooth: %s voxels")),
        ("smooth_normals", iface_("Smooth Normals: %s")),
    ):
        text = text % f"{getattr(settings, what):g}"
        layout.operator_menu_enum(name, "amount", text=text, icon="MOD_SMOOTH").what = what


CLASSES = (LEAFLIGHT_PT_data,)
