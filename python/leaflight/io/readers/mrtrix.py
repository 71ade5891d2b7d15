# SPDX-License-Identifier: GPL-3.0-or-later
"""MRtrix: a text header, with values behind it (.mif, .mif.gz) or in other files (.mih).

https://mrtrix.readthedocs.io/en/latest/getting_started/image_data.html
"""

import re
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.memory import new_voxels
from ...volume.volume import Volume
from .checks import check_matrix, check_shape, data_file
from .packing import scaled_type
from .stored import StoredVolume, lengths
from .value_files import Index, ValueFiles
from .watched import is_packed, open_head, watched

_TYPE = re.compile(r"(?:(u?int|float)(8|16|32|64)|bit)(le|be)?", re.IGNORECASE)
_AXIS = re.compile(r"([+-]?)(\d{1,2})")
# Upper bound on the bytes of a header, including a long history of commands.
_MOST = 1 << 22


def open_volume(path: Path) -> StoredVolume:
    """Opens three axes of space. The fourth axis counts frames, the fifth channels."""
    fields = _header(path)
    sizes = tuple(map(int, _words(fields, "dim")))
    is_known = len(sizes) > 3 and prod(sizes[5:]) == 1
    check_shape(path, (*sizes[:3], prod(sizes[3:5])) if is_known else sizes)
    dtype, bits = _type(path, fields)
    # Axes of the file, slowest first, and True for each that is reversed.
    axes, backwards = _layout(path, fields, len(sizes))
    shape = [sizes[axis] for axis in axes]
    stored, matrix = _value_files(path, fields), _matrix(path, fields)
    stored_shape = [(prod(shape) + 7) // 8] if bits else shape
    stored.check(stored_shape, dtype)
    offset, scale = _numbers(fields, "scaling", "0 1")
    scaled = None if (offset, scale) == (0, 1) else scaled_type(dtype, scale, offset)

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        places = [frame, channel, *[0] * len(sizes)]
        index: Index = tuple(
            slice(None) if axis < 3 else _from(backwards[axis], places[axis - 3], sizes[axis])
            for axis in axes
        )
        if bits:
            packed = stored.read(stored_shape, dtype, (slice(None),), progress)
            values = np.unpackbits(packed, count=prod(shape)).reshape(shape)[index]
        else:
            values = stored.read(shape, dtype, index, progress)
        in_space = [axis for axis in axes if axis < 3]
        values = values.transpose([in_space.index(axis) for axis in (2, 1, 0)])
        values = values[
            tuple(slice(None, None, -1 if backwards[axis] else 1) for axis in (2, 1, 0))
        ]
        if scaled is not None:
            values = _scaled(values, offset, scale, scaled, progress)
        return Volume(values, matrix, path.name.partition(".mi")[0])

    return StoredVolume(
        dims=sizes[:3],
        dtype=dtype if scaled is None else scaled,
        load=load,
        voxel_size=lengths(matrix),
        unit="mm",
        frames=sizes[3] if len(sizes) > 3 else 1,
        channels=sizes[4] if len(sizes) > 4 else 1,
        patient=True,
    )


def _header(path: Path) -> dict[str, str]:
    """Returns the fields; lines of the same field are joined."""
    with open_head(path) as file:
        text = file.read(_MOST)
    lines = re.split(r"\r?\n", text.partition(b"\nEND")[0].decode("utf-8", "replace"))
    if lines[0].strip().lower() != "mrtrix image":
        raise ValueError("the first line")
    fields: dict[str, str] = {}
    for line in lines[1:]:
        name, colon, value = line.partition(":")
        if colon and not line.startswith("#"):
            name = name.strip().lower()
            fields[name] = f"{fields[name]}\n{value.strip()}" if name in fields else value.strip()
    return fields


def _words(fields: dict[str, str], name: str, default: str = "") -> list[str]:
    return re.split(r"[,\s]+", fields.get(name, default).strip())


def _numbers(fields: dict[str, str], name: str, default: str = "") -> list[float]:
    return [float(word) for word in _words(fields, name, default)]


def _type(path: Path, fields: dict[str, str]) -> tuple[np.dtype[Any], bool]:
    """Returns (type of the values, True if they are single bits)."""
    name = fields.get("datatype", "")
    found = _TYPE.fullmatch(name)
    if not found or (found[1] or "").lower() == "float" and found[2] == "8":
        raise LeaflightError(
            f"{path}: the type {name[:40]!r} is not a real number; convert the file with "
            "mrconvert first."
        )
    if found[1] is None:
        return np.dtype(np.uint8), True
    order = {"le": "<", "be": ">"}.get((found[3] or "").lower(), "=")
    return np.dtype(f"{order}{found[1][0].lower()}{int(found[2]) // 8}"), False


def _layout(path: Path, fields: dict[str, str], count: int) -> tuple[list[int], list[bool]]:
    """Returns (axes, slowest first; True for each axis that is reversed in the file)."""
    default = ",".join(map(str, range(count)))
    found = [_AXIS.fullmatch(word) for word in _words(fields, "layout", default)]
    ranks = [int(each[2]) for each in found if each]
    if len(set(ranks)) != count or len(found) != count:
        raise LeaflightError(
            f"{path}: the layout is not {count} different numbers, one for each axis; repair the "
            "header."
        )
    axes = sorted(range(count), key=lambda axis: -ranks[axis])
    return axes, [each[1] == "-" for each in found if each]


def _from(backwards: bool, place: int, size: int) -> int:
    return size - 1 - place if backwards else place


def _value_files(path: Path, fields: dict[str, str]) -> ValueFiles:
    """Returns the files of the field "file", with the first byte. A dot is the header's file."""
    lines = [line.rsplit(None, 1) for line in fields.get("file", "").split("\n")]
    lines = [[*words, "0"] if len(words) == 1 else words for words in lines]
    names, offsets = [words[0] for words in lines if words], {words[-1] for words in lines if words}
    if len(offsets) != 1 or not re.fullmatch(r"\d{1,15}", min(offsets)):
        raise LeaflightError(
            f"{path}: the header does not name the file of the values; convert the file with "
            "mrconvert first."
        )
    files = tuple(path if name == "." else data_file(path, name) for name in names)
    return ValueFiles(files, "gzip" if is_packed(files[0]) else "raw", skip=int(min(offsets)))


def _matrix(path: Path, fields: dict[str, str]) -> Array:
    matrix = np.eye(4)
    rows = np.array(_numbers(fields, "transform", "1 0 0 0 0 1 0 0 0 0 1 0"))
    # Old headers include the last row.
    matrix[:3] = rows[:12].reshape(3, 4)
    matrix[:3, :3] *= np.array(_numbers(fields, "vox"))[:3]
    check_matrix(path, matrix)
    return matrix


def _scaled(
    values: Array, offset: float, scale: float, dtype: np.dtype[Any], progress: Progress
) -> Array:
    held = new_voxels(values.shape, dtype)
    for k in watched(progress, range(len(values)), "Scaling"):
        held[k] = values[k] * np.float64(scale) + offset
    return held
