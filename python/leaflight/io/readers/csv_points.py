# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of scattered points: x, y, z and a value in each line, interpolated to a volume."""

import csv
import io
import re
from array import array
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import cast

import numpy as np

from ..._core import LeaflightError, Progress
from ...arrays import Array
from ...volume.scattered_points import interpolated
from ...volume.volume import Volume
from .stored import StoredVolume
from .watched import open_watched

COLUMNS = ("x", "y", "z", "value")


def open_volume(path: Path, dims: Sequence[int] | None = None) -> StoredVolume:
    """Opens the columns x, y, z and value that the first line names, else the first four.

    If no column is named value, the first other column of numbers is used. Separators are commas,
    semicolons, tabs or spaces. dims: Nodes, see interpolated().
    """

    def load(_frame: int, _channel: int, progress: Progress) -> Volume:
        table = _table(path, progress)
        return interpolated(table[:, :3], table[:, 3], path.stem, str(path), dims)

    return StoredVolume(None, np.dtype(np.float32), load)


def _table(path: Path, progress: Progress) -> Array:
    """Returns rows of x, y, z and value."""
    table = array("d")
    with open_watched(path, progress) as file:
        reader = cast(io.BufferedReader, file)
        text = io.TextIOWrapper(reader, encoding="utf-8-sig", errors="replace")
        lines = (line for line in text if line.strip())
        first = next(lines, "")
        # The names may be in a comment.
        names = [name.lower() for name in _row(first.lstrip("# \t"))]
        named = any(re.match(r"[a-z_]", name) and name not in ("nan", "inf") for name in names)
        rest = lines if named else chain((first,), lines)
        rows = (_row(line) for line in rest if line.strip() and not line.lstrip().startswith("#"))
        head = next(rows, [])
        columns = _columns(path, names, head) if named else range(4)
        for row in chain((head,), rows) if head else ():
            try:
                table.extend([float(row[column]) for column in columns])
                if len(row) != len(head):
                    raise ValueError
            except (IndexError, ValueError):
                raise LeaflightError(
                    f"{path}: the line {', '.join(row)[:60]!r} lacks numbers or fields; give "
                    f"{', '.join(COLUMNS)} in each line, and as many fields as in the first."
                ) from None
    return np.array(table, np.float64).reshape(-1, 4)


def _columns(path: Path, names: list[str], row: list[str]) -> list[int]:
    """Returns the columns of x, y, z and the value. row: The first row of numbers."""
    others = [name for name in names if name not in ("x", "y", "z", "")]
    numbers = [name for name in others if _is_number(row, names.index(name))]
    if not {"x", "y", "z"} <= set(names) or not (numbers or others):
        raise LeaflightError(
            f"{path}: the first line does not name the columns {', '.join(COLUMNS)}; name them, "
            "or leave all names out."
        )
    value = "value" if "value" in others else (numbers or others)[0]
    return [names.index(name) for name in ("x", "y", "z", value)]


def _is_number(row: list[str], column: int) -> bool:
    try:
        float(row[column])
    except (IndexError, ValueError):
        return False
    return True


def _row(line: str) -> list[str]:
    """Returns the fields of a line. Separators are semicolons, tabs or commas, else spaces."""
    separator = next((one for one in ";\t," if one in line), None)
    if separator is None:
        return line.replace('"', "").split()
    fields = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    return [field.strip() for field in fields]
