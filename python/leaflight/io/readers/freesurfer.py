# SPDX-License-Identifier: GPL-3.0-or-later
"""FreeSurfer volumes, .mgh and compressed .mgz, through nibabel, and the color table behind them.

https://surfer.nmr.mgh.harvard.edu/fswiki/LabelsClutsAnnotationFiles
"""

from dataclasses import replace
from io import BufferedIOBase
from math import prod
from pathlib import Path
from struct import error, unpack

import numpy as np
from nibabel.freesurfer.mghformat import MGHHeader

from ..._core import Progress
from ...volume.label_table import MOST_LABELS, Label
from ...volume.volume import Volume
from .scans import Scan, stored_scan
from .stored import StoredVolume
from .watched import open_head, open_watched

# Size and version of the header. nibabel sets the fields after the values to defaults.
_HEADER, _VERSION = 284, b"\0\0\0\1"
_DAMAGED = "The color table of the labels is damaged, so they have numbers as names."


def open_volume(path: Path) -> StoredVolume:
    """Opens a volume with three axes, or four with the frame, in the scanner's coordinates."""
    with open_head(path) as file:
        block = file.read(_HEADER)
    if len(block) < _HEADER or block[:4] != _VERSION:
        raise ValueError("It does not begin as such files do.")
    header = MGHHeader(block)
    dtype = np.dtype(header.get_data_dtype()).newbyteorder(">")
    shape = tuple(int(size) for size in header.get_data_shape())
    affine = np.asarray(header.get_affine(), np.float64)
    stored = stored_scan(path, Scan(path, header.get_data_offset(), shape, dtype, affine))
    size = prod(shape) * dtype.itemsize

    def load(frame: int, channel: int, progress: Progress) -> Volume:
        volume = stored.load(frame, channel, progress)
        with open_watched(path, progress) as file:
            file.seek(header.get_data_offset() + size)
            labels = read_labels(file)
        if labels is None:
            return volume.noted(_DAMAGED)
        return replace(volume, labels=labels)

    return replace(stored, load=load) if dtype.kind in "iu" else stored


# Size of the parameters of the scan between the values and the tags: five numbers.
_SCAN = 20
# Tags: the color table, those without a length, and the one with a short length.
_TABLE, _WITHOUT, _SHORT = 1, (2, 20), 30
# Version of color tables with a number for each label.
_NUMBERED = -2
# Upper bounds on bytes of a name and of another tag.
_MOST_NAME, _MOST_TAG = 1 << 12, 1 << 28


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
            if not 0 <= length <= _MOST_TAG:
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
        if version < 1 and version != _NUMBERED or not 0 <= count <= most <= MOST_LABELS + 1:
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
