# SPDX-License-Identifier: GPL-3.0-or-later
"""Scans whose headers nibabel reads. Their values are in one file, x fastest."""

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.volume import Volume
from .channels import RGB, Channel
from .checks import check_scalar, check_shape, truncated
from .stored import StoredVolume, lengths
from .value_files import Index, ValueFiles
from .watched import is_packed

# Type of scaled(place, progress), which reads and scales the values of one frame and channel, [x,
# y, z].
Scaled = Callable[[tuple[int, ...], Progress], Array]


@dataclass(frozen=True)
class Scan:
    """The data of a header.

    file: File with the values from byte `offset` on, compressed or not.
    shape: Sizes (x, y, z) and then frames and channels, if any.
    affine: Matrix to right, anterior, superior.
    patient: False if the header does not say where these are.
    scaled: Function that returns scaled values of the type scaled_dtype, if the header scales.
    """

    file: Path
    offset: int
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    affine: Array
    scaled: Scaled | None = None
    scaled_dtype: np.dtype[Any] = np.dtype(np.float32)
    unit: str = "mm"
    patient: bool = True
    notes: tuple[str, ...] = ()


def stored_scan(path: Path, scan: Scan) -> StoredVolume:
    """Returns the StoredVolume of a Scan. Raises LeaflightError if the header claims too much."""
    shape = scan.shape
    while len(shape) > 3 and shape[-1] == 1:
        shape = shape[:-1]
    check_shape(path, shape[:4] if len(shape) == 5 else shape)
    # Colors are stored for each voxel as one byte each of red, green, blue and perhaps alpha.
    colors = len(scan.dtype.names or ())
    dtype = np.dtype(np.uint8) if colors and scan.dtype.itemsize == colors else scan.dtype
    check_scalar(path, dtype)
    if not np.isfinite(scan.affine).all():
        raise LeaflightError(f"{path}: the affine in the header is not finite; repair the header.")
    if scan.offset < 0 or min(shape) < 1:
        raise ValueError("the place of the values")
    values = ValueFiles((scan.file,), "gzip" if is_packed(scan.file) else "raw", skip=scan.offset)
    stored = (*shape[::-1], colors) if colors else shape[::-1]
    values.check(stored, dtype)
    name = Path(path.name[:-3] if path.name.lower().endswith(".gz") else path.name).stem

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        place = (frame, 0 if colors else channel)[: len(shape) - 3]
        if scan.scaled is None or colors:
            space = slice(None), slice(None), slice(None)
            index: Index = (*place[::-1], *space, channel) if colors else (*place[::-1], *space)
            read = values.read(stored, dtype, index, progress)
            return Volume(read, scan.affine, name)
        try:
            return Volume(scan.scaled(place, progress).T, scan.affine, name)
        except (EOFError, OSError, ValueError, zlib.error):
            raise truncated(path, shape) from None

    return StoredVolume(
        dims=tuple(shape[:3]),
        dtype=scan.scaled_dtype if scan.scaled and not colors else dtype,
        load=load,
        voxel_size=lengths(scan.affine),
        unit=scan.unit,
        frames=shape[3] if len(shape) > 3 else 1,
        channels=colors or (shape[4] if len(shape) > 4 else 1),
        channel_list=(*RGB, Channel("alpha"))[:colors],
        patient=scan.patient,
        notes=scan.notes,
    )
