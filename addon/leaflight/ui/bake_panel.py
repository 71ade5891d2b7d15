# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the bake: how good, how long, go; what has come of it."""

import bpy

from .. import versions
from ..bake import bake, continue_bake, estimate_bake, resume_bake, stopped
from ..operators import background
from ..show import lamps, properties, surface_material
from ..stage import staleness
from ..translations import iface_
from .sidebar import VolumePanel, sentence, split


class LEAFLIGHT_PT_bake(VolumePanel, bpy.types.Panel):
    bl_label = "Bake"

    def draw(self, context):
        layout = self.layout
        settings = context.object.leaflight
        column = layout.column(align=True)
        split(column)
        column.prop(settings, "low", text="Lowest")
        column.prop(settings, "high", text="Highest")
        column = layout.column(align=True)
        column.prop(settings, "light_surroundings")
        column.prop(settings, "both_sides")
        self._draw_quality(context, settings)
        button = layout.row()
        button.scale_y = 1.5
        button.operator(bake.LEAFLIGHT_OT_bake.bl_idname, text="Bake", icon="LIGHT_AREA")
        work = background.running()
        if (
            work is None
            and stopped.offered() is None
            and resume_bake.is_interrupted(context.object)
        ):
            layout.operator(resume_bake.LEAFLIGHT_OT_resume_bake.bl_idname, icon="RECOVER_LAST")
        if work is not None:
            versions.draw_progress(layout, work.progress.fraction, work.status())
            layout.operator(stopped.LEAFLIGHT_OT_stop_bake.bl_idname, icon="CANCEL")
        elif stopped.offered() is not None:
            self._draw_offer(context, stopped.offered())
        elif background.failure():
            sentence(context, layout, background.failure(), icon="ERROR")
        if work is None and stopped.offered() is None and settings.bake_id:
            self._draw_result(context, settings)

    def _draw_quality(self, context, settings):
        """The three qualities, and beneath each the time that it takes."""
        column = self.layout.column(align=True)
        column.active = not settings.fixed_samples
        row = column.row(align=True)
        for quality in properties.QUALITIES:
            row.prop_enum(settings, "quality", quality)
        if settings.fixed_samples:
            sentence(
                context, column, iface_("Fixed Samples, under Advanced, goes before"), icon="INFO"
            )
            return
        obj = context.object
        estimates = [estimate_bake.estimate_of(obj, e) for e in properties.QUALITIES.values()]
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
        sentence(context, self.layout, iface_("Stopped: %s") % job.outcome(), icon="QUESTION")
        row = self.layout.row(align=True)
        row.operator(stopped.LEAFLIGHT_OT_keep_bake.bl_idname, icon="CHECKMARK")
        row.operator(stopped.LEAFLIGHT_OT_throw_bake_away.bl_idname, icon="TRASH")

    def _draw_result(self, context, settings):
        layout = self.layout
        change = staleness.change_to_tell(context.object)
        if change:
            sentence(context, layout, change, icon="ERROR")
        else:
            layout.label(
                text=iface_("Baked in %s s") % f"{settings.bake_seconds:.0f}", icon="CHECKMARK"
            )
            if settings.bake_outcome:
                text = settings.bake_outcome
                sentence(context, layout, text[0].upper() + text[1:], icon="BLANK1")
            relit = lamps.sentence(context.object)
            if relit:
                sentence(context, layout, relit, icon="LIGHT")
        for warning in settings.bake_warnings.splitlines():
            sentence(context, layout, warning, icon="ERROR")
        if continue_bake.can_continue(context.object):
            layout.operator(continue_bake.LEAFLIGHT_OT_continue_bake.bl_idname, icon="PLAY")
        _, reason = surface_material.shading_in_use(settings)
        if reason:
            sentence(context, layout, reason, icon="INFO")


def register():
    bpy.utils.register_class(LEAFLIGHT_PT_bake)


def unregister():
    bpy.utils.unregister_class(LEAFLIGHT_PT_bake)
