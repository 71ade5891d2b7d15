# SPDX-License-Identifier: GPL-3.0-or-later
"""DICOM series through pydicom: the slices of a folder, sorted by where they lie in the patient."""

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...._core import LeaflightError, Progress
from ....arrays import Array
from ....volume.volume import Volume
from ....volume.voxels import new_voxels
from ..checks import choose_named, undecided
from ..stored import StoredVolume, lengths
from ..watched import watched
from .choices import choices_of, meant
from .parts import Part
from .pixels import open_pages, values_of
from .planes import Plane
from .series import find_series
from .stacks import Stack, sparse_stack_of, stack_of

# Files that are open at once: times of a series may each be one, of which all have some planes.
_OPEN = 4


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """The series of a folder or a disc, or the one that a file belongs to.

    dataset: number, description and kind of a series, where there are several, and the label of
    a segment, a stack or a direction; one of these words alone where it means one volume.
    Values are those that the header makes of the stored ones: Hounsfield units of a CT, gray of a
    dose.
    """
    found, notes = find_series(path)
    choices, left_out = choices_of(path, found)
    names = tuple(choices)
    name = choose_named(path, names, meant(choices, dataset))
    notes = (*notes, *left_out)
    if name is not None:
        return _opened(path, [choices[name].part(path)], names, notes)
    if len(found) == 1 and all(choice.sparse for choice in choices.values()):
        # Segments lie in one grid: they are channels as well.
        return _opened(path, [choice.part(path) for choice in choices.values()], names, notes)
    load = undecided(path, names)
    return StoredVolume(
        None, np.dtype(np.int16), load, unit="mm", datasets=names, patient=True, notes=notes
    )


def _opened(
    path: Path, parts: list[Part], names: tuple[str, ...], notes: tuple[str, ...]
) -> StoredVolume:
    """The volume of one part, or of several that share a grid."""
    stacks = [_stack(path, part) for part in parts]
    stack = stacks[0]
    planes = [one for part in parts for one in part.planes]
    _check_depth(path, stack)
    dtype = _value_type(planes)
    remarks = dict.fromkeys(remark for one in planes for remark in one.remarks)

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        values = _values(stacks[channel].frames[frame], planes[0], dtype, progress)
        return Volume(values, stack.index_to_world, _title(path))

    return StoredVolume(
        dims=(*planes[0].pixels.shape[::-1], len(stack.frames[0])),
        dtype=dtype,
        load=load,
        voxel_size=lengths(stack.index_to_world),
        unit="mm",
        frames=len(stack.frames),
        channels=len(stacks),
        datasets=names,
        patient=planes[0].placed,
        notes=(*notes, *parts[0].notes, *stack.notes, *remarks),
    )


def _stack(path: Path, part: Part) -> Stack:
    """The planes of a part in their order. Raises LeaflightError."""
    try:
        if part.planes[0].sparse:
            return sparse_stack_of(path, part.within, part.label)
        return stack_of(path, part.planes)
    except LeaflightError as problem:
        if not part.notes:
            raise
        # The one that is missing may be among those that are left out.
        sentence = str(problem).removesuffix(".")
        raise LeaflightError(f"{sentence} ({part.notes[0].removesuffix('.')}).") from None


def _check_depth(path: Path, stack: Stack) -> None:
    """Raises LeaflightError unless there are several places, as a volume needs."""
    if len(stack.frames[0]) > 1:
        return
    if len(stack.frames) > 1:
        raise LeaflightError(
            f"{path}: all {len(stack.frames)} slices of this series lie at one place, but a volume "
            "needs several places; choose another series."
        )
    raise LeaflightError(
        f"{path}: this series has a single slice here, but a volume needs several; open the folder "
        "with all of them, or choose another series."
    )


def _value_type(planes: list[Plane]) -> np.dtype[Any]:
    """The type of the values: the narrowest that holds what slices usually hold."""
    pixels = {one.pixels for one in planes}
    if any(one.floats and one.allocated == 64 for one in pixels):
        return np.dtype(np.float64)
    if any(one.floats for one in pixels):
        return np.dtype(np.float32)
    if any(one.slope != 1 or one.intercept != round(one.intercept) for one in planes):
        return np.dtype(np.float32)
    low = min(one.intercept - (one.pixels.signed << (one.pixels.stored - 1)) for one in planes)
    high = max(one.intercept + (1 << one.pixels.stored) - 1 for one in planes)
    fits = (kind for kind in (np.uint8, np.uint16) if low >= 0 and high <= np.iinfo(kind).max)
    # Hounsfield units do, though 16 bits may be declared for them before 1024 is taken away.
    return np.dtype(next(fits, np.int16))


def _values(
    planes: list[Plane | None], first: Plane, dtype: np.dtype[Any], progress: Progress
) -> Array:
    """The values of a frame, 0 where a plane is not stored."""
    values = new_voxels((len(planes), *first.pixels.shape), dtype)
    opened = lru_cache(maxsize=_OPEN)(open_pages)
    for k, one in enumerate(watched(progress, planes)):
        if one is None:
            values[k] = 0
            continue
        page = values_of(one, opened(one.pixels))
        if values.dtype.kind != "f" and not _fits(page, values.dtype):
            values = _widened(values, k, page)
        values[k] = page
    return values


def _fits(page: Array, dtype: np.dtype[Any]) -> bool:
    limits = np.iinfo(dtype)
    return bool(limits.min <= page.min() and page.max() <= limits.max)


def _widened(values: Array, count: int, page: Array) -> Array:
    """An array that holds another page as well, with the first `count` planes of values."""
    # 24 bits are exact in single precision.
    whole = np.int32 if _fits(page, np.dtype(np.int32)) else np.float64
    kind = np.float32 if np.abs(page.astype(np.float64)).max() < 1 << 24 else whole
    wide = new_voxels(values.shape, kind)
    wide[:count] = values[:count]
    return wide


def _title(path: Path) -> str:
    return path.name if path.is_dir() else path.stem
