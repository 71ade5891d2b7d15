# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of an image whose isolines are lit in the plane."""

import bpy

from .. import versions
from ..bake import bake_flatland
from ..operators import jobs
from ..show import surface_object
from .sidebar import SidebarPanel, sentence, split


class LEAFLIGHT_PT_flatland(SidebarPanel, bpy.types.Panel):
    bl_label = "Flatland"
    bl_parent_id = "LEAFLIGHT_PT_volume"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.leaflight_flat.is_flatland

    def draw(self, context):
        layout = self.layout
        split(layout)
        settings = context.object.leaflight_flat
        for names in (
            ("height", "count", "width", "brightness_correction"),
            ("low", "high"),
            ("error", "resolution"),
            ("seed", "scene_file"),
        ):
            column = layout.column(align=True)
            for name in names:
                column.prop(settings, name, text={"low": "Lowest", "high": "Highest"}.get(name))
        layout.operator(bake_flatland.LEAFLIGHT_OT_bake_flatland.bl_idname, icon="LIGHT_AREA")
        job = jobs.running()
        if job is not None:
            versions.draw_progress(layout, job.fraction(), job.status())
        problem = surface_object.problems.get(context.object.name_full)
        if problem:
            sentence(context, layout, problem, icon="ERROR")


CLASSES = (LEAFLIGHT_PT_flatland,)
