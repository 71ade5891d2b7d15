# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs VTK in a separate process: FlyingEdges3D, then ProbeFilter at the resulting vertices."""

import json
import os
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from leaflight import LeaflightError


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
            [sys.executable, __file__, str(folder)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
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


# ---- The process ----


def image(array, spacing, components):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    data = vtkImageData()
    data.SetDimensions(*array.shape[2::-1])
    data.SetSpacing(*spacing)
    values = numpy_to_vtk(array.reshape(-1, components) if components > 1 else array.ravel())
    data.GetPointData().SetScalars(values)
    # Keep the array, because VTK does not keep its memory alive.
    data.array = array
    return data


def main(folder):
    """Answers each isovalue on a line with [milliseconds, triangles].

    folder: holds values.npy [z, y, x] and radiance.npy [z, y, x, 3].
    """
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkProbeFilter

    values = np.load(folder / "values.npy")
    radiance = np.load(folder / "radiance.npy")
    box = np.array(values.shape[::-1]) - 1.0
    contours = vtkFlyingEdges3D()
    contours.SetInputData(image(values, (1, 1, 1), 1))
    contours.ComputeNormalsOff()
    contours.ComputeGradientsOff()
    contours.ComputeScalarsOff()
    probe = vtkProbeFilter()
    probe.SetInputConnection(contours.GetOutputPort())
    probe.SetSourceData(image(radiance, box / (np.array(radiance.shape[2::-1]) - 1.0), 3))
    for line in sys.stdin:
        contours.SetValue(0, float(line))
        contours.Modified()
        start = time.perf_counter()
        probe.Update()
        milliseconds = 1e3 * (time.perf_counter() - start)
        triangles = contours.GetOutput().GetNumberOfPolys()
        print(json.dumps([milliseconds, triangles]), flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
