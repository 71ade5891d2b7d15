# SPDX-License-Identifier: GPL-3.0-or-later
"""TIFF stacks, and folders with one TIFF per slice, through tifffile."""

import io
import logging
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import prod
from pathlib import Path

import numpy as np
import tifffile

from ..._core import Cancelled, LeaflightError, Progress
from ...arrays import Array
from ...volume.units import unit_of
from ...volume.volume import Volume
from ...volume.voxels import new_voxels
from .checks import check_scalar, check_size, index_to_world, text, truncated
from .stored import StoredVolume, lengths
from .watched import open_watched, watched

# No compression of TIFF that is decoded here expands more: 12-bit LZW makes 4 KB of 12 bits.
LZW_MOST = 4096
MICROMETRES = {
    "nm": 1e-3,
    "µm": 1.0,
    "μm": 1.0,
    "um": 1.0,
    "mm": 1e3,
    "cm": 1e4,
    "m": 1e6,
    "Å": 1e-4,
}
if int(tifffile.__version__.partition(".")[0]) < 2025:
    # Older ones multiply sizes that a damaged file gives as bytes: these become gigabytes.
    tifffile.tifffile.product = lambda sizes: prod(int(size) for size in sizes)


def open_volume(path: Path, spacing: float | Sequence[float] | None = None) -> StoredVolume:
    """A stack or a folder of slices.

    The size of a voxel comes from spacing, else from ImageJ metadata (in their own unit) or OME
    metadata (in micrometres), else it is 1. A time or channel axis without a depth is the depth.
    """
    if path.is_dir():
        return _open_folder(path, spacing)
    return _open_stack(path, spacing)


def _open_stack(path: Path, spacing: float | Sequence[float] | None) -> StoredVolume:
    with opened(path) as file:
        series = file.series[0]
        _check_pages(path, file, series)
        axes = [(axis, n) for axis, n in zip(series.axes, series.shape) if n > 1]
        dtype, (found, unit) = series.dtype, _voxel_size(file)
    chosen = _choices(path, axes)
    frames, channels = (chosen[kind][1] if kind in chosen else 1 for kind in ("T", "C"))
    matrix = index_to_world(path, spacing if spacing is not None else found or 1.0)
    places = {place for place, _ in chosen.values()}
    dims = tuple(n for place, (_, n) in enumerate(axes) if place not in places)[::-1]

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        index: list[slice | int] = [slice(None)] * len(axes)
        for kind, (place, _) in chosen.items():
            index[place] = frame if kind == "T" else channel
        with open_watched(path, progress) as source, opened(path, source) as file:
            return Volume(_part(file, tuple(index)), matrix, path.stem)

    return StoredVolume(dims, dtype, load, lengths(matrix), unit, frames, channels)


def _choices(path: Path, axes: list[tuple[str, int]]) -> dict[str, tuple[int, int]]:
    """{"T" or "C": (place among the axes, how many)} of those axes that are not of space."""
    names = [axis for axis, _ in axes]
    shape = [n for _, n in axes]
    chosen = {}
    if len(axes) > 3:
        for kind in "TC":
            if kind in names:
                chosen[kind] = names.index(kind), shape[names.index(kind)]
        # Without such a name, frames are the first axis.
        if not chosen:
            chosen["T"] = 0, shape[0]
        # A time without a depth is one.
        if len(axes) - len(chosen) == 2:
            chosen.pop("T")
    if len(axes) - len(chosen) != 3:
        raise LeaflightError(
            f"{path}: the data are {text(shape)}, but a volume needs three dimensions, "
            "or four, of which one is the frame."
        )
    return chosen


def _part(file: tifffile.TiffFile, index: tuple[slice | int, ...]) -> Array:
    """What stands at an index of the axes that are longer than 1; other pages stay unread."""
    series = file.series[0]
    shape = tuple(n for n in series.shape if n > 1)
    planes = np.arange(prod(shape[:-2])).reshape(shape[:-2])[index[:-2]]
    one_by_one = series.dataoffset is None and len(series.pages) == prod(shape[:-2])
    if not one_by_one or planes.size == prod(shape[:-2]) or index[-2:] != (slice(None),) * 2:
        whole = new_voxels(series.shape, series.dtype)
        part: Array = file.asarray(series=0, out=whole).reshape(shape)[index]
        return part
    values: Array = file.asarray(key=planes.ravel().tolist(), series=0)
    return values.reshape(*planes.shape, *shape[-2:])


def _open_folder(path: Path, spacing: float | Sequence[float] | None) -> StoredVolume:
    slices = [p for p in path.iterdir() if p.suffix.lower() in (".tif", ".tiff") and p.is_file()]
    slices.sort(key=lambda p: [int(s) if s.isdigit() else s for s in re.split(r"(\d+)", p.name)])
    first = _slice(slices[0])
    matrix = index_to_world(path, spacing if spacing is not None else 1.0)

    def load(_frame: int, _channel: int, progress: Progress) -> Volume:
        values = new_voxels((len(slices), *first.shape), first.dtype)
        for k, slice_path in enumerate(watched(progress, slices)):
            image = _slice(slice_path)
            if image.shape != first.shape:
                raise LeaflightError(
                    f"{slice_path}: the slice is {text(image.shape)}, but every slice of the "
                    f"folder must be one plane of the same size, {text(first.shape)}."
                )
            if not np.can_cast(image.dtype, values.dtype):
                values = values.astype(np.promote_types(image.dtype, values.dtype))
            values[k] = image
        return Volume(values, matrix, path.stem)

    dims = (*first.shape[::-1], len(slices))
    return StoredVolume(dims, first.dtype, load, lengths(matrix))


def _slice(path: Path) -> Array:
    with opened(path) as file:
        series = file.series[0]
        _check_pages(path, file, series)
        image: Array = series.asarray().squeeze()
    if image.ndim != 2:
        raise LeaflightError(
            f"{path}: the slice is {text(image.shape)}, but every slice of the folder must be one "
            "plane of the same size."
        )
    return image


@contextmanager
def opened(path: Path, source: io.BufferedIOBase | None = None) -> Iterator[tifffile.TiffFile]:
    """The open TiffFile of a path, read through `source` where that is open already.

    Damage that tifffile raises or logs is a LeaflightError.
    """
    damage = LeaflightError(
        f"{path}: this is not a readable TIFF file, or it is truncated or damaged; fetch it again."
    )
    complaints = _Complaints()
    log = logging.getLogger("tifffile")
    log.addHandler(complaints)
    propagate, log.propagate = log.propagate, False
    try:
        with tifffile.TiffFile(source or path) as file:
            # Counting the pages finds a chain of them that leads back to itself; whoever takes
            # one after the other never comes to its end.
            if len(file.pages) == 0 or not file.series:
                raise damage
            yield file
            if complaints.damage:
                raise damage
    except LeaflightError:
        if complaints.damage:
            raise damage from None
        raise
    except (Cancelled, MemoryError, OSError):
        raise
    except Exception as error:
        # On damaged files tifffile fails with whatever comes first, from KeyError to a failed
        # assertion and the XML parser's own error.
        if "requires the 'imagecodecs'" in str(error):
            # LZW, JPEG and others that microscopes write.
            raise ModuleNotFoundError(name="imagecodecs") from None
        raise damage from None
    finally:
        log.propagate = propagate
        log.removeHandler(complaints)


class _Complaints(logging.Handler):
    """tifffile logs a broken chain of pages and goes on with the pages before the break."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.damage = False

    def emit(self, record: logging.LogRecord) -> None:
        message = record.getMessage()
        self.damage |= record.levelno >= logging.ERROR or "invalid page offset" in message


def _check_pages(path: Path, file: tifffile.TiffFile, series: tifffile.TiffPageSeries) -> None:
    if "S" in series.axes and series.shape[series.axes.index("S")] > 1:
        raise LeaflightError(
            f"{path}: the pages are color images, but a volume needs one number a voxel; "
            "convert them to grey values first."
        )
    check_scalar(path, series.dtype)
    plane = file.pages[0].shape
    images = (file.imagej_metadata or {}).get("images", 1)
    if images * prod(plane) > max(len(file.pages) * prod(plane), series.size):
        raise truncated(path, (images, *plane))
    size = file.filehandle.size
    if series.dataoffset is not None:
        # One contiguous block, which ImageJ writes under a single page.
        if series.dataoffset + series.nbytes > size:
            raise truncated(path, series.shape)
        return
    pages = [page.aspage() for page in series.pages if page is not None]
    parts = [part for page in pages for part in zip(page.dataoffsets, page.databytecounts)]
    if any(offset + count > size for offset, count in parts):
        raise truncated(path, series.shape)
    stored = sum(count for _, count in parts)
    check_size(path, series.shape, series.dtype.itemsize, stored, LZW_MOST)


def _voxel_size(file: tifffile.TiffFile) -> tuple[list[float] | None, str]:
    """((x, y, z) from ImageJ's or OME's metadata or None, the key of its unit in METERS)."""
    unit = ""
    if file.is_ome:
        try:
            images = tifffile.xml2dict(file.ome_metadata)["OME"]["Image"]
            pixels = (images[0] if isinstance(images, list) else images)["Pixels"]
            sizes = [
                pixels[f"PhysicalSize{axis}"]
                * MICROMETRES[pixels.get(f"PhysicalSize{axis}Unit", "µm")]
                for axis in "XYZ"
            ]
        except (KeyError, TypeError):
            return None, ""
        unit = "µm"
    elif file.is_imagej:
        tags = file.pages[0].tags
        try:
            resolutions = [tags[name].value for name in ("XResolution", "YResolution")]
            sizes = [below / above for above, below in resolutions]
            sizes.append(float(file.imagej_metadata["spacing"]))
        except (KeyError, TypeError, ValueError, ZeroDivisionError):
            return None, ""
        unit = unit_of(file.imagej_metadata.get("unit"))
    else:
        return None, ""
    return (sizes, unit) if all(0 < size < float("inf") for size in sizes) else (None, "")
