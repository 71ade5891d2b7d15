# SPDX-License-Identifier: GPL-3.0-or-later
"""DICOM series through pydicom: the slices of a folder, sorted by where they lie in the patient."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, SupportsFloat

import numpy as np
import pydicom

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from ...volume.voxels import new_voxels
from .checks import DEFLATE_MOST, check_size, choose_named, text, undecided
from .formats import is_dicom
from .stored import StoredVolume, lengths
from .watched import watched

# How far apart slices may be from evenly spaced, in parts of their distance.
UNEVEN = 0.1
# DICOM's world is left-posterior-superior, ours right-anterior-superior.
_FROM_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


@dataclass(frozen=True)
class _Slice:
    """One plane: page of a file, and where it lies."""

    file: Path
    page: int
    number: float
    shape: tuple[int, int]
    bits: tuple[int, bool]  # bits stored, whether signed
    slope: float
    intercept: float
    position: tuple[float, ...] | None
    axes: tuple[float, ...]  # directions of a row and of a column
    spacing: tuple[float, ...]  # between rows, between columns
    thickness: float


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """The series of a folder, or the one that a file belongs to.

    dataset: number and description of a series, where a folder holds several. Values are those that
    the header's rescale slope and intercept make of the stored ones: Hounsfield units of a CT.
    """
    series = _series(path)
    name = choose_named(path, tuple(series), dataset)
    if name is None:
        return StoredVolume(
            None,
            np.dtype(np.int16),
            undecided(path, tuple(series)),
            unit="mm",
            datasets=tuple(series),
        )
    if any("Rows" not in header for header in series[name]):
        raise LeaflightError(f"{path}: this DICOM file holds no pixels; choose another.")
    if any(header.get("SamplesPerPixel", 1) != 1 for header in series[name]):
        raise LeaflightError(
            f"{path}: its pixels are colors, but a volume needs one real number a voxel; choose "
            "another series."
        )
    slices = [one for header in series[name] for one in _slices(header)]
    stacks = _stacks(path, slices)
    first = stacks[0][0]
    matrix = _matrix(path, stacks[0])
    dtype = _value_type(slices)
    dims = (*first.shape[::-1], len(stacks[0]))

    def load(frame: int, _channel: int, progress: Progress) -> Volume:
        return Volume(_values(stacks[frame], dtype, progress), matrix, _title(path))

    return StoredVolume(
        dims=dims,
        dtype=dtype,
        load=load,
        voxel_size=lengths(matrix),
        unit="mm",
        frames=len(stacks),
        datasets=tuple(series),
        patient=first.position is not None,
    )


def _series(path: Path) -> dict[str, list[pydicom.Dataset]]:
    """{name of a series: headers of its files}; of the one that a file belongs to."""
    folder, own = (path, None) if path.is_dir() else (path.parent, _header(path))
    found = defaultdict(list)
    for file in sorted(folder.iterdir()):
        if not file.is_file() or not is_dicom(file):
            continue
        header = _header(file)
        if not {"Rows", "Columns"} <= set(header.dir()):
            continue
        if own is None and header.get("SamplesPerPixel", 1) != 1:
            continue
        if own is None or header.get("SeriesInstanceUID") == own.get("SeriesInstanceUID"):
            found[str(header.get("SeriesInstanceUID", ""))].append(header)
    # A file without DICOM's preamble.
    if own is not None and not found:
        found[""] = [own]
    named = {}
    for headers in found.values():
        number = headers[0].get("SeriesNumber")
        words = (
            str(headers[0].get("SeriesDescription") or ""),
            str(headers[0].get("Modality", "")),
        )
        name = " ".join(filter(None, ("" if number is None else str(number), *words)))
        while name in named:
            name += " again"
        named[name] = headers
    return named


def _header(file: Path) -> pydicom.Dataset:
    try:
        header = pydicom.dcmread(file, stop_before_pixels=True, force=True)
    except pydicom.errors.InvalidDicomError:
        raise LeaflightError(f"{file}: this is not a readable DICOM file; leave it out.") from None
    return header


def _slices(header: pydicom.Dataset) -> Iterator[_Slice]:
    """The planes of a file, of which an enhanced one has many."""
    pages = int(header.get("NumberOfFrames", None) or 1)
    of_pages = header.get("PerFrameFunctionalGroupsSequence", [])
    shared = header.get("SharedFunctionalGroupsSequence", [None])[0]
    gap = float(header.get("SpacingBetweenSlices", None) or header.get("SliceThickness", None) or 1)
    for page in range(pages):
        groups = [group for group in (of_pages[page] if of_pages else None, shared) if group]

        def tag(name: str, sequence: str, otherwise: object = None) -> Any:
            for group in groups:
                if sequence in group and name in group[sequence][0]:
                    return group[sequence][0][name].value
            return header.get(name, otherwise)

        axes = tag("ImageOrientationPatient", "PlaneOrientationSequence") or (1, 0, 0, 0, 1, 0)
        position = tag("ImagePositionPatient", "PlanePositionSequence")
        if pages > 1 and not of_pages:
            position = _place_of_dose(header, position, axes, page)
        spacing = tag("PixelSpacing", "PixelMeasuresSequence")
        yield _Slice(
            file=Path(header.filename),
            page=page if pages > 1 else -1,
            number=float(header.get("InstanceNumber", None) or 0) + page,
            shape=(int(header.Rows), int(header.Columns)),
            bits=(int(header.BitsStored), bool(header.get("PixelRepresentation", 0))),
            slope=float(tag("RescaleSlope", "PixelValueTransformationSequence", 1) or 1),
            intercept=float(tag("RescaleIntercept", "PixelValueTransformationSequence", 0) or 0),
            position=_floats(position) if position else None,
            axes=_floats(axes),
            spacing=_floats(spacing or header.get("ImagerPixelSpacing", None) or (1, 1)),
            thickness=gap,
        )


def _place_of_dose(
    header: pydicom.Dataset, position: Sequence[float] | None, axes: Sequence[float], page: int
) -> Sequence[float] | None:
    """The position of a page in a file that has distances of its pages, as doses do; else None."""
    offsets = header.get("GridFrameOffsetVector", None)
    if not offsets or not position:
        return None
    place: list[float] = np.add(
        position, np.cross(axes[:3], axes[3:]) * float(offsets[page])
    ).tolist()
    return place


def _stacks(path: Path, slices: list[_Slice]) -> list[list[_Slice]]:
    """The slices of each frame, from the first to the last along the patient. Raises."""
    if len({(one.shape, one.spacing) for one in slices}) > 1:
        shapes = sorted({text(one.shape) for one in slices})
        raise LeaflightError(
            f"{path}: the slices of this series differ in size ({', '.join(shapes)}); take out "
            "those that do not belong to it."
        )
    if any(one.position is None for one in slices):
        return [sorted(slices, key=lambda one: one.number)]
    if len({tuple(np.round(one.axes, 3)) for one in slices}) > 1:
        raise LeaflightError(
            f"{path}: the slices of this series lie at angles to each other; take out those that "
            "do not belong to it."
        )
    normal = np.cross(slices[0].axes[:3], slices[0].axes[3:])
    at_place = defaultdict(list)
    for one in sorted(slices, key=lambda one: one.number):
        assert one.position is not None
        at_place[round(float(np.dot(one.position, normal)), 2)].append(one)
    places = sorted(at_place)
    counts = {len(at_place[place]) for place in places}
    if len(counts) > 1:
        raise LeaflightError(
            f"{path}: some places in the patient have {min(counts)} slices of this series and "
            f"others {max(counts)}; take out those that do not belong to it."
        )
    gaps = np.diff(places)
    if len(gaps) > 1 and gaps.max() - gaps.min() > UNEVEN * np.median(gaps) + 0.02:
        raise LeaflightError(
            f"{path}: its slices are {gaps.min():g} to {gaps.max():g} mm apart, so that one may be "
            "missing; complete the series, or take out those that do not belong to it."
        )
    return [[at_place[place][frame] for place in places] for frame in range(counts.pop())]


def _matrix(path: Path, slices: list[_Slice]) -> Array:
    first, last = slices[0], slices[-1]
    matrix = np.eye(4)
    row, column = np.array(first.axes[:3]), np.array(first.axes[3:])
    matrix[:3, 0], matrix[:3, 1] = row * first.spacing[1], column * first.spacing[0]
    matrix[:3, 2] = np.cross(row, column) * first.thickness
    if first.position is not None:
        matrix[:3, 3] = first.position
        if len(slices) > 1 and last.position is not None:
            # Along a gantry that was tilted, too.
            matrix[:3, 2] = np.subtract(last.position, first.position) / (len(slices) - 1)
    if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix)) == 0:
        raise LeaflightError(f"{path}: the headers place the slices nowhere in space; repair them.")
    return _FROM_LPS @ matrix


def _value_type(slices: list[_Slice]) -> np.dtype[Any]:
    """The type of the rescaled values: the narrowest that holds what slices usually hold."""
    if any(one.slope != 1 or one.intercept != round(one.intercept) for one in slices):
        return np.dtype(np.float32)
    low = min(one.intercept - (1 << (one.bits[0] - 1)) * one.bits[1] for one in slices)
    high = max((1 << one.bits[0]) - 1 + one.intercept for one in slices)
    fits = (kind for kind in (np.uint8, np.uint16) if low >= 0 and high <= np.iinfo(kind).max)
    # Hounsfield units do, though 16 bits may be declared for them before 1024 is taken away.
    return np.dtype(next(fits, np.int16))


def _values(slices: list[_Slice], dtype: np.dtype[Any], progress: Progress) -> Array:
    values = new_voxels((len(slices), *slices[0].shape), dtype)
    file, pixels = Path(), np.empty(0)
    for k, one in enumerate(watched(progress, slices)):
        if one.file != file:
            file, pixels = one.file, _pixels(one)
        page: Array = pixels if one.page < 0 else pixels[one.page]
        rescaled: Array = page * one.slope + one.intercept
        if values.dtype.kind != "f":
            limits = np.iinfo(values.dtype)
            if rescaled.min() < limits.min or rescaled.max() > limits.max:
                values = values.astype(np.float32)
        values[k] = rescaled
    return values


def _pixels(one: _Slice) -> Array:
    data = pydicom.dcmread(one.file, force=True)
    if "PixelData" not in data:
        raise LeaflightError(f"{one.file}: the slice has no pixels; fetch it again.")
    if not hasattr(data.file_meta, "TransferSyntaxUID"):
        data.file_meta.TransferSyntaxUID = pydicom.uid.ImplicitVRLittleEndian
    compressed = data.file_meta.TransferSyntaxUID.is_compressed
    shape = (int(data.get("NumberOfFrames", None) or 1), *one.shape)
    most = DEFLATE_MOST if compressed else 1
    check_size(one.file, shape, int(data.BitsAllocated) // 8, len(data.PixelData), most)
    try:
        pixels: Array = data.pixel_array
    except (AttributeError, NotImplementedError, RuntimeError, ValueError) as error:
        if not compressed:
            raise
        raise LeaflightError(
            f"{one.file}: its compression ({data.file_meta.TransferSyntaxUID.name}) cannot be "
            "decoded here; save the series uncompressed, or install pylibjpeg with its plug-ins."
        ) from error
    return pixels


def _floats(numbers: Iterable[SupportsFloat]) -> tuple[float, ...]:
    return tuple(float(number) for number in numbers)


def _title(path: Path) -> str:
    return path.name if path.is_dir() else path.stem
