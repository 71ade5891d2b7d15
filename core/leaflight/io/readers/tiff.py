# SPDX-License-Identifier: GPL-3.0-or-later
"""TIFF stacks, and folders with one TIFF per slice, through tifffile."""

import logging
import re
from contextlib import contextmanager
from math import prod

import numpy as np
import tifffile

from ..._core import LeaflightError
from ...volume.volume import Volume
from .checks import (
    check_scalar,
    check_size,
    choose_frame,
    index_to_world,
    no_frame,
    text,
    to_float32,
    truncated,
)

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


def read(path, frame=None, spacing=None):
    """Reads a stack or a folder of slices.

    The size of a voxel comes from spacing, else from ImageJ metadata (in their own unit) or OME
    metadata (in micrometres), else it is 1. A time or channel axis without a depth is the depth.
    """
    if path.is_dir():
        values, found = _read_folder(path, frame), None
    else:
        values, found = _read_stack(path, frame)
    matrix = index_to_world(path, spacing if spacing is not None else found or 1.0)
    return Volume(values, matrix, path.stem, str(path))


def _read_stack(path, frame):
    with opened(path) as file:
        series = file.series[0]
        shape, axes = series.shape, series.axes
        _check_pages(path, file, series)
        kept = [i for i, n in enumerate(shape) if n > 1]
        shape, axes = [shape[i] for i in kept], "".join(axes[i] for i in kept)
        if len(shape) == 4:
            # Channels and time may be at any place; without such a name, frames are the first axis.
            at = next((i for i, axis in enumerate(axes) if axis in "TC"), 0)
            frame = choose_frame(path, frame, shape[at])
        elif len(shape) != 3:
            raise LeaflightError(
                f"{path}: the data are {text(shape)}, but a volume needs three dimensions, "
                "or four, of which one is the frame."
            )
        else:
            no_frame(path, frame)
        values = series.asarray().squeeze()
        if len(shape) == 4:
            values = np.take(values, frame, axis=at)
        return to_float32(values), _voxel_size(file)


def _read_folder(path, frame):
    no_frame(path, frame)
    slices = [p for p in path.iterdir() if p.suffix.lower() in (".tif", ".tiff") and p.is_file()]
    if not slices:
        raise LeaflightError(f"{path}: this folder holds no .tif or .tiff files.")
    slices.sort(key=lambda p: [int(s) if s.isdigit() else s for s in re.split(r"(\d+)", p.name)])
    values = None
    for k, slice_path in enumerate(slices):
        with opened(slice_path) as file:
            series = file.series[0]
            _check_pages(slice_path, file, series)
            image = series.asarray().squeeze()
        if image.ndim != 2 or (values is not None and image.shape != values.shape[1:]):
            raise LeaflightError(
                f"{slice_path}: the slice is {text(image.shape)}, but every slice of the folder "
                "must be one plane of the same size."
            )
        if values is None:
            values = np.empty((len(slices), *image.shape), dtype=np.float32)
        values[k] = image
    return values


@contextmanager
def opened(path):
    """The open TiffFile; damage that tifffile raises or logs is a LeaflightError."""
    damage = LeaflightError(
        f"{path}: this is not a readable TIFF file, or it is truncated or damaged; fetch it again."
    )
    complaints = _Complaints()
    log = logging.getLogger("tifffile")
    log.addHandler(complaints)
    propagate, log.propagate = log.propagate, False
    try:
        with tifffile.TiffFile(path) as file:
            if not file.pages or not file.series:
                raise damage
            yield file
            if complaints.damage:
                raise damage
    except LeaflightError:
        if complaints.damage:
            raise damage from None
        raise
    except (MemoryError, OSError):
        raise
    except Exception as error:
        # On damaged files tifffile fails with whatever comes first, from KeyError to a failed
        # assertion and the XML parser's own error.
        if "requires the 'imagecodecs'" in str(error):
            raise LeaflightError(
                f"{path}: its compression is not supported; "
                "save the stack uncompressed or deflated."
            ) from None
        raise damage from None
    finally:
        log.propagate = propagate
        log.removeHandler(complaints)


class _Complaints(logging.Handler):
    """tifffile logs a broken chain of pages and goes on with the pages before the break."""

    def __init__(self):
        super().__init__(logging.WARNING)
        self.damage = False

    def emit(self, record):
        message = record.getMessage()
        self.damage |= record.levelno >= logging.ERROR or "invalid page offset" in message


def _check_pages(path, file, series):
    if "S" in series.axes and series.shape[series.axes.index("S")] > 1:
        raise LeaflightError(
            f"{path}: the pages are colour images, but a volume needs one number a voxel; "
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


def _voxel_size(file):
    """(x, y, z) from ImageJ's or OME's metadata, or None."""
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
            return None
    elif file.is_imagej:
        tags = file.pages[0].tags
        try:
            resolutions = [tags[name].value for name in ("XResolution", "YResolution")]
            sizes = [below / above for above, below in resolutions]
            sizes.append(float(file.imagej_metadata["spacing"]))
        except (KeyError, TypeError, ValueError, ZeroDivisionError):
            return None
    else:
        return None
    return sizes if all(0 < size < float("inf") for size in sizes) else None
