# SPDX-License-Identifier: GPL-3.0-or-later
"""MRC2014 and CCP4 maps through mrcfile: electron microscopy and crystallography, in angstrom.

https://www.ccpem.ac.uk/mrc_format/mrc2014.php
"""

import io
from pathlib import Path
from typing import Any

import mrcfile
import numpy as np
from mrcfile.mrcinterpreter import MrcInterpreter

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.setting_error import SettingError
from ...volume.volume import Volume
from .checks import DEFLATE_MOST, cell_axes, check_scalar, check_shape, check_size, matrix_at
from .stored import StoredVolume, lengths
from .value_files import Index, ValueFiles
from .watched import is_packed, open_head

# Bytes of the header, and offset of the length of the text behind it.
_HEADER, _LENGTH = 1024, 92
# The stamp, which old files lack, and the modes of 8-bit and of 4-bit values.
_STAMP, _MODES = b"MAP ", (0, 1, 2, 3, 4, 6, 12, 101)
_BYTES, _HALVES = 0, 101
# IMOD's stamp, its offset (flags follow it), and the flags for signed bytes and for an origin with
# the sign of the standard. https://bio3d.colorado.edu/imod/doc/mrc_format.txt
_IMOD, _IMOD_PLACE, _SIGNED, _STANDARD_ORIGIN = 1146047817, 152, 1, 4
# Version of the standard that defines the sign of bytes and of the origin.
_MRC2014 = 2014
# Number of values that are examined if the header does not tell if bytes are signed.
_SAMPLED = 1 << 22
_BY_HISTOGRAM = (
    "The header does not say if its bytes are signed. By their histogram they are read as {low} "
    "to {high}."
)
_IMAGES = "The file is a stack of images by its header; z counts the images."


def open_volume(path: Path) -> StoredVolume:
    """Opens a map. Its axes may be x, y and z in any order. Stacks of volumes are frames."""
    header = _header(path)
    if int(header["mode"]) == _HALVES:
        raise LeaflightError(
            f"{path}: values of four bits are not supported; save the file with eight, for "
            "example with IMOD's newstack -mode 0."
        )
    dtype = mrcfile.utils.data_dtype_from_header(header)
    check_scalar(path, dtype)
    counts = [int(header[name]) for name in ("nx", "ny", "nz")]
    packed = is_packed(path)
    offset = _HEADER + int(header["nsymbt"])
    stored = path.stat().st_size - (0 if packed else offset)
    check_size(path, counts, dtype.itemsize, max(0, stored), DEFLATE_MOST if packed else 1)
    check_shape(path, counts)
    notes: tuple[str, ...] = ()
    if int(header["mode"]) == _BYTES:
        dtype, notes = _type_of_bytes(path, header, offset)
    if path.suffix.lower() in (".mrcs", ".st") and int(header["ispg"]) == 0:
        notes += (_IMAGES,)
    # Axes of columns, rows and sections; x is 0. Old files leave them out.
    axes = [int(header[name]) - 1 for name in ("mapc", "mapr", "maps")]
    axes = axes if sorted(axes) == [0, 1, 2] else [0, 1, 2]
    frames, depth = 1, int(header["mz"])
    if int(header["ispg"]) >= 401 and 0 < depth < counts[2] and counts[2] % depth == 0:
        frames, counts[2] = counts[2] // depth, depth
    dims = [0, 0, 0]
    for axis, count in zip(axes, counts):
        dims[axis] = count
    matrix = _matrix(path, header, axes)
    # Numbers of the axes z, y and x among sections, rows and columns.
    order = [2 - axes.index(axis) for axis in (2, 1, 0)]
    values = ValueFiles((path,), "gzip" if packed else "raw", skip=offset)

    def load(frame: int, _channel: int, progress: Progress) -> Volume:
        index: Index = (frame, *(slice(None),) * 3)
        read = values.read((frames, *counts[::-1]), dtype, index, progress)
        return Volume(read.transpose(order), matrix, path.name.partition(".")[0])

    return StoredVolume(tuple(dims), dtype, load, lengths(matrix), "Å", frames, notes=notes)


def _header(path: Path) -> Array:
    """Returns the fields of the header, in the byte order that mrcfile finds.

    The length of the text is hidden from mrcfile, which would trust it.
    """
    with open_head(path) as file:
        head = file.read(_HEADER)
    without = head[:_LENGTH] + bytes(4) + head[_LENGTH + 4 :]
    interpreter = MrcInterpreter(io.BytesIO(without), permissive=True, header_only=True)
    header: Array = interpreter.header.copy()
    if header["map"].item() != _STAMP and int(header["mode"]) not in _MODES:
        raise SettingError(
            f"{path}: this is not a readable MRC or CCP4 map; for raw values, give the dimensions "
            "and the type.",
            "dims",
            "type",
        )
    header["nsymbt"] = np.frombuffer(head, header["nsymbt"].dtype, 1, _LENGTH)[0]
    length = int(header["nsymbt"])
    if length < 0:
        raise ValueError("the length of the text")
    check_size(path, (length,), 1, path.stat().st_size, DEFLATE_MOST if is_packed(path) else 1)
    return header


def _type_of_bytes(path: Path, header: Array, offset: int) -> tuple[np.dtype[Any], tuple[str, ...]]:
    """Returns (int8 or uint8, a note if it is a guess), because programs differ."""
    signed, unsigned = np.dtype(np.int8), np.dtype(np.uint8)
    flags = _imod_flags(header)
    if flags is not None:
        return (signed if flags & _SIGNED else unsigned), ()
    # Use the lowest and the highest value, if they are given.
    low, high = float(header["dmin"]), float(header["dmax"])
    if -128 <= low < 0 and low <= high <= 127:
        return signed, ()
    if 0 <= low <= high and 127 < high <= 255:
        return unsigned, ()
    if _version(header) == _MRC2014:
        return signed, ()
    dtype = signed if _cross_zero(path, offset) else unsigned
    limits = np.iinfo(dtype)
    return dtype, (_BY_HISTOGRAM.format(low=limits.min, high=limits.max),)


def _imod_flags(header: Array) -> int | None:
    """Returns IMOD's flags, None without its stamp."""
    words = np.frombuffer(header.tobytes(), header["nsymbt"].dtype, 2, _IMOD_PLACE)
    return int(words[1]) if words[0] == _IMOD else None


def _version(header: Array) -> int:
    """Returns the version of the standard, without the digit for revisions, or 0."""
    return int(header["nversion"]) // 10


def _cross_zero(path: Path, offset: int) -> bool:
    """Returns True if more bytes are near 0 and 255 than near 127 and 128.

    Signed values cross 0 there, unsigned ones 127. The ends do not count, because values are often
    clipped.
    """
    if is_packed(path):
        with open_head(path) as file:
            file.seek(offset)
            sample = np.frombuffer(file.read(_SAMPLED), np.uint8)
    else:
        values = np.memmap(path, np.uint8, "r", offset)
        sample = values[:: max(1, values.size // _SAMPLED)]
    counts = np.bincount(sample, minlength=256)
    with_sign = min(counts[240:255].sum(), counts[1:16].sum())
    without = min(counts[113:128].sum(), counts[128:143].sum())
    return bool(with_sign > without)


def _matrix(path: Path, header: Array, axes: list[int]) -> Array:
    """Returns the matrix of the unit cell, which may have any angles."""
    sizes = [float(header["cella"][name]) for name in "xyz"]
    angles = [float(header["cellb"][name]) for name in ("alpha", "beta", "gamma")]
    cell = cell_axes(np.ones(3), angles)
    samples = [max(1, int(header[name])) for name in ("mx", "my", "mz")]
    # Without a cell the voxel size is 1.
    steps = np.array([size / n if size > 0 else 1.0 for size, n in zip(sizes, samples)])
    starts = [0, 0, 0]
    for axis, name in zip(axes, ("nxstart", "nystart", "nzstart")):
        starts[axis] = int(header[name])
    # Microscopes write the origin, programs of crystallography the first index.
    origin = np.array([float(header["origin"][name]) for name in "xyz"])
    flags = _imod_flags(header)
    if flags is not None and not flags & _STANDARD_ORIGIN and _version(header) < _MRC2014:
        # Such an origin of IMOD is the place of the world's origin in the volume.
        origin = -origin
    has_origin = np.isfinite(origin).all() and origin.any()
    return matrix_at(path, cell * steps, origin if has_origin else cell * steps @ starts)
