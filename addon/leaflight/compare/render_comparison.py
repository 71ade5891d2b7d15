# SPDX-License-Identifier: GPL-3.0-or-later
"""Render Comparison: the baked surface beside the same surface path-traced by Cycles."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty

from .. import versions
from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..stage import scene_export
from ..store import bake_files
from . import figures, files, process, stills


class LEAFLIGHT_OT_render_comparison(background.BackgroundOperator, bpy.types.Operator):
    bl_idname = "leaflight.render_comparison"
    bl_label = "Render Comparison"
    bl_description = (
        "Render the baked surface, the same surface path-traced by Cycles and by local shading, "
        "and measure the difference, in a background Blender. Esc cancels"
    )
    bl_options = set()
    conditions = (
        jobs.is_free,
        *checks.BAKE,
        checks.needs(lambda context: context.scene.camera, "Add a camera to the scene first"),
    )

    samples: IntProperty(
        name="Cycles Samples",
        description="Samples per pixel of the path-traced still: more take longer, with less noise",
        default=256,
        min=2,
        soft_max=4096,
    )
    baked_samples: IntProperty(
        name="Baked Samples",
        description="Samples per pixel of the baked still; only its walls need many",
        default=64,
        min=2,
        soft_max=4096,
    )
    share: FloatProperty(
        name="Resolution",
        description="Share of the scene's resolution that the stills have",
        default=100.0,
        min=1.0,
        max=100.0,
        subtype="PERCENTAGE",
    )
    folder: StringProperty(
        name="Folder",
        description="Folder for the pictures and figures; empty means beside the bake",
        subtype="DIR_PATH",
        options=versions.RELATIVE_PATH,
    )
    asked: BoolProperty(options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context, _event):
        if self.asked:
            return self.run_modal(context)
        self._by_hand = True
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        for name in ("samples", "baked_samples", "share", "folder"):
            layout.prop(self, name)

    def execute(self, context):
        if getattr(self, "_by_hand", False) and process.can_start():
            names = ("samples", "baked_samples", "share", "folder")
            chosen = {name: getattr(self, name) for name in names}
            return self.invoke_again(bpy.ops.leaflight.render_comparison, **chosen)
        return checks.LeaflightOperator.execute(self, context)

    def run(self, context):
        isosurface = active_volume(context)
        found = rendered(
            context,
            isosurface,
            _make_folder(isosurface, self.folder),
            self.samples,
            self.baked_samples,
            self.share / 100.0,
        )
        self.report({"INFO"}, found["report"])
        if found["doubt"]:
            self.report({"WARNING"}, found["doubt"])
        isosurface.leaflight.comparison = found["sentence"]

    def start(self, context):
        isosurface = active_volume(context)
        scene_export.export_scene(context, isosurface)
        stills.check_lit(isosurface, isosurface.leaflight.isovalue)
        folder = _make_folder(isosurface, self.folder)
        return process.ComparisonJob(
            isosurface, folder, self.samples, self.baked_samples, self.share / 100.0
        )


def rendered(context, isosurface, folder, samples, baked_samples, share=1.0, report=None):
    """Renders and writes a comparison into a folder.

    Returns {"path": of the .json, "sentence": for the panel, "doubt": a warning or an empty text,
    "report": for the status line}. Raises LeaflightError.
    """
    scene_export.export_scene(context, isosurface)
    result = stills.compare(context, isosurface, samples, baked_samples, share, report)
    path = files.write(context.scene, folder, isosurface.name, result)
    found, doubt = figures.summary(result), figures.doubt(result)
    return {
        "path": str(path),
        "sentence": f"{found}. {doubt}" if doubt else found,
        "doubt": doubt,
        "report": f"{found}; pictures in {folder}",
    }


def _make_folder(isosurface, chosen):
    folder = Path(bpy.path.abspath(chosen or str(bake_files.locate(isosurface).parent)))
    bake_files.make_folder(folder)
    return folder


CLASSES = (LEAFLIGHT_OT_render_comparison,)
