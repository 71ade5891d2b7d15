# SPDX-License-Identifier: GPL-3.0-or-later
"""The top of the tab: the isovalue and data of the active volume, or operators to import one."""

import bpy

from ..bake import continue_bake, load_bake
from ..edit import add_isosurface, data_picture, pick_isovalue
from ..importing import import_volume, open_example, read_again, regions
from ..operators import jobs
from ..operators.checks import active_volume
from ..show import display, distribution, isovalues, look, surface_material, surface_object, texture
from ..store import cache, frame_bakes, source_files
from ..translations import iface_
from . import clip_outline
from .sidebar import SidebarPanel, VolumePanel, sentence


class LEAFLIGHT_PT_volume(SidebarPanel, bpy.types.Panel):
    bl_label = "Leaflight"

    def draw(self, context):
        layout = self.layout
        clip_outline.begin_sidebar(context)
        obj = active_volume(context)
        if obj is None:
            self._draw_beginning()
            return
        layout.label(text=obj.name, icon="VOLUME_DATA", translate=False)
        layout.prop(obj.leaflight, '["isovalue"]', text="Isovalue", slider=True)
        volumes = set(isovalues.volumes(context.scene))
        if volumes.difference([obj], *map(texture.volumes_that_color, volumes)):
            self._draw_partners(context, obj)
        progress = cache.progress_of(obj)
        if progress is not None:
            text = jobs.status_of(progress.fraction, progress.stage)
            layout.label(text=text, icon="TIME", translate=False)
        problem = surface_object.problems.get(obj.name_full)
        if problem:
            sentence(context, layout, problem, icon="ERROR")
        note = look.note_on_backs(obj)
        if note:
            sentence(context, layout, note, icon="INFO")
        for other in display.added_to(obj):
            self._draw_added(context, other)
        row = layout.row(align=True)
        add = add_isosurface.LEAFLIGHT_OT_add_isosurface.bl_idname
        row.operator(add, icon="ADD")
        if add_isosurface.is_hounsfield(obj):
            row.operator_menu_enum(add, "tissue", text="", icon="DOWNARROW_HLT")

    def _draw_beginning(self):
        column = self.layout.column(align=True)
        column.operator(open_example.LEAFLIGHT_OT_open_example.bl_idname, icon="OUTLINER_OB_VOLUME")
        column.operator(import_volume.LEAFLIGHT_OT_import_volume.bl_idname, icon="IMPORT")
        column.operator(load_bake.LEAFLIGHT_OT_load_bake.bl_idname, icon="FILE_FOLDER")

    def _draw_added(self, context, obj):
        """Draws the properties of an added isosurface."""
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
        """Draws the common isovalue, and the isovalues of the linked volumes."""
        settings = obj.leaflight
        row = self.layout.row()
        c = isovalues.common_isovalue(settings, settings.isovalue)
        row.label(text=iface_("Coordinate c = %s") % f"{c:.3f}")
        row.prop(settings, "linked", icon="LINKED" if settings.linked else "UNLINKED")
        column = self.layout.column(align=True)
        for other in isovalues.partners(obj, context.scene):
            column.label(text=f"{other.name}: {other.leaflight.isovalue:g}", icon="VOLUME_DATA")


# Size of an icon at scale 1, and sidebar width beside the picture, in pixels of an unscaled
# interface.
ICON, BESIDE = 20, 40


class LEAFLIGHT_PT_data(VolumePanel, bpy.types.Panel):
    bl_label = "Data"

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
        _draw_regions(layout, obj.leaflight)
        found = distribution.of(obj)
        if found is not None and not obj.leaflight.smooth:
            if found.are_labels:
                layout.label(text="Mask or labels: smooth by 1 voxel", icon="INFO")
            elif found.is_terraced:
                layout.label(text="8-bit steps are visible: smooth by 1 voxel", icon="INFO")

    def _draw_frames(self, settings):
        """Draws the shown frame of a series, and the number of baked frames."""
        layout = self.layout
        layout.prop(settings, "shown_frame", text=iface_("Frame (0 to %d)") % (settings.frames - 1))
        baked = frame_bakes.count_baked(settings)
        if frame_bakes.is_baked(settings):
            text, icon = iface_("Baked (%d of %d frames)"), "CHECKMARK"
        else:
            text, icon = iface_("Not baked (%d of %d frames are)"), "ERROR"
        layout.label(text=text % (baked, settings.frames), icon=icon, translate=False)
        layout.operator(continue_bake.LEAFLIGHT_OT_bake_frames.bl_idname, icon="RENDER_ANIMATION")


def _draw_smooth(layout, settings):
    name = read_again.LEAFLIGHT_OT_smooth.bl_idname
    for what, text in (
        ("smooth", iface_("Smooth: %s voxels")),
        ("smooth_normals", iface_("Smooth Normals: %s")),
    ):
        text = text % f"{getattr(settings, what):g}"
        layout.operator_menu_enum(name, "amount", text=text, icon="MOD_SMOOTH").what = what


def _draw_regions(layout, settings):
    row = layout.row(align=True)
    row.operator_menu_enum(regions.LEAFLIGHT_OT_clean_data.bl_idname, "kind", text="Clean Data")
    row.operator(regions.LEAFLIGHT_OT_remove_part.bl_idname, icon="EYEDROPPER")
    layout.operator(regions.LEAFLIGHT_OT_remove_sphere.bl_idname, icon="PIVOT_CURSOR")
    for name in regions.label_maps(bpy.context.scene):
        text = f"{iface_('Mask Data')}: {name}"
        mask = layout.operator(regions.LEAFLIGHT_OT_mask_data.bl_idname, text=text, translate=False)
        mask.label_map = name
    layout.operator(regions.LEAFLIGHT_OT_crop_to_shown.bl_idname, icon="SELECT_SET")
    column, switch = layout.column(align=True), regions.LEAFLIGHT_OT_switch_region.bl_idname
    for index, item in enumerate(source_files.regions_of(settings)):
        row = column.row(align=True)
        icon = "HIDE_OFF" if item["on"] else "HIDE_ON"
        row.operator(switch, text=regions.title(item), icon=icon, translate=False).index = index
        remove = row.operator(switch, text="", icon="X")
        remove.index, remove.action = index, "REMOVE"
