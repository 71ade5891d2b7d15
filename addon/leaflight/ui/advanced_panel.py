# SPDX-License-Identifier: GPL-3.0-or-later
"""What nobody needs for a good picture: closed panels beneath that of the bake."""

import bpy

from ..bake import load_bake, photon_cloud, unused_bakes
from ..operators.checks import active_volume
from ..translations import iface_
from .sidebar import VolumePanel, optional, sentence, split


class _AdvancedPanel(VolumePanel):
    bl_parent_id = "LEAFLIGHT_PT_bake"
    bl_options = {"DEFAULT_CLOSED"}


class LEAFLIGHT_PT_advanced(_AdvancedPanel, bpy.types.Panel):
    bl_label = "Advanced"

    def draw(self, context):
        layout = self.layout
        settings = active_volume(context).leaflight
        split(layout)
        layout.prop(settings, "error")
        optional(layout.column(), settings, "use_time_limit", "time_limit")
        optional(layout.column(), settings, "use_resolution", "resolution")
        layout.prop(settings, "seed")
        layout.prop(settings, "shading")
        layout.prop(settings, "bake_folder")
        layout.operator(photon_cloud.LEAFLIGHT_OT_photon_cloud.bl_idname, icon="POINTCLOUD_DATA")


class LEAFLIGHT_PT_files(_AdvancedPanel, bpy.types.Panel):
    bl_label = "Files"

    def draw(self, context):
        """What bakes take of the disk, and where else they may lie."""
        column = self.layout.column(align=True)
        column.operator(load_bake.LEAFLIGHT_OT_load_bake.bl_idname, icon="FILE_FOLDER")
        column.operator(load_bake.LEAFLIGHT_OT_relocate_bake.bl_idname, icon="VIEWZOOM")
        column.operator(unused_bakes.LEAFLIGHT_OT_remove_unused_bakes.bl_idname, icon="TRASH")
        bakes = unused_bakes.of_this_file()
        unused = unused_bakes.unused_among(bakes)
        if bakes:
            text = iface_("Bakes: %s") % unused_bakes.megabytes(bakes)
            if unused:
                sizes = unused_bakes.megabytes(bakes), unused_bakes.megabytes(unused)
                text = iface_("Bakes: %s, of which unused: %s") % sizes
            sentence(context, self.layout, text, icon="DISK_DRIVE")


CLASSES = (LEAFLIGHT_PT_advanced, LEAFLIGHT_PT_files)
