# SPDX-License-Identifier: GPL-3.0-or-later
"""Render Comparison: the baked surface beside the same surface path-traced by Cycles.

A background Blender renders it, so that the window stays free.
"""

import json
import re
import subprocess
import tempfile
import threading
import time
from collections import deque
from pathlib import Path

import bpy
import leaflight
from leaflight import LeaflightError

from .. import props, versions
from ..operators import background, checks, jobs
from ..operators.checks import active_volume
from ..props import FloatProperty, IntProperty, StringProperty
from ..stage import scene_export
from ..store import bake_files
from . import files, render, stills

# Prefix of the child's lines that are messages.
MARK = "LEAFLIGHT COMPARISON "
# Progress of a render in the output of Cycles.
_SAMPLES = re.compile(r"Sample (\d+)/(\d+)")
_CHILD = Path(__file__).with_name("child.py")
_POLL_SECONDS = 0.1


def can_start():
    """True if there is a program to start. Blender as a Python module has none."""
    return bool(bpy.app.binary_path)


def _save_copy(blend):
    """Saves a copy of the open file, without its preview image. Raises RuntimeError.

    Drawing the preview would block the window for many seconds without a graphics card.
    """
    preferences = bpy.context.preferences
    changed = preferences.is_dirty
    try:
        with render.overridden(preferences.filepaths, file_preview_type="NONE"):
            bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True, compress=False)
    finally:
        preferences.is_dirty = changed


class ComparisonJob(jobs.Job):
    """Renders the saved copy of the file that is open, and reads the figures from the child."""

    cancelled = "The comparison was cancelled; nothing has changed"

    def __init__(self, isosurface, folder, samples, baked_samples, share):
        """Saves a copy of the open file. Raises LeaflightError."""
        self._files = tempfile.TemporaryDirectory(prefix="leaflight-")
        blend = Path(self._files.name) / "comparison.blend"
        try:
            _save_copy(blend)
        except RuntimeError as error:
            self._files.cleanup()
            raise LeaflightError(
                f"{blend}: the copy of the scene to render cannot be saved: {error}"
            ) from None
        self.isosurface, self._status, self.figures = isosurface.name, "Blender starts", None
        request = {
            "object": isosurface.name_full,
            "scene": bpy.context.scene.name,
            "arguments": (str(folder), samples, baked_samples, share),
        }
        self._command = [
            *(bpy.app.binary_path, "--background", str(blend)),
            # The add-on may be enabled only for this session.
            *("--addons", __package__.rpartition(".")[0]),
            *("--python-exit-code", "1", "--python", str(_CHILD), "--", json.dumps(request)),
        ]

    def status(self, _progress):
        return self._status

    def run(self, progress):
        """Runs the child, in any thread. Touches no Blender data.

        Raises LeaflightError, Cancelled.
        """
        with self._files:
            child = subprocess.Popen(
                self._command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                encoding="utf-8",
                errors="replace",
            )
            try:
                said = self._follow(child, progress)
            finally:
                child.kill()
                child.wait()
                child.stdout.close()
        if self.figures is None:
            raise LeaflightError(
                f"The background Blender of the comparison ended without a result: {said}"
            )
        if "error" in self.figures:
            raise LeaflightError(self.figures["error"])

    def _follow(self, child, progress):
        """Reads the child's output to its end, and returns its last lines."""
        words, done = deque(maxlen=3), [0.0, 0.0, ""]

        def read():
            for line in child.stdout:
                if line.startswith(MARK):
                    message = json.loads(line.removeprefix(MARK))
                    if "done" in message:
                        done[:] = message["done"], message["part"], message["name"]
                    else:
                        self.figures = message
                elif line.strip():
                    words.append(line.strip())
                found = _SAMPLES.search(line)
                share = int(found[1]) / int(found[2]) if found else 0.0
                if done[2]:
                    percent = 100.0 * (done[0] + share * done[1])
                    self._status = f"{percent:3.0f} % {done[2]}"

        reader = threading.Thread(target=read, name="Leaflight comparison")
        reader.start()
        while reader.is_alive():
            if progress.cancelled:
                child.kill()
                reader.join()
                raise leaflight.Cancelled
            reader.join(_POLL_SECONDS)
        # Ignore a crash of Blender at its end, after it has printed its result.
        end = time.monotonic() + 10.0
        while child.poll() is None and time.monotonic() < end:
            time.sleep(_POLL_SECONDS)
        return " ".join(words) or f"exit status {child.returncode}"

    def apply(self):
        obj = bpy.data.objects.get((self.isosurface, None))
        if obj is not None:
            obj.leaflight.comparison = self.figures["sentence"]
        if self.figures["doubt"]:
            self.warnings = (self.figures["doubt"],)
        return self.figures["report"]


class LEAFLIGHT_OT_render_comparison(background.AskingOperator, bpy.types.Operator):
    bl_label = "Render Comparison"
    bl_description = (
        "Render the isosurface as baked, path-traced by Cycles and with local shading, "
        "and measure the differences. A second Blender renders in the background. Esc "
        "cancels"
    )
    bl_options = set()
    conditions = (
        jobs.is_free,
        *checks.BAKE,
        checks.needs(lambda context: context.scene.camera, "Add a camera to the scene first"),
    )

    samples: IntProperty(
        "Cycles Samples",
        "Samples per pixel of the path-traced still. More samples take longer and reduce noise",
        256,
        min=2,
        soft_max=4096,
    )
    baked_samples: IntProperty(
        "Baked Samples",
        "Samples per pixel of the baked still; only its walls need many",
        64,
        min=2,
        soft_max=4096,
    )
    share: FloatProperty(
        "Resolution",
        "Resolution of the stills, as a share of the scene's",
        100.0,
        min=1.0,
        max=100.0,
        subtype="PERCENTAGE",
    )
    folder: StringProperty(
        "Folder",
        "Folder of the pictures and figures; empty is beside the bake",
        subtype="DIR_PATH",
        options=versions.RELATIVE_PATH,
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        props.draw(layout, self, "samples", "baked_samples", "share", "folder")

    def execute(self, context):
        if self._by_hand and can_start():
            return super().execute(context)
        # Scripts wait for the comparison.
        return checks.LeaflightOperator.execute(self, context)

    def run(self, context):
        isosurface = active_volume(context)
        found = rendered(context, isosurface, *self._arguments(isosurface))
        self.report({"INFO"}, found["report"])
        if found["doubt"]:
            self.report({"WARNING"}, found["doubt"])
        isosurface.leaflight.comparison = found["sentence"]

    def start(self, context):
        isosurface = active_volume(context)
        scene_export.export_scene(context, isosurface)
        stills.check_lit(isosurface, isosurface.leaflight.isovalue)
        return ComparisonJob(isosurface, *self._arguments(isosurface))

    def _arguments(self, isosurface):
        folder = Path(bpy.path.abspath(self.folder or str(bake_files.locate(isosurface).parent)))
        bake_files.make_folder(folder)
        return folder, self.samples, self.baked_samples, self.share / 100.0


def rendered(context, isosurface, folder, samples, baked_samples, share=1.0, report=None):
    """Renders and writes a comparison into a folder.

    Returns {"path": of the .json, "sentence": for the panel, "doubt": a warning or an empty text,
    "report": for the status line}. Raises LeaflightError.
    """
    scene_export.export_scene(context, isosurface)
    result = stills.compare(context, isosurface, samples, baked_samples, share, report)
    path = files.write(folder, isosurface.name, result)
    found, doubt = stills.summary(result), stills.doubt(result)
    return {
        "path": str(path),
        "sentence": f"{found}. {doubt}" if doubt else found,
        "doubt": doubt,
        "report": f"{found}; pictures in {folder}",
    }
