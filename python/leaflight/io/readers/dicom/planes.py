# SPDX-License-Identifier: GPL-3.0-or-later
"""The planes of a DICOM file: where each lies, and what its numbers mean."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pydicom

from ...._core import LeaflightError
from ....arrays import Array
from .header import Header, Pixels, damaged_header, pixels_of

# By the standard's numbers: the kinds of objects, and the tags that say that pages are times.
_SEGMENTATIONS = {"1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.66.7"}
_PARAMETRIC_MAP = "1.2.840.10008.5.1.4.1.1.30"
_TIMES = {0x00181063, 0x00181065}
# How much of its length a vertical direction has along z, at least; how far, in distances of its
# pages, the first of them may be from the position of a dose that names its places themselves.
_VERTICAL, _NEAR = 0.999, 0.1

Floats = tuple[float, ...]


@dataclass(frozen=True)
class Plane:
    """One plane of a volume.

    page: of the file. uid: of the object that the file is.
    order: among planes at one place: time, number, page, acquisition and its time.
    label: of the segment or the stack that it belongs to.
    slope, intercept: they make the values of the stored numbers.
    position, axes: of the first pixel, and the directions of a row and of a column, in LPS; there
        is no position where the header has none. location: the distance along the patient alone.
    normal: the direction in which planes count up. spacing: between rows, between columns.
    step: the distance to the next plane, where positions do not give it; 0 where nothing does.
    sparse: whether planes that are not there are 0. placed: whether the position is a patient's.
    remarks: sentences for the user.
    """

    pixels: Pixels
    page: int
    uid: str
    order: Floats
    label: str
    slope: float
    intercept: float
    position: Floats | None
    location: float | None
    axes: Floats
    normal: Floats
    spacing: Floats
    step: float
    sparse: bool
    placed: bool
    remarks: tuple[str, ...]


class _Tags:
    """The tags of a page: its own, those that all pages share, or those of the file."""

    def __init__(self, header: pydicom.Dataset, page: int) -> None:
        self._header = header
        own = header.get("PerFrameFunctionalGroupsSequence", None)
        shared = header.get("SharedFunctionalGroupsSequence", None)
        self.own = own[page] if own else None
        self._groups = [group for group in (self.own, shared[0] if shared else None) if group]

    def get(self, name: str, sequence: str, otherwise: Any = None) -> Any:
        for group in self._groups:
            items = group.get(sequence, None)
            if items and items[0].get(name, None) is not None:
                return items[0].get(name)
        value = self._header.get(name, None)
        return otherwise if value is None else value


def planes_of(header: Header) -> list[Plane]:
    """All planes of a picture, of which an enhanced one has many. Raises LeaflightError."""
    try:
        pixels = pixels_of(header)
        labels = _labels(header.tags)
        remarks = _remarks(header.tags)
        return [_plane(header.tags, pixels, page, labels, remarks) for page in range(pixels.pages)]
    except LeaflightError:
        raise
    except Exception as error:
        # On damaged headers pydicom fails with whatever comes first, when a tag is looked at.
        raise damaged_header(header.file) from error


def _plane(
    header: pydicom.Dataset,
    pixels: Pixels,
    page: int,
    labels: dict[int, str],
    remarks: tuple[str, ...],
) -> Plane:
    tags = _Tags(header, page)
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
    spacing = _floats(
        tags.get("PixelSpacing", "PixelMeasuresSequence")
        or header.get("ImagerPixelSpacing", None)
        or header.get("NominalScannedPixelSpacing", None),
        2,
    )
    gap = _number(tags.get("SpacingBetweenSlices", "PixelMeasuresSequence"))
    gap = gap or _number(tags.get("SliceThickness", "PixelMeasuresSequence"))
    directions = axes or (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    normal = np.cross(directions[:3], directions[3:])
    placed = position is not None
    if pixels.pages > 1 and tags.own is None:
        along = _place_of_page(header, pixels, position, normal, gap or 1.0, page)
        position = _tuple(np.add(position or (0.0, 0.0, 0.0), along))
        # A camera may count against its normal.
        normal = -normal if gap < 0 else normal
    if spacing is None:
        remarks += ("The header has no size of a pixel; 1 mm is taken.",)
    if not gap and (position is None or (pixels.pages > 1 and not _has_offsets(header, tags))):
        remarks += ("The header has no distance of the slices; 1 mm is taken.",)
    slope, intercept = _scale(header, tags)
    location = header.get("SliceLocation", None)
    return Plane(
        pixels=pixels,
        page=page,
        uid=str(header.get("SOPInstanceUID", "")),
        order=_order(header, tags, page),
        label=_label(tags, labels),
        slope=slope,
        intercept=intercept,
        position=position,
        location=None if location is None else _number(location),
        axes=directions,
        normal=_tuple(normal),
        spacing=spacing or (1.0, 1.0),
        step=abs(gap),
        sparse=str(header.get("SOPClassUID", "")) in _SEGMENTATIONS,
        placed=placed,
        remarks=remarks,
    )


def _place_of_page(
    header: pydicom.Dataset,
    pixels: Pixels,
    position: Floats | None,
    normal: Array,
    gap: float,
    page: int,
) -> Array:
    """How far a page is from the position of its file, where pages have none of their own."""
    offsets = _floats(header.get("GridFrameOffsetVector", None))
    slices = _floats(header.get("SliceVector", None))
    for vector in (offsets, slices):
        if vector is not None and len(vector) != pixels.pages:
            raise LeaflightError(
                f"{pixels.file}: its header has places for {len(vector)} planes, but the file has "
                f"{pixels.pages}: it is damaged, fetch it again."
            )
    if offsets is not None:
        height = position[2] if position is not None else 0.0
        apart = abs(offsets[1] - offsets[0])
        # A dose either has distances from its position or heights in the patient.
        if abs(normal[2]) > _VERTICAL and 0 != offsets[0] and _near(offsets[0], height, apart):
            return np.array([0.0, 0.0, offsets[page] - offsets[0]])
        return normal * offsets[page]
    if slices is not None:
        return normal * gap * (slices[page] - 1)
    if header.get("FrameIncrementPointer", None) in _TIMES:
        return normal * 0
    return normal * gap * page


def _has_offsets(header: pydicom.Dataset, tags: _Tags) -> bool:
    """Whether the pages of a file have places of their own."""
    return tags.own is not None or "GridFrameOffsetVector" in header


def _near(one: float, other: float, apart: float) -> bool:
    return abs(one - other) <= _NEAR * apart


def _scale(header: pydicom.Dataset, tags: _Tags) -> tuple[float, float]:
    """The slope and the intercept that make values of what is stored."""
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


def _order(header: pydicom.Dataset, tags: _Tags, page: int) -> Floats:
    time = tags.get("TemporalPositionIndex", "FrameContentSequence")
    if time is None:
        time = header.get("TemporalPositionIdentifier", None)
    number = header.get("InstanceNumber", None)
    acquisition = header.get("AcquisitionNumber", None)
    moment = header.get("AcquisitionTime", None) or header.get("ContentTime", None)
    order = [_number(value) for value in (time, number, page, acquisition, moment)]
    return tuple(order)


def _labels(header: pydicom.Dataset) -> dict[int, str]:
    """{number of a segment: its label, which no other has}."""
    labels: dict[int, str] = {}
    for item in header.get("SegmentSequence", None) or []:
        number = int(item.SegmentNumber)
        label = str(item.get("SegmentLabel", None) or "").strip() or f"segment {number}"
        labels[number] = f"{label} ({number})" if label in labels.values() else label
    return labels


def _label(tags: _Tags, labels: dict[int, str]) -> str:
    number = tags.get("ReferencedSegmentNumber", "SegmentIdentificationSequence")
    if number is not None:
        return labels.get(int(number), f"segment {number}")
    stack = tags.get("StackID", "FrameContentSequence")
    return f"stack {stack}" if stack else ""


def _remarks(header: pydicom.Dataset) -> tuple[str, ...]:
    """Sentences about a file of which the values may not be what other programs show."""
    remarks = []
    interpretation = str(header.get("PhotometricInterpretation", ""))
    if interpretation == "MONOCHROME1":
        remarks.append(
            "The series is MONOCHROME1: other programs show its low values bright. The values are "
            "as stored."
        )
    if interpretation == "PALETTE COLOR":
        remarks.append("The values are numbers of a color table, as stored.")
    if header.get("ModalityLUTSequence", None):
        remarks.append(
            "The header has a table of values (Modality LUT), which is not applied; the values are "
            "as stored."
        )
    return tuple(remarks)


def _floats(numbers: Iterable[Any] | None, count: int = 0) -> Floats | None:
    """As many finite numbers as there must be, or None; any number of them where count is 0."""
    if numbers is None or isinstance(numbers, str) or not isinstance(numbers, Sequence):
        return None
    floats = tuple(_number(number, np.nan) for number in numbers)
    if not floats or (count and len(floats) != count) or not np.isfinite(floats).all():
        return None
    return floats


def _number(value: Any, otherwise: float = 0.0) -> float:
    """A finite number that a header has, or what to take where it has none."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return otherwise
    return number if np.isfinite(number) else otherwise


def _tuple(vector: Array) -> Floats:
    return tuple(float(number) for number in vector)
