# SPDX-License-Identifier: GPL-3.0-or-later
"""Sorts planes by their positions in the patient, as frames of one grid."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from ...._core import LeaflightError
from ....arrays import Array
from ....volume.axes import FROM_LPS
from ..checks import check_matrix
from .pixels import digest
from .planes import Plane

# Tolerance of even spacing, as a share of the distance of planes.
UNEVEN = 0.1
# Distance within which planes have the same position, as a share of their distance or of a pixel.
# Headers may round equal positions differently.
_SAME, _SAME_PIXEL = 0.01, 1e-4
# Upper bound on the distance of a plane from the line through the first and the last, in pixels.
_ASIDE = 1.0
# Upper bound on the planes that a sparse object omits, per plane that it has.
_MOST_EMPTY = 1000


@dataclass(frozen=True)
class Stack:
    """The planes of each frame, None for one that is all 0, and the position of the grid."""

    frames: list[list[Plane | None]]
    index_to_world: Array
    notes: tuple[str, ...] = ()


def stack_of(path: Path, planes: list[Plane]) -> Stack:
    """Returns the planes of each frame, from the first to the last along the patient.

    Raises LeaflightError if one is missing, or if they do not share a grid.
    """
    planes = sorted(planes, key=lambda one: one.order)
    if any(one.position is None for one in planes):
        return _unplaced(path, planes)
    places = _places(planes)
    places, copies = _without_copies(places)
    counts = {len(place) for place in places}
    if len(counts) > 1:
        raise LeaflightError(
            f"{path}: this series has {min(counts)} to {max(counts)} different slices at each "
            "position; remove those that do not belong to it."
        )
    _check_even(path, places)
    notes = [_copies_note(copies)] if copies else []
    if not planes[0].placed:
        notes.append("The header has no position of the slices in the patient.")
    frames: list[list[Plane | None]] = [
        [place[frame] for place in places] for frame in range(counts.pop())
    ]
    return Stack(frames, _matrix(path, places[0][0], places[-1][0], len(places)), tuple(notes))


def sparse_stack_of(path: Path, planes: list[Plane], segments: Sequence[str]) -> Stack:
    """Returns the planes of segments in the grid of all segments, a frame for each.

    Raises LeaflightError.
    """
    if any(one.position is None for one in planes):
        raise LeaflightError(f"{path}: the header has no positions of the segments; repair it.")
    places = _places(planes)
    indices = _indices(path, np.array([_along(place[0], planes[0]) for place in places]), planes[0])
    depth = int(indices[-1] + 1)
    frames: dict[str, list[Plane | None]] = {segment: [None] * depth for segment in segments}
    for index, place in zip(indices, places):
        for one in place:
            if one.label not in frames:
                continue
            other = frames[one.label][index]
            if other is not None and digest(one) != digest(other):
                raise LeaflightError(
                    f"{path}: the segment {one.label!r} has 2 different slices at one position; "
                    "choose a file with one of them."
                )
            frames[one.label][index] = other or one
    matrix = _matrix(path, places[0][0], places[-1][0], depth)
    return Stack(list(frames.values()), matrix)


def _indices(path: Path, along: Array, first: Plane) -> Array:
    """Returns the numbers of positions in the grid of a sparse object. Raises LeaflightError.

    The distance in the header is used, or else the smallest between neighbors.
    """
    gaps = np.diff(along)
    for step in (first.between, gaps.min(initial=np.inf)):
        counts = np.rint(gaps / step) if step else np.zeros(0)
        if len(counts) == len(gaps) and (counts > 0).all():
            apart = np.abs(gaps - counts * step).max(initial=0.0)
            if apart <= UNEVEN * step and counts.sum() <= _MOST_EMPTY * len(along):
                return np.append(0, np.cumsum(counts)).astype(np.int64)
    raise LeaflightError(
        f"{path}: the slices are {gaps.min():g} to {gaps.max():g} mm apart, which are not "
        "multiples of one distance; remove those that do not belong to it."
    )


def _unplaced(path: Path, planes: list[Plane]) -> Stack:
    """Returns planes without positions, sorted by locations if these differ, else by numbers."""
    locations = [one.location for one in planes if one.location is not None]
    if len(set(locations)) == len(planes):
        planes = sorted(planes, key=lambda one: one.location or 0.0)
        _check_distances(path, np.array(sorted(locations)))
        step = (max(locations) - min(locations)) / max(len(planes) - 1, 1)
        note = "The headers have distances of the slices, but no positions in the patient."
    else:
        step = planes[0].step or 1.0
        note = (
            f"The headers have no positions of the slices; they are sorted by number, {step:g} mm "
            "apart."
        )
    first = planes[0]
    matrix = _axes(first)
    matrix[:3, 2] = np.multiply(first.normal, step)
    matrix = FROM_LPS @ matrix
    check_matrix(path, matrix)
    return Stack([list(planes)], matrix, (note,))


def _along(one: Plane, first: Plane) -> float:
    return float(np.dot(one.position or (0.0, 0.0, 0.0), first.normal))


def _places(planes: Sequence[Plane]) -> list[list[Plane]]:
    """Returns the planes at each position, from the first to the last, each sorted by order."""
    if not planes:
        return []
    first = planes[0]
    ordered = sorted(planes, key=lambda one: _along(one, first))
    gaps = np.diff([_along(one, first) for one in ordered])
    distance = min(float(gaps.max(initial=0.0)), first.step or np.inf)
    same = max(_SAME * distance, _SAME_PIXEL * min(first.spacing))
    places = [[ordered[0]]]
    for one, gap in zip(ordered[1:], gaps):
        if gap > same:
            places.append([])
        places[-1].append(one)
    return [sorted(place, key=lambda one: one.order) for place in places]


def _without_copies(places: list[list[Plane]]) -> tuple[list[list[Plane]], int]:
    """Returns the positions without slices that were stored twice, and the number of these.

    A copy has the same pixels and position as another slice. Also its number or its identifier is
    equal, or this position has more slices than others.
    """
    fewest = min(len(place) for place in places)
    kept, copies = [], 0
    for place in places:
        identities = [_identities(one) for one in place]
        suspects = any(one & other for one, other in pairwise(identities))
        if len(place) == 1 or (len(place) == fewest and not suspects):
            kept.append(place)
            continue
        unique: list[Plane] = []
        known: dict[bytes, list[set[tuple[object, ...]]]] = {}
        left = len(place)
        for one, identity in zip(place, identities):
            alike = known.setdefault(digest(one), [])
            if any(identity & other for other in alike) or (alike and left > fewest):
                left -= 1
                continue
            alike.append(identity)
            unique.append(one)
        copies += len(place) - len(unique)
        kept.append(unique)
    return kept, copies


def _identities(one: Plane) -> set[tuple[object, ...]]:
    return {one.order, (one.uid, one.page)} if one.uid else {one.order}


def _copies_note(copies: int) -> str:
    if copies == 1:
        return "1 slice is stored twice with equal values; the copy is left out."
    return f"{copies} slices are stored twice with equal values; the copies are left out."


def _check_even(path: Path, places: list[list[Plane]]) -> None:
    """Raises LeaflightError unless the planes of each frame are on one line, evenly spaced."""
    first = places[0][0]
    positions = np.array([[one.position for one in place] for place in places])
    _check_distances(path, positions[:, 0] @ first.normal)
    line = np.linspace(positions[0, 0], positions[-1, 0], len(places))
    across = np.array(first.axes).reshape(2, 3).T
    aside = np.abs((positions - line[:, np.newaxis]) @ across).max()
    step = np.linalg.norm(line[-1] - line[0]) / max(len(line) - 1, 1)
    if aside > _ASIDE * max(first.spacing) + UNEVEN * step:
        raise LeaflightError(
            f"{path}: the slices are up to {aside:g} mm off a common line; remove those that do "
            "not belong to the series."
        )


def _check_distances(path: Path, along: Array) -> None:
    """Raises LeaflightError unless positions are evenly spaced, between neighbors or overall.

    Rounded positions are even only overall: 0.0625 mm in hundredths of a millimeter.
    """
    gaps = np.diff(along)
    if len(gaps) < 2:
        return
    even = np.linspace(along[0], along[-1], len(along))
    if (
        gaps.max() - gaps.min() > UNEVEN * np.median(gaps)
        and np.abs(along - even).max() > UNEVEN * gaps.mean()
    ):
        raise LeaflightError(
            f"{path}: the slices are {gaps.min():g} to {gaps.max():g} mm apart, so one may be "
            "missing; complete the series, or remove slices that do not belong to it."
        )


def _axes(first: Plane) -> Array:
    """Returns the matrix of a plane in LPS, without the direction between planes."""
    matrix = np.eye(4)
    matrix[:3, 0] = np.multiply(first.axes[:3], first.spacing[1])
    matrix[:3, 1] = np.multiply(first.axes[3:], first.spacing[0])
    if first.position is not None:
        matrix[:3, 3] = first.position
    return matrix


def _matrix(path: Path, first: Plane, last: Plane, count: int) -> Array:
    matrix = _axes(first)
    matrix[:3, 2] = np.multiply(first.normal, first.step or 1.0)
    if count > 1:
        # The direction between planes may be oblique if the gantry was tilted.
        matrix[:3, 2] = np.subtract(last.position or (), first.position or ()) / (count - 1)
    matrix = FROM_LPS @ matrix
    check_matrix(path, matrix)
    return matrix
