# SPDX-License-Identifier: GPL-3.0-or-later
"""NIfTI-1 and -2 through nibabel, in the scanner's or template's own world coordinates."""

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
from nibabel.arrayproxy import ArrayProxy

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.units import unit_of
from ...volume.volume import Volume
from .checks import DEFLATE_MOST, check_scalar, check_shape, check_size, truncated
from .stored import StoredVolume, lengths
from .watched import open_watched, read_values


def open_volume(path: Path) -> StoredVolume:
    """The values and the affine (sform, else qform), whichever way it may mirror.

    Values that the header scales become float32.
    """
    image, affine, unit = _image(path)
    proxy, shape, dtype = image.dataobj, image.shape, image.get_data_dtype()
    while len(shape) > 3 and shape[-1] == 1:
        shape = shape[:-1]
    check_shape(path, shape)
    check_scalar(path, dtype)
    if not np.isfinite(affine).all():
        raise LeaflightError(f"{path}: the affine in the header is not finite; repair the header.")
    stored, most = path.stat().st_size, DEFLATE_MOST
    if path.suffix.lower() != ".gz":
        stored, most = max(0, stored - int(proxy.offset)), 1
    check_size(path, shape, dtype.itemsize, stored, most)
    name = path.name[: path.name.lower().rindex(".nii")]
    layout = (image.shape, dtype, proxy.offset, proxy.slope, proxy.inter)
    scaled = (proxy.slope, proxy.inter) != (1, 0)

    def load(frame: int, _channel: int, progress: Progress) -> Volume:
        index: tuple[slice | int, ...] = (slice(None),) * 3
        if len(shape) == 4:
            index += (frame,)
        index += (0,) * (len(image.shape) - len(index))
        try:
            with open_watched(path, progress) as file:
                if not scaled:
                    size = prod(shape[:3]) * dtype.itemsize
                    file.seek(int(proxy.offset) + frame * size)
                    return Volume(read_values(file, shape[2::-1], dtype), affine, name)
                stored = ArrayProxy(file, layout, mmap=False)
                # Without a frame to cut out, nibabel scales in float32 rather than float64.
                if len(image.shape) == 3:
                    values = np.asarray(stored, dtype=np.float32)
                else:
                    values = stored[index]
        except (EOFError, OSError, ValueError, zlib.error):
            raise truncated(path, shape) from None
        return Volume(values.T, affine, name)

    return StoredVolume(
        dims=tuple(shape[:3]),
        dtype=np.dtype(np.float32) if scaled else dtype,
        load=load,
        voxel_size=lengths(affine),
        # Where the header does not say, it is what the format was made for.
        unit=unit or "mm",
        frames=shape[3] if len(shape) == 4 else 1,
        # By the format's rule.
        patient=True,
    )


def _image(path: Path) -> tuple[Any, Array, str]:
    """(the image of nibabel, its affine, its unit)."""
    try:
        with _quiet_nibabel():
            # A mapped file might change behind our back.
            image = nibabel.load(path, mmap=False)
        unit = unit_of(image.header.get_xyzt_units()[0])
        image.get_data_dtype()
        return image, np.array(image.affine, dtype=np.float64), unit
    except (
        nibabel.filebasedimages.ImageFileError,
        nibabel.spatialimages.HeaderDataError,
        EOFError,
        KeyError,
        OSError,
        OverflowError,
        ValueError,
        zlib.error,
    ):
        raise LeaflightError(
            f"{path}: this is not a readable NIfTI file; it is damaged or of another kind."
        ) from None


@contextmanager
def _quiet_nibabel() -> Iterator[None]:
    """nibabel logs harmless oddities of a header to stderr."""
    logger = nibabel.imageglobals.logger
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before
