# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of the bake: quality, time, start, result, options and files."""

import bpy

from .. import props, versions
from ..bake import bake, continue_bake, estimate_bake, live, load_bake, photon_cloud, stopped
from ..operators import failures, jobs
from ..operators.checks import active_volume
from ..show import bake_properties, lamps, surface_material
from ..stage import staleness
from ..translations import iface_
from .sidebar import ClosedPanel, VolumePanel, optional, sentence, split


class LEAFLIGHT_PT_bake(VolumePanel, bpy.types.Panel):
    bl_label = "Bake"

    def draw(self, context):
        layout = self.layout
        settings = active_volume(context).leaflight
        column = layout.column(align=True)
        split(column)
        column.prop(settings, "low", text="Lowest")
        column.prop(settings, "high", text="Highest")
        props.draw(layout.column(align=True), settings, "light_walls", "both_sides")
        self._draw_quality(context, settings)
        button = layout.row(align=True)
        button.scale_y = 1.5
        button.operator(bake.LEAFLIGHT_OT_bake.bl_idname, text="Bake", icon="LIGHT_AREA")
        button.prop(context.scene, "leaflight_live", toggle=True, icon="FILE_REFRESH")
        work = jobs.running()
        if (
            work is None
            and stopped.offered() is None
            and continue_bake.is_interrupted(active_volume(context))
        ):
            layout.operator(continue_bake.LEAFLIGHT_OT_resume_bake.bl_idname, icon="RECOVER_LAST")
        if work is not None:
            versions.draw_progress(layout, work.fraction(), work.status())
            layout.operator(stopped.LEAFLIGHT_OT_stop_bake.bl_idname, icon="CANCEL")
        elif stopped.offered() is not None:
            self._draw_offer(context, stopped.offered())
        elif failures.sentence():
            sentence(context, layout, failures.sentence(), icon="ERROR")
            if failures.is_bug():
                layout.operator(failures.LEAFLIGHT_OT_copy_report.bl_idname, icon="COPYDOWN")
        if _shows_result(settings):
            self._draw_result(context, settings)

    def _draw_quality(self, context, settings):
        """Draws the three qualities, and below each its estimated time."""
        column = self.layout.column(align=True)
        row = column.row(align=True)
        for quality in bake_properties.QUALITIES:
            row.prop_enum(settings, "quality", quality)
        obj = active_volume(context)
        estimates = [estimate_bake.estimate_of(obj, e) for e in bake_properties.QUALITIES.values()]
        if None not in estimates:
            row = column.row(align=True)
            for estimate in estimates:
                row.label(text=estimate_bake.duration(estimate))
        if settings.quality == "CUSTOM":
            column.label(text=iface_("Custom: %s %%") % f"{settings.error:.2g}", icon="INFO")
        estimate = estimate_bake.estimate_of(obj)
        if estimate is not None:
            sentence(context, column, estimate_bake.sentence(estimate), icon="TIME")
        else:
            column.operator(estimate_bake.LEAFLIGHT_OT_estimate_bake.bl_idname, icon="TIME")

    def _draw_offer(self, context, job):
        reached = job.latest.statistics.estimated_error_percent
        text = iface_("Stopped: estimated error %s %% (target %s %%)")
        numbers = f"{reached:.2g}", f"{job.latest.provenance.error or 0:.2g}"
        sentence(context, self.layout, text % numbers, icon="QUESTION")
        row = self.layout.row(align=True)
        row.operator(stopped.LEAFLIGHT_OT_keep_bake.bl_idname, icon="CHECKMARK")
        row.operator(stopped.LEAFLIGHT_OT_throw_bake_away.bl_idname, icon="TRASH")

    def _draw_result(self, context, settings):
        """Draws one line about the bake. The panel Details has the rest."""
        layout, obj = self.layout, active_volume(context)
        change = staleness.change_to_show(obj)
        work = live.at_work()
        if work is not None:
            versions.draw_progress(layout, work.fraction(), work.status())
            layout.operator(live.LEAFLIGHT_OT_stop_live.bl_idname, icon="CANCEL")
        elif change and context.scene.leaflight_live and live.sentence():
            sentence(context, layout, live.sentence(), icon="ERROR")
        elif change:
            sentence(context, layout, change, icon="ERROR")
        elif not settings.bake_target:
            seconds = f"{settings.bake_seconds:.0f}"
            layout.label(text=iface_("Baked in %s s") % seconds, icon="CHECKMARK")
        elif settings.bake_error <= settings.bake_target:
            name = _name_of_quality(settings)
            layout.label(text=iface_("Quality: %s") % name, icon="CHECKMARK")
        else:
            figures = f"{settings.bake_error:.2g}", _name_of_quality(settings)
            text = iface_("Estimated error %s %% (target: %s)") % figures
            sentence(context, layout, text, icon="INFO")
        suited = continue_bake.suited(obj)
        if suited is not None:
            layout.operator(suited.bl_idname, icon="PLAY")


class LEAFLIGHT_PT_bake_details(ClosedPanel, bpy.types.Panel):
    """Details of a bake that the panel above leaves out."""

    bl_label = "Details"
    bl_parent_id = "LEAFLIGHT_PT_bake"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and _shows_result(active_volume(context).leaflight)

    def draw_header_preset(self, context):
        if active_volume(context).leaflight.bake_warnings:
            self.layout.label(icon="ERROR")

    def draw(self, context):
        layout, obj = self.layout, active_volume(context)
        settings = obj.leaflight
        layout.label(text=iface_("Baked in %s s") % f"{settings.bake_seconds:.0f}", icon="TIME")
        for text, icon in (
            (settings.bake_outcome[:1].upper() + settings.bake_outcome[1:], "BLANK1"),
            (lamps.sentence(obj), "LIGHT"),
            *((warning, "ERROR") for warning in settings.bake_warnings.splitlines()),
            (surface_material.shading_in_use(settings)[1], "INFO"),
        ):
            sentence(context, layout, text, icon=icon)


def _shows_result(settings):
    at_work = jobs.running() is not None or stopped.offered() is not None
    return bool(settings.bake_id) and not at_work


def _name_of_quality(settings):
    """Returns the name of the baked quality, which may differ from the present choice."""
    for key, name, _ in bake_properties.QUALITY_ITEMS:
        if abs(bake_properties.QUALITIES.get(key, -1.0) - settings.bake_target) < 1e-3:
            return iface_(name)
    return f"{settings.bake_target:.2g} %"


class _AdvancedPanel(ClosedPanel):
    bl_parent_id = "LEAFLIGHT_PT_bake"


class LEAFLIGHT_PT_advanced(_AdvancedPanel, bpy.types.Panel):
    bl_label = "Advanced"

    def draw(self, context):
        layout = self.layout
        settings = active_volume(context).leaflight
        split(layout)
        layout.prop(settings, "error")
        optional(layout.column(), settings, "use_time_limit", "time_limit")
        optional(layout.column(), settings, "use_resolution", "resolution")
        props.draw(layout, settings, "seed", "shading", "bake_folder")
        layout.operator(photon_cloud.LEAFLIGHT_OT_photon_cloud.bl_idname, icon="POINTCLOUD_DATA")


class LEAFLIGHT_PT_files(_AdvancedPanel, bpy.types.Panel):
    bl_label = "Files"

    def draw(self, context):
        """Draws the operators for bake files, and the disk space of the bakes."""
        column = self.layout.column(align=True)
        column.operator(load_bake.LEAFLIGHT_OT_load_bake.bl_idname, icon="FILE_FOLDER")
        column.operator(load_bake.LEAFLIGHT_OT_relocate_bake.bl_idname, icon="VIEWZOOM")
        column.operator(load_bake.LEAFLIGHT_OT_remove_unused_bakes.bl_idname, icon="TRASH")
        bakes = load_bake.bakes_of_this_file()
        unused = load_bake.unused_among(bakes)
        if bakes:
            text = iface_("Bakes: %s") % load_bake.megabytes(bakes)
            if unused:
                sizes = load_bake.megabytes(bakes), load_bake.megabytes(unused)
                text = iface_("Bakes: %s (unused: %s)") % sizes
            sentence(context, self.layout, text, icon="DISK_DRIVE")
