# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel and preferences of the add-on if the package cannot work here: only the reason."""

import bpy

from .translations import draw_wrapped

# Reason from the package, set before register().
sentence = ""


class LeaflightRefused(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, _context):
        draw_wrapped(self.layout.column(align=True), sentence, 60, icon="ERROR")


class LEAFLIGHT_PT_refused(bpy.types.Panel):
    bl_label = "Leaflight cannot work here"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Leaflight"

    def draw(self, _context):
        draw_wrapped(self.layout.column(align=True), sentence, 60, icon="ERROR")


def register():
    print(f"Leaflight: {sentence}")
