# SPDX-License-Identifier: GPL-3.0-or-later
"""The planes of a DICOM file: positions, and the meaning of stored numbers."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pydicom

from ...._core import LeaflightError
from ....arrays import Array
from ....volume.label_table import Label
from .header import Header, Pixels, damaged_header, pixels_of
from .segments import segments_of

# Numbers of the standard: kinds of objects, and tags that mark pages as times.
_SEGMENTATIONS = {"1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.66.7"}
_PARAMETRIC_MAP = "1.2.840.10008.5.1.4.1.1.30"
_TIMES = {0x00181063, 0x00181065}
# Least z component of a vertical direction. Upper bound on the distance, in pages, of the first
# page from the position of a dose whose offsets are heights in the patient.
_VERTICAL, _NEAR = 0.999, 0.1

Floats = tuple[float, ...]


@dataclass(frozen=True)
class Plane:
    """One plane of a volume.

    page: Number of the page in the file.
    uid: Identifier of the file's object.
    order: Sort key of planes at one position: time, number, page, acquisition and its time.
    label: Name of the segment or the stack that the plane belongs to.
    segment: Number of the segment, 0 without one.
    labels: The segments of the file.
    slope, intercept: Factor and offset from stored numbers to values.
    position: Position of the first pixel in LPS, None if the header has none.
    location: Distance along the patient.
    axes: Directions of a row and of a column in LPS.
    normal: Direction in which planes count up.
    spacing: Distances between rows, and between columns.
    step: Distance to the next plane, if positions do not give it; 0 if unknown.
    between: The same without the thickness of slices, which may overlap or leave gaps.
    sparse: True if missing planes are 0.
    placed: True if the position is that of a patient.
    padding: Value of pixels without data, None if the header has none.
    remarks: Sentences for the user.
    """

    pixels: Pixels
    page: int
    uid: str
    order: Floats
    label: str
    segment: int
    labels: tuple[Label, ...]
    slope: float
    intercept: float
    position: Floats | None
    location: float | None
    axes: Floats
    normal: Floats
    spacing: Floats
    step: float
    between: float
    sparse: bool
    placed: bool
    padding: float | None
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class _File:
    """The data that all pages of a file share.

    segments: Segments by number.
    offsets: Distance of each page from the position of the file, or None.
    slices: Number of each page along the volume, or None.
    """

    tags: pydicom.Dataset
    pixels: Pixels
    segments: dict[int, Label]
    remarks: tuple[str, ...]
    offsets: Floats | None
    slices: Floats | None


class _Tags:
    """The tags of a page: its own, those that all pages share, or those of the file."""

    def __init__(
        self, file: pydicom.Dataset, own: pydicom.Dataset | None, shared: pydicom.Dataset | None
    ) -> None:
        self.file, self.own = file, own
        self._groups = [group for group in (own, shared) if group is not None]

    def get(self, name: str, sequence: str, otherwise: Any = None) -> Any:
        for group in self._groups:
            items = group.get(sequence, None)
            if items and items[0].get(name, None) is not None:
                return items[0].get(name)
        value = self.file.get(name, None)
        return otherwise if value is None else value


def planes_of(header: Header) -> list[Plane]:
    """Returns all planes of a picture. An enhanced one has many. Raises LeaflightError."""
    tags = header.tags
    try:
        _check_kind(header)
        pixels = pixels_of(header)
        file = _File(
            tags=tags,
            pixels=pixels,
            segments=segments_of(tags),
            remarks=_remarks(tags),
            offsets=_vector(tags, "GridFrameOffsetVector", pixels),
            slices=_vector(tags, "SliceVector", pixels),
        )
        # Get each sequence once, because pydicom searches it completely each time.
        own = list(tags.get("PerFrameFunctionalGroupsSequence", None) or [])
        shared = (tags.get("SharedFunctionalGroupsSequence", None) or [None])[0]
        return [
            _plane(file, _Tags(tags, own[page] if own else None, shared), page)
            for page in range(pixels.pages)
        ]
    except LeaflightError:
        raise
    except Exception as error:
        # On damaged headers pydicom raises many types of exceptions when a tag is read.
        raise damaged_header(header.file) from error


def _check_kind(header: Header) -> None:
    """Raises LeaflightError for a picture of tiles, which are not planes of a volume."""
    tags = header.tags
    if "MOSAIC" in (tags.get("ImageType", None) or ()):
        raise LeaflightError(
            f"{header.file}: this is a Siemens mosaic of slices; convert the series with "
            "dcm2niix, and open the NIfTI file."
        )
    if "TotalPixelMatrixColumns" in tags:
        raise LeaflightError(
            f"{header.file}: the pages are tiles of a microscope slide, not slices of a volume; "
            "choose another series."
        )


def _vector(tags: pydicom.Dataset, name: str, pixels: Pixels) -> Floats | None:
    """Returns a number for each page of a file, or None.

    Raises LeaflightError if numbers are missing.
    """
    vector = _floats(tags.get(name, None)) if pixels.pages > 1 else None
    if vector is not None and len(vector) != pixels.pages:
        raise LeaflightError(
            f"{pixels.file}: the header has positions for {len(vector)} planes, but the file has "
            f"{pixels.pages}: it is damaged, fetch it again."
        )
    return vector


def _plane(file: _File, tags: _Tags, page: int) -> Plane:
    header, pixels, remarks = file.tags, file.pixels, file.remarks
    axes, position = _place(tags)
    spacing = _floats(
        tags.get("PixelSpacing", "PixelMeasuresSequence")
        or header.get("ImagerPixelSpacing", None)
        or header.get("NominalScannedPixelSpacing", None),
        2,
    )
    between = _number(tags.get("SpacingBetweenSlices", "PixelMeasuresSequence"))
    gap = between or _number(tags.get("SliceThickness", "PixelMeasuresSequence"))
    normal = np.cross(axes[:3], axes[3:])
    placed = position is not None
    stepped = pixels.pages > 1 and tags.own is None
    if stepped:
        along = _place_of_page(file, position, normal, gap or 1.0, page)
        position = _tuple(np.add(position or (0.0, 0.0, 0.0), along))
        # The pages of a gamma camera may be numbered against their normal.
        normal = -normal if gap < 0 else normal
    if spacing is None:
        remarks += ("The header has no pixel size; 1 mm is assumed.",)
    if not gap and (position is None or (stepped and file.offsets is None)):
        remarks += ("The header has no distance between slices; 1 mm is assumed.",)
    slope, intercept = _scale(tags)
    segment, label = _segment(tags, file.segments)
    location = header.get("SliceLocation", None)
    padding = _padding(file)
    return Plane(
        pixels=pixels,
        page=page,
        uid=str(header.get("SOPInstanceUID", "")),
        order=_order(tags, page),
        label=label,
        segment=segment,
        labels=tuple(label for label in file.segments.values() if label.number > 0),
        slope=slope,
        intercept=intercept,
        position=position,
        location=None if location is None else _number(location),
        axes=axes,
        normal=_tuple(normal),
        spacing=spacing or (1.0, 1.0),
        step=abs(gap),
        between=abs(between),
        sparse=str(header.get("SOPClassUID", "")) in _SEGMENTATIONS,
        placed=placed,
        padding=None if padding is None else padding * slope + intercept,
        remarks=remarks,
    )


def _place(tags: _Tags) -> tuple[Floats, Floats | None]:
    """Returns the axes, by default those of the patient, and the position or None."""
    header = tags.file
    detector = (header.get("DetectorInformationSequence", None) or [pydicom.Dataset()])[0]
    axes = _floats(
        tags.get("ImageOrientationPatient", "PlaneOrientationSequence")
        or detector.get("ImageOrientationPatient", None)
        or header.get("ImageOrientation", None),
        6,
    )
    position = _floats(
        tags.get("ImagePositionPatient", "PlanePositionSequence")
        or detector.get("ImagePositionPatient", None)
        or header.get("ImagePosition", None),
        3,
    )
    return axes or (1.0, 0.0, 0.0, 0.0, 1.0, 0.0), position


def _place_of_page(
    file: _File, position: Floats | None, normal: Array, gap: float, page: int
) -> Array:
    """Returns the distance of a page from the position of its file, for pages without positions."""
    if file.offsets is not None:
        first, here = file.offsets[0], file.offsets[page]
        height = position[2] if position is not None else 0.0
        # Offsets of a dose are either distances from its position or heights in the patient.
        if first != 0 and abs(normal[2]) > _VERTICAL:
            if _near(first, height, abs(file.offsets[1] - first)):
                return np.array([0.0, 0.0, here - first])
        return normal * here
    if file.slices is not None:
        return normal * gap * (file.slices[page] - 1)
    pointers = file.tags.get("FrameIncrementPointer", None)
    if _TIMES & set(pointers if isinstance(pointers, Sequence) else [pointers]):
        return normal * 0
    return normal * gap * page


def _near(one: float, other: float, apart: float) -> bool:
    return abs(one - other) <= _NEAR * apart


def _scale(tags: _Tags) -> tuple[float, float]:
    """Returns the slope and the intercept from stored numbers to values."""
    header = tags.file
    dose = _number(header.get("DoseGridScaling", None))
    if dose:
        return dose, 0.0
    if str(header.get("SegmentationType", "")).upper() == "FRACTIONAL":
        return 1.0 / (_number(header.get("MaximumFractionalValue", None)) or 1.0), 0.0
    if str(header.get("SOPClassUID", "")) == _PARAMETRIC_MAP:
        slope = tags.get("RealWorldValueSlope", "RealWorldValueMappingSequence")
        intercept = tags.get("RealWorldValueIntercept", "RealWorldValueMappingSequence")
    else:
        slope = tags.get("RescaleSlope", "PixelValueTransformationSequence")
        intercept = tags.get("RescaleIntercept", "PixelValueTransformationSequence")
    return _number(slope) or 1.0, _number(intercept)


def _padding(file: _File) -> float | None:
    """Returns the stored number of pixels without data."""
    value = file.tags.get("PixelPaddingValue", None)
    if not isinstance(value, int):
        return None
    # The sign is lost if the tag has no type.
    half = 1 << (file.pixels.stored - 1)
    return float(value - 2 * half if file.pixels.signed and value >= half else value)


def _order(tags: _Tags, page: int) -> Floats:
    header = tags.file
    time = tags.get("TemporalPositionIndex", "FrameContentSequence")
    if time is None:
        time = header.get("TemporalPositionIdentifier", None)
    number = header.get("InstanceNumber", None)
    acquisition = header.get("AcquisitionNumber", None)
    moment = header.get("AcquisitionTime", None) or header.get("ContentTime", None)
    order = [_number(value) for value in (time, number, page, acquisition, moment)]
    return tuple(order)


def _segment(tags: _Tags, segments: dict[int, Label]) -> tuple[int, str]:
    """Returns the number of a plane's segment, 0 without one, and its name or that of its stack."""
    number = tags.get("ReferencedSegmentNumber", "SegmentIdentificationSequence")
    if number is not None:
        known = segments.get(int(number))
        return (known.number, known.name) if known else (0, f"segment {number}")
    stack = tags.get("StackID", "FrameContentSequence")
    return 0, f"stack {stack}" if stack else ""


def _remarks(header: pydicom.Dataset) -> tuple[str, ...]:
    """Returns sentences about a file whose values may differ from those in other programs."""
    remarks = []
    interpretation = str(header.get("PhotometricInterpretation", ""))
    if interpretation == "MONOCHROME1":
        remarks.append(
            "The series is MONOCHROME1: other programs show low values bright. Values are as "
            "stored."
        )
    if interpretation == "PALETTE COLOR":
        remarks.append("The values are indices of a color table, as stored.")
    kind = [str(word) for word in header.get("ImageType", None) or ()]
    if header.get("Modality", "") == "NM" and len(kind) > 2 and "RECON" not in kind[2]:
        remarks.append("The pages are views or times of a camera, not slices.")
    if header.get("ModalityLUTSequence", None):
        remarks.append(
            "The header has a table of values (Modality LUT), which is not applied. Values are "
            "as stored."
        )
    return tuple(remarks)


def _floats(numbers: Iterable[Any] | None, count: int = 0) -> Floats | None:
    """Returns `count` finite numbers, or None; a count of 0 allows any number of them."""
    if numbers is None or isinstance(numbers, str) or not isinstance(numbers, Sequence):
        return None
    floats = tuple(_number(number, np.nan) for number in numbers)
    if not floats or (count and len(floats) != count) or not np.isfinite(floats).all():
        return None
    return floats


def _number(value: Any, otherwise: float = 0.0) -> float:
    """Returns a finite number of a header, or a default if it has none."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return otherwise
    return number if np.isfinite(number) else otherwise


def _tuple(vector: Array) -> Floats:
    return tuple(float(number) for number in vector)
