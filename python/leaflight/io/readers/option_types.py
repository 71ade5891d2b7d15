# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the types of options for reading, which scene files may hold in any type."""

import os
from collections.abc import Mapping

import numpy as np

from ...paths import AnyPath
from ...volume.setting_error import SettingError

_TEXT = ("U", (0,), "a text")
_WHOLE = ("iu", (0,), "a whole number")
_NUMBER = ("iuf", (0,), "a number")
# Names of options, and (kinds of NumPy types, numbers of axes, the right value).
_TYPES = {
    "dims": ("iuf", (1,), "a list of numbers"),
    "type": _TEXT,
    "endian": _TEXT,
    "spacing": ("iuf", (0, 1), "one positive number or three, X Y Z"),
    "grid": _TEXT,
    "level": _WHOLE,
    "dataset": _TEXT,
    "skip": _WHOLE,
    "frame": _NUMBER,
    "channel": ("iuU", (0, 1), "a whole number or a name"),
    "smooth": _NUMBER,
    "smooth_normals": _NUMBER,
    "hide": ("iu", (1,), "the numbers of labels"),
    "label_table": ("U", (0,), "a path"),
}


def check_types(source: AnyPath, options: Mapping[str, object]) -> None:
    """Raises SettingError for a value of a wrong type. None is no choice."""
    for name, value in options.items():
        if value is None or name not in _TYPES:
            continue
        kinds, axes, right = _TYPES[name]
        try:
            array = np.asarray(os.fspath(value) if isinstance(value, os.PathLike) else value)
        except ValueError:
            # Rows of different lengths are no array.
            array = np.empty((), object)
        if array.ndim not in axes or (array.size and array.dtype.kind not in kinds):
            raise SettingError(f"{source}: {name} is {value!r:.80}; give {right}.", name)
