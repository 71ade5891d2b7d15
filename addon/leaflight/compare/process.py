# SPDX-License-Identifier: GPL-3.0-or-later
"""A comparison in a background Blender of its own, so that the window stays free."""

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

from ..operators import jobs

# How the child begins the lines that are for the window.
MARK = "LEAFLIGHT COMPARISON "
# Cycles' own report of how far it is.
_SAMPLES = re.compile(r"Sample (\d+)/(\d+)")
_CHILD = Path(__file__).with_name("child.py")
_POLL_SECONDS = 0.1


def can_start():
    """Whether there is a program to start: Blender as a Python module has none."""
    return bool(bpy.app.binary_path)


def _save_copy(blend):
    """Saves the file that is open, without the picture of it that file browsers show.

    Blender would draw that anew for it, and the window would stand still for many seconds where
    there is no graphics card. Raises RuntimeError.
    """
    preferences = bpy.context.preferences
    paths, changed = preferences.filepaths, preferences.is_dirty
    chosen = paths.file_preview_type
    paths.file_preview_type = "NONE"
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True, compress=False)
    finally:
        paths.file_preview_type = chosen
        preferences.is_dirty = changed


class ComparisonJob(jobs.Job):
    """Renders the saved copy of the file that is open, and reads the figures from the child."""

    def __init__(self, isosurface, folder, samples, baked_samples, share):
        """Saves the copy. Raises LeaflightError."""
        self._files = tempfile.TemporaryDirectory(prefix="leaflight-")
        blend = Path(self._files.name) / "comparison.blend"
        try:
            _save_copy(blend)
        except RuntimeError as error:
            self._files.cleanup()
            raise LeaflightError(
                f"{blend}: cannot save a copy of the scene there to render it: {error}"
            ) from None
        self.isosurface, self._status, self.figures = isosurface.name, "Blender starts", None
        request = {
            "object": isosurface.name_full,
            "scene": bpy.context.scene.name,
            "folder": str(folder),
            "samples": samples,
            "baked_samples": baked_samples,
            "share": share,
        }
        self._command = [
            *(bpy.app.binary_path, "--background", str(blend)),
            # It may be enabled for this session alone.
            *("--addons", __package__.rpartition(".")[0]),
            *("--python-exit-code", "1", "--python", str(_CHILD), "--", json.dumps(request)),
        ]

    def status(self, _progress):
        return self._status

    def run(self, progress):
        """In any thread: touches no Blender data. Raises LeaflightError, Cancelled."""
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
        """Reads until the child ends; returns its last words."""
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
        # A Blender that has printed its result may crash at its end, which is no matter.
        end = time.monotonic() + 10.0
        while child.poll() is None and time.monotonic() < end:
            time.sleep(_POLL_SECONDS)
        return " ".join(words) or f"exit status {child.returncode}"

    def ended(self):
        return "The comparison was cancelled; nothing has changed"

    def apply(self):
        obj = bpy.data.objects.get((self.isosurface, None))
        if obj is not None:
            obj.leaflight.comparison = self.figures["sentence"]
        if self.figures["doubt"]:
            self.warnings = (self.figures["doubt"],)
        return self.figures["report"]
