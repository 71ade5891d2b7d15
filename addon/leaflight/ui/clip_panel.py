# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the box that cuts the isosurfaces."""

import bpy

from ..operators.checks import active_volume
from ..show import added
from ..translations import iface_
from . import add_isosurface, clip_outline
from .sidebar import VolumePanel, sentence


class LEAFLIGHT_PT_clip(VolumePanel, bpy.types.Panel):
    bl_label = "Clip Box"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        volume = active_volume(context)
        look = volume.leaflight_look
        row = layout.row(align=True)
        row.prop(look, "box", text="", icon="MESH_CUBE")
        row.operator(add_isosurface.LEAFLIGHT_OT_add_clip_box.bl_idname, text="", icon="ADD")
        if look.box is None or not look.box.users_scene:
            return
        clip_outline.panel_is_open(context)
        row = layout.row(align=True)
        row.prop(look, "keep", expand=True)
        layout.prop(look, "cut_colors")
        column = layout.column(align=True)
        for obj in (volume, *added.added_to(volume)):
            text = iface_("Cut %s") % f"{obj.leaflight.isovalue:g}"
            column.prop(obj.leaflight_look, "is_cut", text=text)
        if look.box.type != "EMPTY" and not look.box.hide_render:
            text = iface_('"%s" renders and is baked: hide it in renders') % look.box.name
            sentence(context, layout, text, icon="ERROR")


CLASSES = (LEAFLIGHT_PT_clip,)
