# SPDX-License-Identifier: GPL-3.0-or-later
"""DICOM series through pydicom: slices of a folder, sorted by their positions in the patient."""

from dataclasses import replace
from pathlib import Path


from ...._core import LeaflightError, Progress
from ....volume.label_table import Label
from ....volume.volume import Volume
from ..checks import choose_named
from ..sniffing import DIRECTORY
from ..stored import StoredVolume, lengths
from .parts import Part, choices_of, meant
from .series import find_series
from .stacks import Stack, sparse_stack_of, stack_of
from .values import label_map, value_type, values_of_frame

# Upper bound on different values of pixels without data. Slopes that vary by slice make many.
_MOST_PADDINGS = 4


def open_volume(path: Path, dataset: str | None = None) -> StoredVolume:
    """Opens the series of a folder or a disc, or the one that a file belongs to.

    dataset: Number, description and kind of a series, if there are several, and the label of a
        segment, a stack or a direction. One of these words is enough if it is unique. None is the
        label map of all segments.
    Values are computed from stored numbers as in the header: Hounsfield units of a CT, gray of a
        dose.
    """
    found, notes = find_series(path)
    choices, left_out = choices_of(path, found)
    names = tuple(choices)
    notes = (*notes, *left_out)
    facts = {"unit": "mm", "patient": True, "notes": notes}
    name = choose_named(path, names, meant(choices, dataset), **facts)
    return _opened(path, choices[name].part(path), names, notes)


def _opened(path: Path, part: Part, names: tuple[str, ...], notes: tuple[str, ...]) -> StoredVolume:
    stack = _stack(path, part)
    _check_depth(path, stack)
    first = part.planes[0]
    dtype = value_type(part.planes)
    paddings = {one.padding for one in part.planes if one.padding is not None}
    remarks = dict.fromkeys(remark for one in part.planes for remark in one.remarks)

    def load(frame: int, _channel: int, progress: Progress) -> Volume:
        shape = first.pixels.shape
        if part.is_map:
            values = label_map(stack.frames, shape, progress)
        else:
            values = values_of_frame(stack.frames[frame], shape, dtype, progress)
        return Volume(values, stack.index_to_world, _title(path), labels=_labels(part))

    return StoredVolume(
        dims=(*first.pixels.shape[::-1], len(stack.frames[0])),
        dtype=dtype,
        load=load,
        voxel_size=lengths(stack.index_to_world),
        unit="mm",
        frames=1 if part.is_map else len(stack.frames),
        datasets=names,
        patient=first.placed,
        missing=tuple(sorted(paddings)) if len(paddings) <= _MOST_PADDINGS else (),
        notes=(*notes, *part.notes, *stack.notes, *remarks),
    )


def _stack(path: Path, part: Part) -> Stack:
    """Returns the planes of a part in their order. Raises LeaflightError."""
    labels = [one.label for one in part.planes]
    try:
        if part.planes[0].sparse:
            return sparse_stack_of(path, part.within, list(dict.fromkeys(labels)))
        return stack_of(path, part.planes)
    except LeaflightError as problem:
        if not part.notes:
            raise
        # A missing plane may be one of those that were left out.
        sentence = str(problem).removesuffix(".")
        raise LeaflightError(f"{sentence} ({part.notes[0].removesuffix('.')}).") from None


def _labels(part: Part) -> tuple[Label, ...]:
    """Returns the labels of the values of a segmentation. A single segment has the label 1."""
    first = part.planes[0]
    if part.is_map or not first.segment:
        return first.labels
    names = [replace(label, number=1) for label in first.labels if label.number == first.segment]
    return tuple(names) if first.slope == 1 else ()


def _check_depth(path: Path, stack: Stack) -> None:
    """Raises LeaflightError unless there are several positions, as a volume needs."""
    if len(stack.frames[0]) > 1:
        return
    if len(stack.frames) > 1:
        raise LeaflightError(
            f"{path}: all {len(stack.frames)} slices of this series have the same position; "
            "choose another series."
        )
    raise LeaflightError(
        f"{path}: this series has only one slice here; open the folder with all of them, or "
        "choose another series."
    )


def _title(path: Path) -> str:
    if path.name.lower() == DIRECTORY:
        return path.absolute().parent.name
    return path.name if path.is_dir() else path.stem
