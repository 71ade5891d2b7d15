# SPDX-License-Identifier: GPL-3.0-or-later
"""The head of the tab: the isovalue of the active volume, or how to get a volume."""

import bpy

from ..bake import load_bake
from ..importing import import_image, import_volume
from ..operators.checks import active_volume
from ..show import added, backs, isovalues, look, surface_material, surface_object
from ..stage import open_example
from ..translations import iface_
from . import add_isosurface, clip_outline, proposals
from .sidebar import SidebarPanel, sentence


class LEAFLIGHT_PT_volume(SidebarPanel, bpy.types.Panel):
    bl_label = "Leaflight"

    def draw(self, context):
        layout = self.layout
        clip_outline.begin_sidebar(context)
        graph, obj = context.object, active_volume(context)
        if graph is not None and graph.leaflight_flat.is_flatland:
            layout.label(text=graph.name, icon="IMAGE_DATA", translate=False)
            return
        if obj is None:
            self._draw_beginning()
            return
        layout.label(text=obj.name, icon="VOLUME_DATA", translate=False)
        layout.prop(obj.leaflight, '["isovalue"]', text="Isovalue", slider=True)
        if any(other != obj for other in isovalues.volumes(context.scene)):
            self._draw_partners(context, obj)
        problem = surface_object.problems.get(obj.name_full)
        if problem:
            sentence(context, layout, problem, icon="ERROR")
        note = backs.note(obj)
        if note:
            sentence(context, layout, note, icon="INFO")
        for other in added.added_to(obj):
            self._draw_added(context, other)
        row = layout.row(align=True)
        add = add_isosurface.LEAFLIGHT_OT_add_isosurface.bl_idname
        row.operator(add, icon="ADD")
        if proposals.is_hounsfield(obj):
            row.operator_menu_enum(add, "tissue", text="", icon="DOWNARROW_HLT")

    def _draw_beginning(self):
        column = self.layout.column(align=True)
        column.operator(open_example.LEAFLIGHT_OT_open_example.bl_idname, icon="OUTLINER_OB_VOLUME")
        column.operator(import_volume.LEAFLIGHT_OT_import_volume.bl_idname, icon="IMPORT")
        column.operator(import_image.LEAFLIGHT_OT_import_image.bl_idname, icon="IMAGE_DATA")
        column.operator(load_bake.LEAFLIGHT_OT_load_bake.bl_idname, icon="FILE_FOLDER")

    def _draw_added(self, context, obj):
        """An isosurface that is shown beside the volume's own."""
        box = self.layout.box()
        row = box.row(align=True)
        row.prop(obj.leaflight, '["isovalue"]', text="Isovalue", slider=True)
        remove = add_isosurface.LEAFLIGHT_OT_remove_isosurface.bl_idname
        row.operator(remove, text="", icon="X").name = obj.name
        box.prop(obj.leaflight_look, "opacity", slider=True)
        box.prop(obj.leaflight_look, "dust")
        row = box.row(align=True)
        row.prop(obj.leaflight_look, "use_color", text="Color")
        color = row.row(align=True)
        color.active = obj.leaflight_look.use_color
        color.prop(obj.leaflight_look, "color", text="")
        problem = surface_object.problems.get(obj.name_full)
        if problem:
            sentence(context, box, problem, icon="ERROR")
        elif surface_material.is_recolored(obj):
            sentence(context, box, look.OWN_COLOR, icon="INFO")

    def _draw_partners(self, context, obj):
        """What the volumes that are baked together show."""
        settings = obj.leaflight
        row = self.layout.row()
        c = isovalues.common_isovalue(settings, settings.isovalue)
        row.label(text=iface_("Coordinate c = %s") % f"{c:.3f}")
        row.prop(settings, "linked", icon="LINKED" if settings.linked else "UNLINKED")
        column = self.layout.column(align=True)
        for other in isovalues.partners(obj, context.scene):
            column.label(text=f"{other.name}: {other.leaflight.isovalue:g}", icon="VOLUME_DATA")


CLASSES = (LEAFLIGHT_PT_volume,)
