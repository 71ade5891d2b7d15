# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions: cuts, removed parts and masks that change a volume before it is baked, in their order.

Positions are in the world coordinates of the volume, and isovalues in data units. A record is a
region as JSON holds it: {"kind": "part", "point": [0, 0, 0], "isovalue": 300}.
"""

import dataclasses
import inspect
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field, replace
from os import PathLike
from typing import Any

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from . import cuts, parts
from .cuts import Ball, Box, Cuts, HalfSpace, Point
from .first_isovalue import default_isovalue
from .masks import masked
from .volume import Volume


@dataclass(frozen=True)
class LargestPart:
    """Keeps the part with most voxels. isovalue: None is default_isovalue() of the volume."""

    isovalue: float | None = None


@dataclass(frozen=True)
class Part:
    """Removes the part next to a point, or keeps it alone. keep: "inside" or "outside"."""

    point: Point
    isovalue: float | None = None
    keep: str = "outside"


@dataclass(frozen=True)
class Dust:
    """Removes parts with fewer voxels than this."""

    voxels: int
    isovalue: float | None = None


@dataclass(frozen=True)
class Apart:
    """Moves the parts apart, by whole voxels; what is beside them goes.

    along: Direction and distance (x, y, z) by which the middles of the outermost parts move apart.
    """

    along: Point
    isovalue: float | None = None


@dataclass(frozen=True)
class WithinLabels:
    """Keeps what is within labels (masks.py).

    label_map: Volume of labels. As the path of its file, only readers take it.
    labels: Numbers of labels; none are all above 0.
    reading: Options of read_volume() for the file.
    """

    label_map: Volume | str
    labels: tuple[int, ...] = ()
    reading: dict[str, Any] = field(default_factory=dict)


Region = Box | Ball | HalfSpace | LargestPart | Part | Dust | Apart | WithinLabels
KINDS: dict[str, Callable[..., Region]] = {
    "box": Box,
    "ball": Ball,
    "half_space": HalfSpace,
    "largest_part": LargestPart,
    "part": Part,
    "dust": Dust,
    "apart": Apart,
    "within_labels": WithinLabels,
}
# Longest distance between parts that move apart, in sizes of the volume.
MOST_APART = 4
_CHOICES = {"keep": ("inside", "outside"), "cut": ("capped", "open")}
_SHAPES = {"matrix": (4, 4), "point": (3,), "normal": (3,), "along": (3,)}


def changed(
    volume: Volume, regions: Iterable[Region], progress: _core.Progress | None = None
) -> Volume:
    """Returns a volume that the regions have changed in their order.

    Raises LeaflightError if nothing is left, and Cancelled.
    """
    regions, progress = tuple(regions), progress or _core.Progress()
    has_cut = False
    for region in regions:
        check(region)
        progress.check()
        if isinstance(region, (LargestPart, Part, Dust)):
            volume = replace(volume, values=_without_parts(volume, region, progress))
        elif isinstance(region, Apart):
            volume = _apart(volume, region, progress)
        elif isinstance(region, WithinLabels):
            if not isinstance(region.label_map, Volume):
                raise LeaflightError(f"{region.label_map}: read the label map first.")
            volume = masked(volume, region.label_map, region.labels, progress)
        else:
            volume, has_cut = _cut(volume, region, progress), True
    if has_cut:
        values, first = cuts.trimmed(volume.values, volume.data_range()[0])
        volume = volume.cropped(values, first)
    return replace(volume, source=volume.source + titles(regions))


def _cut(volume: Volume, region: cuts.Cut, progress: _core.Progress) -> Volume:
    cut = region.moved(np.linalg.inv(volume.index_to_world))
    crop = cuts.crop_of(cut)
    if crop is not None:
        values = volume.values[crop]
        _check_left(volume, region, values.size > 0)
        first = tuple(int(planes.start) for planes in crop[::-1])
        return volume.cropped(values, first)
    found = volume.cuts or Cuts(*volume.data_range(), ())
    values = cuts.cut_values(volume.values, cut, (found.low, found.high), progress.check)
    _check_left(volume, region, any((plane > found.low).any() for plane in values))
    if region.cut == "open":
        return replace(volume, values=values)
    return replace(volume, values=values, cuts=replace(found, cuts=(*found.cuts, cut)))


def _check_left(volume: Volume, region: Region, is_left: bool) -> None:
    """Raises LeaflightError if a cut has left nothing."""
    if not is_left:
        raise LeaflightError(
            f"{volume.source or volume.name}: the {title(region)} leaves nothing of the volume: "
            "move it, or keep its other side."
        )


def without_cuts(regions: Iterable[Any] | None) -> tuple[Region, ...]:
    """Returns regions or records as regions, without their cuts."""
    return tuple(one for one in as_regions(regions) if not isinstance(one, cuts.Cut))


def capped_cuts(volume: Volume, regions: Iterable[Any] | None) -> Cuts | None:
    """Returns the capped cuts of regions in index coordinates of an uncut volume, or None."""
    to_index = np.linalg.inv(volume.index_to_world)
    capped = tuple(
        one.moved(to_index)
        for one in as_regions(regions)
        if isinstance(one, cuts.Cut) and one.cut == "capped"
    )
    found = Cuts(*volume.data_range(), capped)
    return found if found.cuts else None


def _without_parts(
    volume: Volume, region: LargestPart | Part | Dust, progress: _core.Progress
) -> Array:
    isovalue = default_isovalue(volume) if region.isovalue is None else region.isovalue
    numbers, sizes = parts.parts_of(volume.values, isovalue, progress)
    if isinstance(region, Dust):
        large = int(np.count_nonzero(sizes >= region.voxels))
        goes = numbers > large
    elif isinstance(region, LargestPart):
        goes = numbers > 1
    else:
        chosen = numbers == _part_at(volume, region, isovalue, numbers)
        goes = ~chosen & (numbers > 0) if region.keep == "inside" else chosen
    return parts.without(volume.values, goes, (numbers > 0) & ~goes, progress.check)


def _apart(volume: Volume, region: Apart, progress: _core.Progress) -> Volume:
    if volume.cuts is not None:
        raise LeaflightError(
            f"{volume.source or volume.name}: its parts cannot move apart after a capped cut: move "
            "them first."
        )
    isovalue = default_isovalue(volume) if region.isovalue is None else region.isovalue
    numbers, _ = parts.parts_of(volume.values, isovalue, progress)
    along = (np.linalg.inv(volume.index_to_world)[:3, :3] @ region.along)[::-1]
    toward = (volume.index_to_world[:3, :3].T @ region.along)[::-1]
    if (abs(along) > MOST_APART * np.asarray(volume.values.shape)).any():
        raise LeaflightError(
            f"{volume.source or volume.name}: its parts would move apart by more than "
            f"{MOST_APART} times its size: give a shorter distance."
        )
    offsets = parts.offsets_apart(numbers, along, toward)
    values, first = parts.apart(volume.values, numbers, offsets, progress.check)
    return volume.cropped(values, first)


def _part_at(volume: Volume, region: Part, isovalue: float, numbers: Array) -> int:
    world_to_index = np.linalg.inv(volume.index_to_world)
    part = parts.part_at(numbers, world_to_index[:3, :3] @ region.point + world_to_index[:3, 3])
    if part == 0:
        place = ", ".join(f"{x:g}" for x in region.point)
        raise LeaflightError(
            f"There is nothing at or above the isovalue {isovalue:g} at ({place}): give a point of "
            "the part."
        )
    return part


def title(region: Region) -> str:
    return _kind(region).replace("_", " ")


def titles(regions: Iterable[Region]) -> str:
    """Returns the end of the source of a volume that regions have changed."""
    return "".join(f", {title(region)}" for region in regions)


def _kind(region: Region) -> str:
    return next(name for name, kind in KINDS.items() if type(region) is kind)


def check(region: Region) -> None:
    """Raises LeaflightError for numbers or words that a region cannot have."""
    if isinstance(region, WithinLabels):
        is_text = isinstance(region.labels, (str, dict))
        labels = region.labels if isinstance(region.labels, Collection) and not is_text else (None,)
        if not all(isinstance(label, int) and label > 0 for label in labels):
            raise LeaflightError(f"The labels {region.labels!r} are no whole numbers above 0.")
        is_map = isinstance(region.label_map, (Volume, str, PathLike))
        if not is_map or not isinstance(region.reading, dict):
            raise LeaflightError(
                f"The label map {region.label_map!r} is no path, or its reading is no object of "
                "options: repair them."
            )
        return
    for name, value in dataclasses.asdict(region).items():
        if name in _CHOICES:
            if value not in _CHOICES[name]:
                raise LeaflightError(
                    f"The {title(region)}'s {name} is {value!r}: choose "
                    f"{' or '.join(_CHOICES[name])}."
                )
        elif value is not None:
            _check_numbers(region, name, value)


def _check_numbers(region: Region, name: str, value: Any) -> None:
    shape = _SHAPES.get(name, ())
    try:
        numbers = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        numbers = np.full(1, np.nan)
    if numbers.shape != shape or not np.isfinite(numbers).all():
        count = int(np.prod(shape))
        what = "a number" if count == 1 else f"{count} numbers"
        raise LeaflightError(f"The {title(region)}'s {name} is {value!r}: give {what}.")
    is_flat = name == "matrix" and abs(np.linalg.det(numbers[:3, :3])) < 1e-30
    is_zero = name in ("normal", "along") and not numbers.any()
    if is_flat or is_zero or (name == "voxels" and numbers <= 0):
        raise LeaflightError(f"The {title(region)} is empty: its {name} must not be 0.")


def region_of(record: Any) -> Region:
    """Returns the Region of a record. Raises LeaflightError."""
    if not isinstance(record, dict) or record.get("kind") not in KINDS:
        raise LeaflightError(
            f"{record!r} is no region: give one with a kind of {', '.join(KINDS)}."
        )
    fields = {name: frozen(value) for name, value in record.items() if name != "kind"}
    kind = KINDS[record["kind"]]
    try:
        region = kind(**fields)
    except TypeError:
        known = ", ".join(inspect.signature(kind).parameters)
        raise LeaflightError(
            f"The region {record!r} is incomplete or has another field: give {known}."
        ) from None
    check(region)
    return region


def record_of(region: Region) -> dict[str, Any]:
    """Returns the record of a region."""
    return {"kind": _kind(region), **dataclasses.asdict(region)}


def as_regions(regions: Iterable[Any] | None) -> tuple[Region, ...]:
    """Returns regions for regions, records or a mix of both. Raises LeaflightError."""
    several = regions if isinstance(regions, Iterable) else [regions] if regions else ()
    return tuple(one if isinstance(one, Region) else region_of(one) for one in several)


def cuts_to_record(found: Cuts | None) -> dict[str, Any] | None:
    """Returns the cuts of a volume as JSON holds them, or None."""
    if found is None:
        return None
    return {"low": found.low, "high": found.high, "cuts": tuple(map(record_of, found.cuts))}


def cuts_from_record(record: dict[str, Any] | None) -> Cuts | None:
    """Returns the cuts of a record of cuts_to_record(). Raises LeaflightError, KeyError."""
    if record is None:
        return None
    found: Any = as_regions(record["cuts"])
    return Cuts(record["low"], record["high"], found)


def sphere(center: Point, radius: float, keep: str = "outside", cut: str = "capped") -> Ball:
    """Returns the Ball with a center and a radius."""
    matrix = np.diag([radius, radius, radius, 1.0])
    matrix[:3, 3] = center
    return Ball(frozen(matrix.tolist()), keep, cut)


def frozen(value: Any) -> Any:
    """Returns the value with tuples in place of lists, at any depth."""
    if isinstance(value, dict):
        return {key: frozen(each) for key, each in value.items()}
    return tuple(map(frozen, value)) if isinstance(value, (list, tuple)) else value
