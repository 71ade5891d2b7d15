# SPDX-License-Identifier: GPL-3.0-or-later
"""The color table behind the values of a FreeSurfer volume.

https://surfer.nmr.mgh.harvard.edu/fswiki/LabelsClutsAnnotationFiles
"""

from io import BufferedIOBase
from struct import error, unpack

from ...volume.label_table import MOST_LABELS, Label

# Size of the parameters of the scan between the values and the tags: five numbers.
_SCAN = 20
# Tags: the color table, those without a length, and the one with a short length.
_TABLE, _WITHOUT, _SHORT = 1, (2, 20), 30
# Version of color tables with a number for each label.
_VERSION = -2
# Upper bounds on bytes of a name and of another tag.
_MOST_NAME, _MOST = 1 << 12, 1 << 28


def read_labels(file: BufferedIOBase) -> tuple[Label, ...] | None:
    """Returns the labels above 0 of the first color table, () without one, None if it is damaged.

    file: Positioned at the end of the values.
    """
    file.read(_SCAN)
    try:
        while len(tag := file.read(4)) == 4:
            (kind,) = unpack(">i", tag)
            if kind == _TABLE:
                return _table(file)
            if kind in _WITHOUT:
                # Their lengths are unknown.
                return ()
            length = _number(file) - 1 if kind == _SHORT else unpack(">q", file.read(8))[0]
            if not 0 <= length <= _MOST:
                return ()
            file.read(length)
    except error:
        pass
    return ()


def _table(file: BufferedIOBase) -> tuple[Label, ...] | None:
    try:
        version = _number(file)
        # In early tables the version is the number of labels, whose numbers are their places.
        is_early = version > 0
        most = version if is_early else _number(file)
        _text(file)
        count = version if is_early else _number(file)
        if version < 1 and version != _VERSION or not 0 <= count <= most <= MOST_LABELS + 1:
            return None
        found = []
        for place in range(count):
            number = place if is_early else _number(file)
            name = _text(file)
            red, green, blue, _ = (_number(file) / 255.0 for _ in range(4))
            found.append(Label.of(number, name, (red, green, blue)))
    except (error, ValueError):
        return None
    return tuple(label for label in found if label.number > 0)


def _number(file: BufferedIOBase) -> int:
    number: int = unpack(">i", file.read(4))[0]
    return number


def _text(file: BufferedIOBase) -> str:
    length = _number(file)
    if not 0 <= length <= _MOST_NAME:
        raise ValueError("The name is too long.")
    return file.read(length).rstrip(b"\0").decode("utf-8", "replace")
