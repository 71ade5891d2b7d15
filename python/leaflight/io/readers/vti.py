# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK image data in XML, in one piece or several. A .pvti has its pieces in other files."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.memory import new_voxels
from .channels import channel_of
from .checks import data_file, text
from .encodings import NUMBERS
from .stored import StoredVolume
from .vtk_image import Image, ImageArray, matrix_of, open_image
from .vtk_xml import Document, check_claim, dtype_of, open_document, values_of
from .watched import STAGE, begin

_MOST_PIECES = 1 << 14
# Upper bound on the size of an image, relative to all of its pieces.
_MOST_EMPTY = 100
_PLACE = {"Origin": "0 0 0", "Spacing": "1 1 1", "Direction": "1 0 0 0 1 0 0 0 1"}


@dataclass(frozen=True)
class _Piece:
    """A part of an image. extent: The first and last of its points along x, y and z."""

    document: Document
    element: Element
    extent: Array

    def arrays(self, of_cells: bool) -> dict[str, Element]:
        """Returns the numeric arrays by name."""
        found = self.element.findall(("CellData" if of_cells else "PointData") + "/DataArray")
        found = [one for one in found if one.get("type", "").lower() in NUMBERS]
        return {one.get("Name") or "unnamed": one for one in found}

    def shape(self, of_cells: bool) -> tuple[int, ...]:
        """Returns the shape [z, y, x] of an array."""
        counts = self.extent[:, 1] - self.extent[:, 0] + 1
        return tuple(int(n) for n in (np.maximum(1, counts - 1) if of_cells else counts)[::-1])


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """Opens an image. Its arrays are datasets; components of vectors and colors are channels."""
    document = open_document(path)
    image = _image(document)
    pieces = _pieces(document, image)
    # Some programs write a larger extent than they save.
    low = np.min([piece.extent[:, 0] for piece in pieces], axis=0)
    high = np.max([piece.extent[:, 1] for piece in pieces], axis=0)
    points = tuple(int(n) for n in high - low + 1)
    claimed = tuple(int(n) for n in _extent(image, "WholeExtent") @ [-1, 1] + 1)
    if prod(points) > _MOST_EMPTY * sum(prod(piece.shape(False)) for piece in pieces):
        raise LeaflightError(
            f"{path}: nearly all of the {text(points)} points are in no piece; save the image "
            "again."
        )
    notes: tuple[str, ...] = ()
    if claimed != points:
        notes = (f"The pieces hold {text(points)} of the {text(claimed)} points in the header.",)
    # Parallel files omit the direction.
    first = _image(pieces[0].document)
    places = [image.get(key) or first.get(key) or default for key, default in _PLACE.items()]
    origin, spacing, axes = (np.array(numbers.split(), np.float64) for numbers in places)
    matrix = matrix_of(origin, spacing, axes, low)
    arrays = [
        _array(name, of_cells, pieces, low)
        for of_cells in (False, True)
        for name in {name: None for piece in pieces for name in piece.arrays(of_cells)}
    ]
    return open_image(Image(path, points, matrix, arrays, notes), dataset)


def _image(document: Document) -> Element:
    for kind in ("ImageData", "PImageData"):
        image = document.root.find(kind)
        if image is not None:
            return image
    kind = (document.root.get("type") or "no")[:40]
    raise LeaflightError(
        f"{document.path}: the file holds {kind} data, but a volume needs ImageData; apply "
        "Resample To Image in ParaView, and save as .vti."
    )


def _pieces(document: Document, image: Element) -> list[_Piece]:
    """Returns the pieces of an image, including those in other files. Raises LeaflightError."""
    found: list[_Piece] = []
    for piece in image.findall("Piece"):
        source = piece.get("Source")
        if source is None:
            is_whole = piece.get("Extent") is None
            extent = _extent(image, "WholeExtent") if is_whole else _extent(piece, "Extent")
            found.append(_Piece(document, piece, extent))
        elif image.tag == "PImageData":
            other = open_document(data_file(document.path, source))
            if other.root.find("PImageData") is not None:
                raise LeaflightError(
                    f"{document.path}: the piece {source[:100]} consists of pieces itself; save "
                    "the image from ParaView as one."
                )
            found += _pieces(other, _image(other))
    found = [piece for piece in found if (piece.extent[:, 0] <= piece.extent[:, 1]).all()]
    if not 0 < len(found) <= _MOST_PIECES:
        raise LeaflightError(
            f"{document.path}: the image has {len(found)} pieces that are not empty; save it from "
            "ParaView as one."
        )
    return found


def _extent(element: Element, key: str) -> Array:
    extent = np.array(element.attrib[key].split(), np.int64).reshape(3, 2)
    if np.abs(extent).max() > 1 << 31:
        raise ValueError("an extent")
    return extent


def _array(name: str, of_cells: bool, pieces: Sequence[_Piece], low: Array) -> ImageArray:
    """Joins the arrays of this name of all pieces. low: First of the image's points."""
    parts = [(one, one.arrays(of_cells)[name]) for one in pieces if name in one.arrays(of_cells)]
    document, element = parts[0][0].document, parts[0][1]
    dtype, channels = dtype_of(document, element), int(element.get("NumberOfComponents") or 1)
    for piece, _ in parts:
        check_claim(piece.document, piece.shape(of_cells), channels * dtype.itemsize)

    def read(
        channel: int, dims: tuple[int, ...], progress: Progress
    ) -> tuple[Array, Sequence[str]]:
        begin(progress, STAGE, prod(dims) * channels * dtype.itemsize)
        if len(parts) == 1 and parts[0][0].shape(of_cells) == dims[::-1]:
            return _values(*parts[0], of_cells, channels, progress)[..., channel], ()
        values, found = new_voxels(dims[::-1], dtype), np.zeros(dims[::-1], bool)
        for piece, element in parts:
            begins = (piece.extent[:, 0] - low)[::-1]
            place = tuple(slice(a, a + n) for a, n in zip(begins, piece.shape(of_cells)))
            values[place] = _values(piece, element, of_cells, channels, progress)[..., channel]
            found[place] = True
        missing = found.size - int(found.sum())
        if not missing:
            return values, ()
        note = f"{missing} of {found.size} voxels are in no piece, so they are missing data."
        return np.where(found, values, np.float32(np.nan)).astype(np.float32), (note,)

    # VTK names the components of some arrays.
    names = [element.get(f"ComponentName{k}") for k in range(channels)] if channels < 100 else []
    named = tuple(channel_of(one) for one in names) if any(names) else ()
    return ImageArray(name, of_cells, dtype, channels, read, named)


def _values(
    piece: _Piece, element: Element, of_cells: bool, channels: int, progress: Progress
) -> Array:
    return values_of(piece.document, element, (*piece.shape(of_cells), channels), progress)
