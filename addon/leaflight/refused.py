# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on shows when the package refuses to work here: why, and nothing else."""

import textwrap

import bpy

# Set before register(); what the package said.
sentence = ""


def _draw(layout):
    for i, line in enumerate(textwrap.wrap(sentence, 60)):
        layout.label(text=line, icon="NONE" if i else "ERROR")


class LeaflightRefused(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, _context):
        _draw(self.layout.column(align=True))


class LEAFLIGHT_PT_refused(bpy.types.Panel):
    bl_label = "Leaflight cannot work here"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Leaflight"

    def draw(self, _context):
        _draw(self.layout.column(align=True))


CLASSES = (LeaflightRefused, LEAFLIGHT_PT_refused)


def register():
    print(f"Leaflight: {sentence}")
