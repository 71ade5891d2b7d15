# SPDX-License-Identifier: GPL-3.0-or-later
"""The Leaflight tab of the 3D viewport's sidebar."""

import textwrap

import bpy

from ..bake import bake, bake_flatland, estimate_bake, load_bake, photon_cloud, stopped
from ..bake import unused_bakes
from ..compare import render_comparison
from ..importing import import_image, import_volume
from ..operators import background
from ..show import isovalues, surface_object
from ..stage import cornell_box, staleness
from . import leaf_look


class _LeaflightPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Leaflight"


class LEAFLIGHT_PT_volume(_LeaflightPanel, bpy.types.Panel):
    bl_label = "Leaflight"

    def draw(self, context):
        layout = self.layout
        obj = context.object
        if obj is not None and obj.leaflight_flat.is_flatland:
            layout.label(text=obj.name, icon="IMAGE_DATA")
            return
        if obj is None or not obj.leaflight.is_volume:
            layout.label(text="No Leaflight volume is selected")
            layout.operator(import_volume.LEAFLIGHT_OT_import_volume.bl_idname, icon="IMPORT")
            layout.operator(import_image.LEAFLIGHT_OT_import_image.bl_idname, icon="IMPORT")
            layout.operator(load_bake.LEAFLIGHT_OT_load_bake.bl_idname, icon="FILE_FOLDER")
            return
        layout.label(text=obj.name, icon="VOLUME_DATA")
        layout.prop(obj.leaflight, '["isovalue"]', text="Isovalue", slider=True)
        if any(other != obj for other in isovalues.volumes(context.scene)):
            self._draw_partners(context, obj)
        problem = surface_object.problems.get(obj.name_full)
        if problem:
            _sentence(context, layout, problem, icon="ERROR")

    def _draw_partners(self, context, obj):
        """What the volumes that are baked together show."""
        settings = obj.leaflight
        row = self.layout.row()
        c = isovalues.leaf_coordinate(settings, settings.isovalue)
        row.label(text=f"Leaf c = {c:.3f}")
        row.prop(settings, "linked", icon="LINKED" if settings.linked else "UNLINKED")
        column = self.layout.column(align=True)
        for other in isovalues.partners(obj, context.scene):
            column.label(text=f"{other.name}: {other.leaflight.isovalue:g}", icon="VOLUME_DATA")


class _VolumePanel(_LeaflightPanel):
    bl_parent_id = "LEAFLIGHT_PT_volume"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.leaflight.is_volume


class LEAFLIGHT_PT_leaves(_VolumePanel, bpy.types.Panel):
    bl_label = "Isosurfaces"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.object.leaflight
        layout.operator_menu_enum(
            leaf_look.LEAFLIGHT_OT_leaf_preset.bl_idname, "preset", text="Preset"
        )
        layout.prop(settings, "leaf_scattering")
        if settings.leaf_scattering == "GLASS":
            layout.prop(settings, "leaf_ior")
        row = layout.row()
        if settings.leaf_stops:
            row.template_list(
                "LEAFLIGHT_UL_stops", "", settings, "leaf_stops", settings, "leaf_stop", rows=3
            )
        else:
            row.prop(settings, "leaf_albedo")
        buttons = row.column(align=True)
        buttons.operator(leaf_look.LEAFLIGHT_OT_add_stop.bl_idname, text="", icon="ADD")
        if settings.leaf_stops:
            buttons.operator(leaf_look.LEAFLIGHT_OT_remove_stop.bl_idname, text="", icon="REMOVE")
        column = layout.column(align=True)
        column.prop(settings, "leaf_emission")
        column.prop(settings, "leaf_emission_strength")
        layout.prop(settings, "capped")


class LEAFLIGHT_UL_stops(bpy.types.UIList):
    """The stops of the color ramp, each with its isovalue and its color."""

    def draw_item(self, _context, layout, _data, item, _icon, _active, _property):
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(item, "isovalue", text="", emboss=False)
        row.prop(item, "color", text="")


class LEAFLIGHT_PT_flatland(_LeaflightPanel, bpy.types.Panel):
    bl_label = "Flatland"
    bl_parent_id = "LEAFLIGHT_PT_volume"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.leaflight_flat.is_flatland

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.object.leaflight_flat
        for names in (
            ("height", "count", "width", "brightness_correction"),
            ("low", "high"),
            ("resolution", "samples", "photons"),
            ("seed", "scene_file"),
        ):
            column = layout.column(align=True)
            for name in names:
                column.prop(settings, name, text={"low": "Lowest", "high": "Highest"}.get(name))
        layout.operator(bake_flatland.LEAFLIGHT_OT_bake_flatland.bl_idname, icon="LIGHT_AREA")
        job = background.running()
        if job is not None:
            layout.label(text=f"{job.status()}, Esc ends it", icon="TIME")
        problem = surface_object.problems.get(context.object.name_full)
        if problem:
            _sentence(context, layout, problem, icon="ERROR")


class LEAFLIGHT_PT_surroundings(_VolumePanel, bpy.types.Panel):
    bl_label = "Surroundings"

    def draw(self, context):
        self.layout.operator(cornell_box.LEAFLIGHT_OT_build_cornell_box.bl_idname, icon="CUBE")
        if context.object.leaflight.bake_surroundings:
            self.layout.prop(context.scene.leaflight, "show_walls")


class LEAFLIGHT_PT_bake(_VolumePanel, bpy.types.Panel):
    bl_label = "Bake"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.object.leaflight
        column = layout.column(align=True)
        column.prop(settings, "low", text="Lowest")
        column.prop(settings, "high", text="Highest")
        column = layout.column(align=True)
        column.prop(settings, "both_sides")
        column.prop(settings, "light_surroundings")
        column = layout.column(align=True)
        column.active = not settings.fixed_samples
        column.prop(settings, "error")
        column.prop(settings, "time_limit")
        layout.prop(settings, "bake_folder")
        self._draw_estimate(context)
        layout.operator(bake.LEAFLIGHT_OT_bake.bl_idname, icon="LIGHT_AREA")
        layout.operator(photon_cloud.LEAFLIGHT_OT_photon_cloud.bl_idname, icon="POINTCLOUD_DATA")
        job = background.running()
        if job is not None:
            layout.label(text=f"{job.status()}, Esc ends it", icon="TIME")
            layout.operator(stopped.LEAFLIGHT_OT_stop_bake.bl_idname, icon="CANCEL")
        elif stopped.offered() is not None:
            self._draw_offer(context, stopped.offered())
        elif settings.bake_id:
            self._draw_result(context, settings)
        self._draw_files(context)

    def _draw_estimate(self, context):
        row = self.layout.row()
        estimate = estimate_bake.estimate_of(context.object)
        if estimate is not None and not context.object.leaflight.fixed_samples:
            row.label(text=estimate_bake.sentence(estimate), icon="TIME")
        row.operator(estimate_bake.LEAFLIGHT_OT_estimate_bake.bl_idname)

    def _draw_offer(self, context, job):
        _sentence(context, self.layout, f"Stopped: {job.outcome()}", icon="QUESTION")
        row = self.layout.row(align=True)
        row.operator(stopped.LEAFLIGHT_OT_keep_bake.bl_idname, icon="CHECKMARK")
        row.operator(stopped.LEAFLIGHT_OT_throw_bake_away.bl_idname, icon="TRASH")

    def _draw_result(self, context, settings):
        layout = self.layout
        change = staleness.change_since_bake(context, context.object)
        if change:
            _sentence(context, layout, change, icon="ERROR")
        else:
            layout.label(text=f"Baked in {settings.bake_seconds:.0f} s", icon="CHECKMARK")
            if settings.bake_outcome:
                text = settings.bake_outcome
                _sentence(context, layout, text[0].upper() + text[1:], icon="BLANK1")
        layout.prop(settings, "shading")
        _, reason = surface_object.shading_in_use(settings)
        if reason:
            _sentence(context, layout, reason, icon="INFO")
        layout.prop(settings, "settle")

    def _draw_files(self, context):
        """What bakes take of the disk, and where else they may lie."""
        column = self.layout.column(align=True)
        column.operator(load_bake.LEAFLIGHT_OT_load_bake.bl_idname, icon="FILE_FOLDER")
        column.operator(load_bake.LEAFLIGHT_OT_relocate_bake.bl_idname, icon="VIEWZOOM")
        column.operator(unused_bakes.LEAFLIGHT_OT_remove_unused_bakes.bl_idname, icon="TRASH")
        bakes = unused_bakes.of_this_file()
        unused = unused_bakes.unused_among(bakes)
        if bakes:
            text = f"Bakes: {unused_bakes.megabytes(bakes)}"
            if unused:
                text += f", of which unused: {unused_bakes.megabytes(unused)}"
            _sentence(context, self.layout, text, icon="DISK_DRIVE")


class LEAFLIGHT_PT_research(_VolumePanel, bpy.types.Panel):
    bl_label = "Research"
    bl_parent_id = "LEAFLIGHT_PT_bake"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.object.leaflight
        column = layout.column(align=True)
        column.prop(settings, "resolution")
        column.prop(settings, "seed")
        layout.prop(settings, "fixed_samples")
        column = layout.column(align=True)
        column.active = settings.fixed_samples
        for name in ("samples", "photons", "refine", "estimator"):
            column.prop(settings, name)


class LEAFLIGHT_PT_comparison(_VolumePanel, bpy.types.Panel):
    bl_label = "Comparison"

    def draw(self, context):
        layout = self.layout
        layout.operator(
            render_comparison.LEAFLIGHT_OT_render_comparison.bl_idname, icon="RENDER_STILL"
        )
        comparison = context.object.leaflight.comparison
        if comparison:
            _sentence(context, layout, comparison, icon="NONE")


def _sentence(context, layout, text, icon):
    """Labels do not wrap by themselves."""
    scale = context.preferences.system.ui_scale
    width = max(20, int(context.region.width / (7.5 * scale)) - 6)
    column = layout.column(align=True)
    for line in textwrap.wrap(text, width):
        column.label(text=line, icon=icon)
        icon = "BLANK1"


_CLASSES = (
    LEAFLIGHT_UL_stops,
    LEAFLIGHT_PT_volume,
    LEAFLIGHT_PT_leaves,
    LEAFLIGHT_PT_flatland,
    LEAFLIGHT_PT_surroundings,
    LEAFLIGHT_PT_bake,
    LEAFLIGHT_PT_research,
    LEAFLIGHT_PT_comparison,
)


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
