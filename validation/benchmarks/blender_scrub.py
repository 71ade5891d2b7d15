# SPDX-License-Identifier: GPL-3.0-or-later
"""A new isovalue inside Blender, from the slider to the evaluated mesh, before any drawing."""

import json
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from leaflight import _core
from leaflight._core import Cancelled, LeaflightError

HERE = Path(__file__).resolve()
SCRIPT = HERE.with_name("scrub_scene.py")
ADDON = HERE.parents[2] / "addon" / "leaflight"
POLL_SECONDS = 0.1


def scrub_in_blender(baked, isovalue, repetitions, progress):
    """Milliseconds by the clock about an isovalue of a Bake: a dict.

    triangles; whole_ms: to the whole detail; moving_ms: while the isovalue moves, moving_triangles.
    Medians. blender: its version. Raises LeaflightError, Cancelled.
    """
    blender = shutil.which("blender")
    if blender is None:
        raise LeaflightError(
            "bench scrub measures in Blender, and there is none on the search path: install the "
            "Debian package blender."
        )
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        settings, answer = Path(folder, "settings.json"), Path(folder, "answer.json")
        baked.save(Path(folder, "bake.vdb"))
        work = {
            "modules": str(Path(_core.__file__).parents[1]),
            "addon": str(ADDON),
            "bake": str(Path(folder, "bake.vdb")),
            "isovalue": isovalue,
            "repetitions": repetitions,
            "answer": str(answer),
        }
        settings.write_text(json.dumps(work))
        options = ["--background", "--factory-startup", "-noaudio", "--python-exit-code", "1"]
        output = _run([blender, *options, "--python", str(SCRIPT), "--", str(settings)], progress)
        if not answer.exists():
            raise LeaflightError(f"Blender ended without an answer:\n{output[-2000:]}")
        return json.loads(answer.read_text())


def _run(command, progress):
    """Returns the output of a program. Raises Cancelled."""
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, text=True)
        try:
            while process.poll() is None:
                if progress.cancelled:
                    raise Cancelled("The measurement was cancelled.")
                time.sleep(POLL_SECONDS)
        finally:
            process.kill()
            process.wait()
        output.seek(0)
        return output.read()
