# SPDX-License-Identifier: GPL-3.0-or-later
"""python3 vtk_contours.py FOLDER: answers each isovalue on a line with [milliseconds, triangles].

FOLDER holds values.npy [z, y, x] and radiance.npy [z, y, x, 3] (vtk_peer.py).
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkProbeFilter


def image(array, spacing, components):
    data = vtkImageData()
    data.SetDimensions(*array.shape[2::-1])
    data.SetSpacing(*spacing)
    values = numpy_to_vtk(array.reshape(-1, components) if components > 1 else array.ravel())
    data.GetPointData().SetScalars(values)
    # Keep the array, because VTK does not keep its memory alive.
    data.array = array
    return data


def main(folder):
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


main(Path(sys.argv[1]))
