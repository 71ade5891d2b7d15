# SPDX-License-Identifier: GPL-3.0-or-later
"""Entry point of all readers: read_volume() and probe()."""

import warnings
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypedDict

import numpy as np

from ..._core import Cancelled, LeaflightError, Progress, machine_memory
from ...arrays import Array
from ...paths import AnyPath
from ...progress_bar import with_progress
from ...volume.label_field import label_field, unsigned
from ...volume.label_table import without_labels
from ...volume.memory import as_voxels, held_type, is_limited, new_voxels
from ...volume.regions import Region, WithinLabels, as_regions, changed
from ...volume.setting_error import SettingError
from ...volume.smoothing import checked, smoothed, source_of
from ...volume.volume import Volume
from ..reader_process import kept_processes
from .channels import Chosen, chosen_channels
from .checks import Undecided, choose, text, truncated
from .formats import RAW, Format, format_of, left_out
from .label_files import labels_for
from .missing_package import MissingPackage
from .option_types import check_types
from .stored import StoredVolume
from .usable import Usable, about_labels, downsampled, look_like_labels, usable
from .watched import watched

if TYPE_CHECKING:
    from typing_extensions import Unpack

DOWNSAMPLE = (1, 2, 4, 8)
# Names of fields, and functions that make them of values and a Progress.
FIELDS: dict[str, Callable[[Array, Progress], Array]] = {
    "absolute": lambda values, _progress: unsigned(values),
    "labels": label_field,
}


class StoredOptions(TypedDict, total=False):
    """The options for data that a file format does not store; read_volume() explains them."""

    dims: Sequence[int] | None
    type: str | None
    endian: str | None
    spacing: float | Sequence[float] | None
    grid: str | None
    level: int | None
    dataset: str | None
    skip: int | None


class ValueOptions(TypedDict, total=False):
    """The options that change the values; read_volume() explains them."""

    downsample: int | None
    smooth: float | None
    smooth_normals: float | None
    field: str | None
    hide: Sequence[int] | None
    label_table: AnyPath | None
    regions: Sequence[Any] | None


class ReadOptions(StoredOptions, ValueOptions, total=False):
    """The options of read_volume() that are given by name."""


# Options of read_volume() in addition to the path.
OPTIONS = (
    *StoredOptions.__annotations__,
    "frame",
    "channel",
    *ValueOptions.__annotations__,
)


@with_progress("read")
def read_volume(
    path: AnyPath,
    *,
    frame: int | None = None,
    channel: Chosen = None,
    progress: Progress | None = None,
    **options: "Unpack[ReadOptions]",
) -> Volume:
    """Reads a scalar volume from a file of one of SUFFIXES or from a folder of slices.

    options: ReadOptions by name, as follows. Some are for facts that a format does not store.
    dims: Size of a .raw, (nx, ny, nz). For scattered points the nodes along x, y and z, or one
        number along the longest side.
    type: Type of the values in a .raw: "uint8", "float32", ... With dims and type any file is read
        as a .raw.
    endian: Byte order of the values in a .raw, "little" or "big".
    skip: Bytes of a .raw before its values. -1 means that the values are the end of the file.
    spacing: Voxel size, one number or (x, y, z), for files that often lack it.
    grid: Name of the grid in a .vdb. None is the first scalar one.
    frame, channel: Numbers of the frame and the channel, from 0. Files with several need a choice.
        A channel may also be its name. Several give the greatest of their values at each voxel.
    level: Resolution of a file that holds several. 0 is the finest and the default.
    dataset: Name of the array or series, if a file or folder holds several.
    downsample: Number of voxels along each axis that are averaged: 1 (default), 2, 4 or 8. A block
        of labels gives one of them.
    smooth: Standard deviation of a Gaussian on the values, in voxels after downsampling. 0 is the
        default.
    smooth_normals: The same for the normals alone (see Volume).
    field: "absolute" takes the values without their sign, for orbitals and other values around 0.
        "labels" takes the field whose isosurface at 0.5 is the boundary of labels (label_field.py).
    hide: Numbers of labels that are read as 0.
    label_table: File with names and colors of labels (label_files.py). None takes those of the
        volume's file, or the table of that name beside it.
    regions: Cuts, removed parts and masks (volume/regions.py), regions or records. They come last.
    progress: As for bake().
    Returns a Volume. Raises Cancelled, and LeaflightError: one sentence with the file and the
    remedy.
    """
    assert progress is not None
    _check_names(options, OPTIONS)
    check_types(path, {**options, "frame": frame, "channel": channel})
    path = Path(path)
    wanted = _wanted(path, options)
    regions = with_label_maps(wanted.regions, progress)
    stored: Any = {k: v for k, v in options.items() if k in StoredOptions.__annotations__}
    with _sentences(path, stored) as kind:
        opened = _opened(path, kind(), stored)
        # Earlier versions read channels by `frame`, if the file had no frames.
        if channel is None and opened.frames == 1 and opened.channels > 1:
            frame, channel = None, frame
        frame = choose(path, "frame", frame, opened.frames)
        channels = chosen_channels(path, channel, opened.channels, opened.channel_list)
        _check_memory(path, opened, wanted.step)
        volume = _loaded(path, opened, frame, channels, progress)
        volume = changed(_processed(path, opened, volume, wanted, progress), regions, progress)
    progress.begin("Examining values")
    progress.check()
    volume.field()
    if wanted.smooth > 0 or wanted.step > 1 or wanted.field or wanted.regions:
        return volume
    return volume.noted(*about_labels(volume))


def with_label_maps(regions: Sequence[Region], progress: Progress) -> tuple[Region, ...]:
    """Returns regions whose label maps are read. Raises as read_volume()."""
    found = []
    for region in regions:
        if isinstance(region, WithinLabels) and not isinstance(region.label_map, Volume):
            label_map = read_volume(region.label_map, progress=progress, **region.reading)
            region = replace(region, label_map=label_map)
        found.append(region)
    return tuple(found)


def _loaded(
    path: Path, opened: StoredVolume, frame: int, channels: Sequence[int], progress: Progress
) -> Volume:
    """Returns the volume of a channel, with its name, or of the greatest values of several.

    Raises LeaflightError, also for values that end early or cannot be decoded.
    """

    def load(channel: int) -> Volume:
        try:
            return opened.load(frame, channel, progress)
        except (EOFError, ValueError, zlib.error):
            if opened.dims is None:
                raise
            raise truncated(path, opened.dims) from None

    first, *others = channels
    volume = load(first)
    name = opened.channel(first).name
    if not others:
        is_named = name and opened.channels > 1
        return replace(volume, name=f"{volume.name} {name}") if is_named else volume
    values = new_voxels(volume.values.shape, volume.values.dtype)
    for plane, stored in zip(values, volume.values):
        plane[...] = stored
    for other in others:
        for plane, stored in zip(values, load(other).values):
            np.maximum(plane, stored, out=plane)
    return replace(volume, values=values)


@dataclass(frozen=True)
class _Wanted:
    """ValueOptions with their defaults. step: voxels along each axis that are averaged."""

    step: int
    smooth: float
    smooth_normals: float
    field: str | None
    hide: Sequence[int]
    label_table: AnyPath | None
    regions: tuple[Region, ...]


def _wanted(path: Path, options: ReadOptions) -> _Wanted:
    """Raises SettingError for values of options that do not exist."""
    downsample = options.get("downsample")
    if downsample is not None and downsample not in DOWNSAMPLE:
        raise SettingError(
            f"{path}: downsample is {downsample}; choose one of {', '.join(map(str, DOWNSAMPLE))}.",
            "downsample",
        )
    field = options.get("field")
    if field not in (None, *FIELDS):
        raise SettingError(
            f"{path}: the field is {field}; choose one of {', '.join(FIELDS)}.", "field"
        )
    return _Wanted(
        downsample or 1,
        checked(options.get("smooth") or 0.0, "smooth", path),
        checked(options.get("smooth_normals") or 0.0, "smooth_normals", path),
        field,
        options.get("hide") or (),
        options.get("label_table"),
        as_regions(options.get("regions")),
    )


def _processed(
    path: Path, opened: StoredVolume, volume: Volume, wanted: _Wanted, progress: Progress
) -> Volume:
    """Returns a loaded volume with the values that are wanted. Raises LeaflightError, Cancelled."""
    step, smooth = wanted.step, wanted.smooth
    values, offset, notes = usable(volume.values, opened.missing, step, progress)
    matrix = volume.index_to_world
    if step > 1:
        named = wanted.field == "labels" or wanted.hide or wanted.label_table or volume.labels
        taken = step // 2 if named or look_like_labels(values) else None
        values = downsampled(path, values, step, progress, taken)
        matrix = matrix @ _from_downsampled(step, 0.5 * (step - 1) if taken is None else taken)
    if wanted.hide:
        values = without_labels(_held(values, progress), wanted.hide)
        if not values.any():
            raise LeaflightError(f"{path}: all labels are hidden; show one of them.")
    values = smoothed(values, smooth, progress) if smooth > 0 else _held(values, progress)
    # Smooth labels are no labels.
    labels = volume.labels if smooth == 0 else ()
    if wanted.label_table is not None or not labels:
        labels, remarks = labels_for(path, values, wanted.label_table)
        notes += remarks
    if wanted.field is not None:
        values, labels = FIELDS[wanted.field](values, progress), ()
    return replace(
        volume,
        values=values,
        index_to_world=matrix,
        name=f"{volume.name} less {offset:.15g}" if offset else volume.name,
        source=source_of(path, smooth, wanted.smooth_normals, offset),
        unit=opened.unit,
        patient=opened.patient,
        smooth_normals=wanted.smooth_normals,
        notes=(*opened.notes, *volume.notes, *notes),
        labels=labels,
    )


def probe(path: AnyPath, **stored: "Unpack[StoredOptions]") -> StoredVolume:
    """Returns a StoredVolume, the facts of a file, without reading its voxels.

    stored: As for read_volume(). Without a choice that is needed, the result has dims None and the
        list to choose from.
    Raises LeaflightError.
    """
    _check_names(stored, tuple(StoredOptions.__annotations__))
    check_types(path, stored)
    path = Path(path)
    with _sentences(path, stored) as kind:
        return _opened(path, kind(), stored)


def _check_names(options: StoredOptions | ReadOptions, known: tuple[str, ...]) -> None:
    """Raises TypeError for an option of no format, as Python does for a wrong keyword."""
    for name in options:
        if name not in known:
            raise TypeError(
                f"read_volume() has no option {name!r}; choose one of {', '.join(OPTIONS)}."
            )


def _opened(path: Path, kind: Format, stored: StoredOptions) -> StoredVolume:
    options: dict[str, Any] = {name: value for name, value in stored.items() if value is not None}
    for name in options:
        if name not in kind.options:
            raise SettingError(
                f"{path}: the option {name} does not apply to this kind of file; leave it out.",
                name,
            )
    reader = import_module(f".{kind.module}", __package__)
    try:
        opened: StoredVolume = reader.open_volume(path, **options)
    except Undecided as error:
        opened = StoredVolume(None, np.dtype(np.float32), partial(_refused, error), **error.facts)
    notes = left_out(path, kind) if path.is_dir() else ()
    return replace(opened, notes=(*opened.notes, *notes)) if notes else opened


def _refused(error: Undecided, *_: object) -> NoReturn:
    raise error


@contextmanager
def _sentences(path: Path, stored: StoredOptions) -> Iterator[Callable[[], Format]]:
    """Converts any exception of reading a file to one sentence.

    Yields a function that sets the Format for the sentence.
    """
    kinds: list[Format] = []

    def kind() -> Format:
        if not path.exists():
            raise LeaflightError(f"{path}: there is no such file or folder; check the path.")
        without_header = stored.get("dims") is not None and stored.get("type") is not None
        kinds.append(RAW if without_header and path.is_file() else format_of(path))
        return kinds[0]

    try:
        # Ignore warnings of libraries: they are harmless, or an error follows.
        with warnings.catch_warnings(), kept_processes():
            warnings.simplefilter("ignore")
            yield kind
    except (Cancelled, SettingError):
        raise
    except LeaflightError as error:
        # The error may name another file, such as the data of a header.
        if str(path) in str(error):
            raise
        raise LeaflightError(f"{path}: {error}") from None
    except ImportError as error:
        package = (error.name or str(error)).partition(".")[0]
        raise MissingPackage(path, kinds[0].name, package) from None
    except OSError as error:
        raise LeaflightError(f"{path}: cannot read it: {error.strerror or 'damaged'}.") from None
    except MemoryError:
        raise LeaflightError(
            f"{path}: the volume does not fit into memory; downsample it, or use a smaller one."
        ) from None
    except Exception as error:
        # On damaged files libraries raise many types of exceptions.
        name = kinds[0].name if kinds else "file"
        raise LeaflightError(
            f"{path}: this is not a readable {name}, or it is truncated or damaged; fetch it again."
        ) from error


def _check_memory(path: Path, stored: StoredVolume, step: int) -> None:
    """Raises SettingError if the volume cannot fit into memory.

    It runs before memory is allocated, because a header may claim any size.
    """
    needed, here = stored.bytes(step), machine_memory()
    # With limited memory the voxels are stored in a file.
    if needed is None or stored.dims is None:
        return
    if 0 < here < needed and not is_limited():
        raise SettingError(
            f"{path}: the {text(stored.dims)} voxels need {needed / 1e9:.1f} GB of memory, but "
            f"{here / 1e9:.1f} GB are available; downsample the volume, or limit the memory, so "
            "that it is stored on disk.",
            "downsample",
        )


def _held(values: Array | Usable, progress: Progress) -> Array:
    """Returns a copy of the voxels in memory, because a mapped file might change."""
    stored = values.stored if isinstance(values, Usable) else values
    kept, mapped = held_type(values.dtype), isinstance(stored, np.memmap)
    is_owned = isinstance(stored, np.ndarray) and not mapped and stored.flags.c_contiguous
    is_owned = is_owned and stored.dtype == kept and (values is stored or stored.flags.writeable)
    held = stored if is_owned else new_voxels(values.shape, kept)
    if held is not values:
        for k in watched(progress, range(len(values))):
            held[k] = as_voxels(values[k])
    return held


def _from_downsampled(step: int, first: float) -> Array:
    matrix = np.diag([float(step)] * 3 + [1.0])
    matrix[:3, 3] = first
    return matrix
