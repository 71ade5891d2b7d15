# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes as VTK publishes its examples: image data in XML, with one compressed block of bytes.

The format is the one that VTK's file formats describe as "appended", "raw", vtkZLibDataCompressor:
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import zlib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from .._core import LeaflightError
from ..volume.volume import Volume


def vtk_image(name):
    """A recipe (see volume_recipes.py) of the file of that name, whose values are bytes."""

    def volumes(folder, _):
        path = Path(folder) / name if folder else None
        return [_read(path)] if path is not None and path.exists() else None

    return volumes


def _read(path):
    xml, _, appended = path.read_bytes().partition(b'<AppendedData encoding="raw">')
    try:
        root = ElementTree.fromstring(xml + b"</VTKFile>")
        image, array = root.find("ImageData"), root.find(".//PointData/DataArray")
        kind = {"byte_order": "LittleEndian", "header_type": "UInt64"}
        if array.get("type") != "UInt8" or kind.items() - root.attrib.items():
            raise ValueError("of another kind")
        ends = np.array(image.get("WholeExtent").split(), int).reshape(3, 2)
        data = appended[appended.index(b"_") + 1 + int(array.get("offset")) :]
        values = np.frombuffer(_inflated(data), np.uint8)
        values = values.reshape((ends[:, 1] - ends[:, 0] + 1)[::-1])
        spacing = [float(length) for length in image.get("Spacing").split()]
    except (
        ArithmeticError,
        AttributeError,
        ValueError,
        ElementTree.ParseError,
        zlib.error,
    ) as error:
        raise LeaflightError(f"{path}: this is not VTK image data as expected: {error}.") from None
    return Volume(values.astype(np.float32), np.diag([*spacing, 1.0]), path.stem, str(path))


def _inflated(data):
    """The blocks: their number, two sizes, the compressed size of each, and then themselves."""
    count = int(np.frombuffer(data, "<u8", 1)[0])
    sizes = np.frombuffer(data, "<u8", count, 24)
    ends = 24 + 8 * count + np.cumsum(sizes)
    return b"".join(
        zlib.decompress(data[int(end - size) : int(end)]) for end, size in zip(ends, sizes)
    )
