# SPDX-License-Identifier: GPL-3.0-or-later
"""FreeSurfer volumes, .mgh and compressed .mgz, through nibabel."""

from dataclasses import replace
from math import prod
from pathlib import Path

import numpy as np
from nibabel.freesurfer.mghformat import MGHHeader

from ..._core import Progress
from ...volume.volume import Volume
from .freesurfer_labels import read_labels
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
