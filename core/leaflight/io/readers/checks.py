# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the readers share, all made before memory is allocated for the values."""

from math import prod

import numpy as np

from ..._core import LeaflightError
from ...volume.setting_error import SettingError

# Deflate turns at most this many bytes into one, so a larger claim in a header is a lie.
DEFLATE_MOST = 1032


def check_size(path, shape, itemsize, stored, most=1):
    """Raises LeaflightError when shape claims over `most` bytes for each of the stored bytes."""
    claimed = prod(int(n) for n in shape) * int(itemsize)
    if claimed > int(stored) * most:
        raise LeaflightError(
            f"{path}: the header claims {text(shape)} values ({claimed} bytes), but the file "
            f"holds only {stored} bytes of data: it is truncated or damaged, fetch it again."
        )


def truncated(path, shape):
    """The error for a file whose data end early or do not decode."""
    return LeaflightError(
        f"{path}: the file ends before its {text(shape)} values do, or is damaged; fetch it again."
    )


def check_scalar(path, dtype):
    """Raises LeaflightError unless a value is one real number."""
    dtype = np.dtype(dtype)
    if dtype.kind not in "biuf":
        kind = "complex" if dtype.kind == "c" else "colour or structured"
        raise LeaflightError(
            f"{path}: the values are {kind} ({str(dtype)[:60]}), but a volume needs one real "
            "number a voxel; convert the file first."
        )


def choose_frame(path, frame, count):
    """The frame to read out of count; 4D data demand a choice. Raises LeaflightError."""
    if frame is None:
        raise SettingError(
            f"{path}: the data are 4D with {count} frames; choose one of 0..{count - 1}.", "frame"
        )
    if not 0 <= frame < count:
        raise SettingError(
            f"{path}: there is no frame {frame}; choose one of 0..{count - 1}.", "frame"
        )
    return int(frame)


def no_frame(path, frame):
    """Raises LeaflightError when a frame was chosen of 3D data; frame 0 is what there is."""
    if frame not in (None, 0):
        raise SettingError(
            f"{path}: the data are 3D and have no frame {frame}; choose none.", "frame"
        )


def index_to_world(path, spacing):
    """The matrix (4, 4) of a grid at the origin whose voxels have this size, one or (x, y, z)."""
    sizes = np.atleast_1d(np.asarray(spacing, dtype=np.float64))
    if sizes.shape not in ((1,), (3,)) or not (np.isfinite(sizes).all() and (sizes > 0).all()):
        raise LeaflightError(
            f"{path}: the spacing must be one positive number or three, X Y Z, not {spacing}."
        )
    return np.diag([*np.broadcast_to(sizes, 3), 1.0])


def to_float32(values):
    """Values (nz, ny, nx) as float32 with x fastest; copies only when it must."""
    # float64 values beyond the range of float32 become infinite, which Field refuses by itself.
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(values, dtype=np.float32)


def text(shape):
    return " x ".join(str(int(n)) for n in shape)
