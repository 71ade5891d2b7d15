# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads and writes files by VTK. Tests are skipped without VTK."""

import numpy as np
import pytest


def vtk():
    return pytest.importorskip("vtkmodules.all", reason="VTK (python3-vtk9) is not installed")


def array_of(values, name):
    """Returns an array of VTK with numbers (n,) or (n, channels)."""
    support = pytest.importorskip("vtkmodules.util.numpy_support")
    array = support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def image_of(values, spacing=(1, 1, 1), origin=(0, 0, 0)):
    """Returns a vtkImageData with the scalars "h", values [z, y, x], at its points."""
    image = vtk().vtkImageData()
    image.SetDimensions(values.shape[::-1])
    image.SetSpacing(spacing)
    image.SetOrigin(origin)
    image.GetPointData().SetScalars(array_of(values.ravel(), "h"))
    return image


def write(kind, path, data, **settings):
    """Writes data by the class vtk{kind}Writer; settings: arguments by names of its methods."""
    writer = getattr(vtk(), f"vtk{kind}Writer")()
    writer.SetInputData(data)
    writer.SetFileName(str(path))
    for name, arguments in settings.items():
        getattr(writer, name)(*arguments)
    writer.Write()


def read(kind, path):
    """Returns what the class vtk{kind}Reader reads."""
    reader = getattr(vtk(), f"vtk{kind}Reader")()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def numpy_of(array):
    return pytest.importorskip("vtkmodules.util.numpy_support").vtk_to_numpy(array)


def numbers_of(data):
    """Returns {name: numbers} of the arrays of points or cells."""
    arrays = map(data.GetArray, range(data.GetNumberOfArrays()))
    return {array.GetName(): numpy_of(array) for array in arrays}
