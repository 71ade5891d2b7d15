# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of scattered points, x, y, z and a value in each line, interpolated into a volume."""

import io
import re

import numpy as np

from ..._core import LeaflightError
from ...volume.scattered_points import interpolated
from .stored import StoredVolume

COLUMNS = ("x", "y", "z", "value")


def open_volume(path, dims=None):
    """The columns x, y, z and value of a first line that names them, else the first four.

    Between numbers stand commas, semicolons or spaces. dims: nodes, see interpolated().
    """

    def load(_frame, _channel, _progress):
        table = _table(path)
        return interpolated(table[:, :3], table[:, 3], path.stem, str(path), dims)

    return StoredVolume(None, np.dtype(np.float32), load)


def _table(path):
    """Rows of x, y, z and value."""
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    first, _, rest = text.lstrip().partition("\n")
    names = [name.strip(" \t\"'").lower() for name in re.split(r"[,;\t ]+", first.lstrip("# "))]
    has_names = any(re.fullmatch(r"[a-z_]\w*", name) for name in names if name != "nan")
    columns = range(4)
    if has_names:
        if not set(names) >= {"x", "y", "z"} or len(names) < 4:
            raise LeaflightError(
                f"{path}: its first line must name the columns {', '.join(COLUMNS)}, or there must "
                "be no names."
            )
        others = [name for name in names if name not in "xyz"]
        value = "value" if "value" in others else others[0]
        columns = [names.index(name) for name in ("x", "y", "z", value)]
    lines = (rest if has_names else text).translate(str.maketrans(";,\t", "   "))
    try:
        return np.loadtxt(io.StringIO(lines), np.float64, ndmin=2, usecols=list(columns))
    except ValueError as error:
        raise LeaflightError(
            f"{path}: each line must hold the numbers {', '.join(COLUMNS)}, separated by commas "
            f"({' '.join(str(error).split())[:100]})."
        ) from None
