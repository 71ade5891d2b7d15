# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs VTK in a separate process: FlyingEdges3D, then ProbeFilter at the resulting vertices."""

import json
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from leaflight import LeaflightError

SCRIPT = Path(__file__).with_name("vtk_contours.py")


class VtkPeer:
    """Contours a volume and looks up baked radiance, in index coordinates.

    values: float32 [z, y, x]; radiance: float32 [z, y, x, 3], over the whole extent of the same
    box.
    """

    def __init__(self, values, radiance):
        """Raises LeaflightError if this Python has no VTK."""
        if find_spec("vtkmodules") is None:
            raise LeaflightError(
                "bench scrub compares contours with VTK, which this Python does not have: install "
                "the Debian package python3-vtk9, or vtk with pip."
            )
        self._folder = tempfile.TemporaryDirectory(prefix="leaflight-")
        folder = Path(self._folder.name)
        np.save(folder / "values.npy", np.asarray(values, np.float32))
        np.save(folder / "radiance.npy", radiance)
        self._process = subprocess.Popen(
            [sys.executable, str(SCRIPT), str(folder)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def contour(self, isovalue):
        """Returns (wall-clock milliseconds, triangles) of one isovalue."""
        print(isovalue, file=self._process.stdin, flush=True)
        return json.loads(self._process.stdout.readline())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        self._folder.cleanup()
