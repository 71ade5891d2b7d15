# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions shared by the writers of VTK's files."""

import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkObject, vtkStringArray

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkDataObject
    from vtkmodules.vtkIOXML import vtkXMLWriter


def add_text_and_numbers(data: "vtkDataObject", **named: str | ArrayLike) -> None:
    """Adds field data by name: texts, numbers or lists of numbers."""
    for name, value in named.items():
        if isinstance(value, str):
            array = vtkStringArray()
            array.InsertNextValue(value)
        else:
            array = numpy_to_vtk(np.atleast_1d(np.asarray(value, np.float64)), deep=True)
        array.SetName(name)
        data.GetFieldData().AddArray(array)


def write(writer: "vtkXMLWriter", data: "vtkDataObject", path: Path) -> None:
    """Writes a data set by one of VTK's XML writers, compressed. Raises OSError."""
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    # Append raw bytes to the XML, as ParaView does: smaller and faster than base64.
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    # Suppress VTK's text about a full disk; the error below replaces it.
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.SetGlobalWarningDisplay(False)
    try:
        written = writer.Write()
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)
    # VTK does not notice if the disk is full at the last bytes.
    if not written or not _end(path).endswith(b"</VTKFile>"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _end(path: Path) -> bytes:
    with open(path, "rb") as file:
        file.seek(max(0, path.stat().st_size - 64))
        return file.read().rstrip()
