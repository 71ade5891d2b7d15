# SPDX-License-Identifier: GPL-3.0-or-later
"""NIfTI-1 and -2 through nibabel, in the scanner's or template's own world coordinates."""

import zlib
from contextlib import contextmanager

import nibabel
import numpy as np

from ..._core import LeaflightError
from ...volume.volume import Volume
from .checks import (
    DEFLATE_MOST,
    check_scalar,
    check_size,
    choose_frame,
    no_frame,
    text,
    to_float32,
    truncated,
)


def read(path, frame=None):
    """Reads the scaled values and the affine (sform, else qform), whichever way it may mirror."""
    try:
        with _quiet_nibabel():
            image = nibabel.load(path)
        affine = np.array(image.affine, dtype=np.float64)
        proxy = image.dataobj
        shape, dtype = image.shape, image.get_data_dtype()
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

    while len(shape) > 3 and shape[-1] == 1:
        shape = shape[:-1]
    if len(shape) not in (3, 4) or min(shape) < 1:
        raise LeaflightError(
            f"{path}: the data are {text(shape)}, but a volume needs three dimensions, "
            "or four, of which one is the frame."
        )
    check_scalar(path, dtype)
    if not np.isfinite(affine).all():
        raise LeaflightError(f"{path}: the affine in the header is not finite; repair the header.")
    stored, most = path.stat().st_size, DEFLATE_MOST
    if path.suffix.lower() != ".gz":
        stored, most = max(0, stored - int(proxy.offset)), 1
    check_size(path, shape, dtype.itemsize, stored, most)

    if len(shape) == 4:
        last = (0,) * (len(image.shape) - 4)
        index = (slice(None),) * 3 + (choose_frame(path, frame, shape[3]),) + last
    else:
        no_frame(path, frame)
        index = (slice(None),) * 3 + (0,) * (len(image.shape) - 3)
    try:
        # Without a frame to cut out, nibabel scales in float32 rather than float64.
        whole = len(image.shape) == 3
        values = np.asarray(proxy, dtype=np.float32) if whole else proxy[index]
    except (EOFError, OSError, ValueError, zlib.error):
        raise truncated(path, shape) from None
    name = path.name[: path.name.lower().rindex(".nii")]
    return Volume(to_float32(values.T), affine, name, str(path))


@contextmanager
def _quiet_nibabel():
    """nibabel tells stderr of harmless oddities of a header."""
    logger = nibabel.imageglobals.logger
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before
