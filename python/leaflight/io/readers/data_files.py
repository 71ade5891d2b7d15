# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a text header refers to: one, a list, or a pattern with a number."""

import re
from collections.abc import Sequence
from pathlib import Path

from ..._core import LeaflightError
from .checks import data_file, text

# A pattern with one number, such as slice%03d.raw, followed by first, last and step.
_PATTERN = re.compile(r"([^%]*%0?\d{0,2}[diu][^%]*?)((?:\s+-?\d{1,9}){0,4})")
_LIST = re.compile(r"LIST(?:\s+(\d{1,2})D?)?", re.IGNORECASE)
# Upper bound on the files, more than any volume has planes.
_MOST = 1 << 16


def data_files(
    path: Path, field: str, listed: Sequence[str], shape: Sequence[int]
) -> tuple[Path, ...]:
    """Returns the files that share the values of an array evenly, in order. Raises LeaflightError.

    field: The header's text about the files.
    listed: Lines after the header.
    shape: Sizes of the axes, fastest first. By default a file has all but the slowest.
    """
    if found := _LIST.fullmatch(field):
        axes = int(found[1] or 0) or len(shape) - 1
        names = [line.strip() for line in listed if line.strip()]
        _check_count(path, len(names), shape, axes)
    elif (found := _PATTERN.fullmatch(field)) and not (path.parent / field).is_file():
        numbers = [int(word) for word in found[2].split()]
        axes = numbers.pop() if len(numbers) == 4 else len(shape) - 1
        steps = _numbers(path, numbers, shape[-1])
        _check_count(path, len(steps), shape, axes)
        names = [found[1] % number for number in steps]
    else:
        return (data_file(path, field),)
    return tuple(data_file(path, name) for name in names)


def _numbers(path: Path, given: Sequence[int], count: int) -> Sequence[int]:
    """Returns the numbers of a pattern's files. given: None, the first, the last, the step."""
    first = given[0] if given else 1
    if len(given) < 2:
        return range(first, first + count)
    last = given[1]
    evenly = (last - first) // max(count - 1, 1)
    step = given[2] if len(given) > 2 else evenly or (1 if last >= first else -1)
    if not step:
        raise LeaflightError(
            f"{path}: the header numbers the data files in steps of 0; correct the header."
        )
    return range(first, last + (1 if step > 0 else -1), step)


def _check_count(path: Path, count: int, shape: Sequence[int], axes: int) -> None:
    """Raises LeaflightError unless the array can be split into this many files of `axes` axes."""
    wanted = 1
    for size in shape[axes:]:
        wanted *= size
    # Files with all axes are slabs along the slowest.
    right = shape[-1] % max(count, 1) == 0 if axes == len(shape) else count == wanted
    if not 0 < axes <= len(shape) or not right or not 0 < count <= _MOST:
        raise LeaflightError(
            f"{path}: the header names {count} data files, which do not match {text(shape)} "
            "values; correct the header."
        )
