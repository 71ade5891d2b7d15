# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds in .ply whose points have a value, interpolated to a volume.

http://paulbourke.net/dataformats/ply
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..._core import LeaflightError, Progress
from ...volume.scattered_points import interpolated
from ...volume.volume import Volume
from .checks import check_size, choose_named, truncated
from .encodings import NUMBERS
from .stored import StoredVolume

_MARKS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
# Properties that are not values.
_OTHERS = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha", "s", "t", "u", "v"}
# Upper bound on the bytes of a header.
_MOST = 1 << 16


def open_volume(
    path: Path, dataset: str | None = None, dims: Sequence[int] | None = None
) -> StoredVolume:
    """Opens a point cloud.

    dataset: Name of the property with the value, if there are several.
    dims: Nodes, see interpolated().
    """
    form, count, dtype, offset = _header(path)
    fields = dtype.names or ()
    names = tuple(name for name in fields if name not in _OTHERS)
    if not names or not set("xyz") <= set(fields):
        raise LeaflightError(
            f"{path}: the points have the properties {', '.join(fields) or '(none)'}, but need x, "
            "y, z and a value of any other name; add them."
        )
    name = "value" if dataset is None and "value" in names else choose_named(path, names, dataset)
    stored = path.stat().st_size - offset
    # A number in text takes at least two characters.
    itemsize = dtype.itemsize if _MARKS[form] else 2 * len(fields)
    check_size(path, (count,), itemsize, stored)

    def load(_frame: int, _channel: int, _progress: Progress) -> Volume:
        with open(path, "rb") as file:
            file.seek(offset)
            if _MARKS[form]:
                table = np.frombuffer(file.read(count * dtype.itemsize), dtype)
            else:
                plain = [(field, np.float64) for field in fields]
                table = np.loadtxt(file, plain, max_rows=count, ndmin=1)
        if len(table) != count:
            raise truncated(path, (count,))
        points = np.stack([table[axis] for axis in "xyz"], axis=-1)
        return interpolated(points, table[name], path.stem, str(path), dims)

    return StoredVolume(None, np.dtype(np.float32), load, datasets=names)


def _header(path: Path) -> tuple[str, int, np.dtype[Any], int]:
    """Returns (format, number of points, dtype of a point, first byte of the points)."""
    with open(path, "rb") as file:
        begin = file.read(_MOST)
    found = re.search(rb"end_header\r?\n", begin)
    text = begin[: found.start()] if found else b""
    lines = text.decode("latin-1").split("\n")
    words = [line.split() for line in lines if line.strip()]
    form = next((line[1] for line in words if line[0] == "format" and len(line) > 1), None)
    if not found or words[0] != ["ply"] or form not in _MARKS:
        raise ValueError("the header")
    elements = [number for number, line in enumerate(words) if line[0] == "element"]
    if not elements or words[elements[0]][1] != "vertex":
        raise LeaflightError(
            f"{path}: the points are not the first element; save the file with points first."
        )
    last = elements[1] if len(elements) > 1 else len(words)
    properties = [line[1:] for line in words[elements[0] + 1 : last] if line[0] == "property"]
    if any(kind not in NUMBERS for kind, *_ in properties):
        raise LeaflightError(
            f"{path}: the points have properties that are lists; save only numbers."
        )
    dtype = np.dtype([(name, _MARKS[form] + NUMBERS[kind]) for kind, name in properties])
    return form, int(words[elements[0]][2]), dtype, found.end()
