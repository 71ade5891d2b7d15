# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts about a volume from its header, for the file dialog."""

import os
from math import prod
from pathlib import Path

from leaflight import LeaflightError
from leaflight.io import readers

from .. import session
from ..store import source_files
from ..translations import iface_

# Number of voxels, 512^3, above which a volume is halved unless the user chooses otherwise.
MOST_VOXELS = 1 << 27

RESOLUTION_ITEMS = [
    (
        "AUTO",
        "By Size",
        "Every voxel up to 512^3 of them; of larger volumes means of 2, 4 or 8 along each axis",
    ),
    ("FULL", "Full", "Every voxel"),
    ("HALF", "Half", "Means of two voxels along each axis: an eighth of the memory"),
    ("QUARTER", "Quarter", "Means of four voxels along each axis: a 64th of the memory"),
]
_STEPS = {"FULL": 1, "HALF": 2, "QUARTER": 4}

# Choices that do not change the facts in the header.
_NOT_ASKED = {"frame", "channel", "downsample", *source_files.CHANGES}

# Cache of the last file: (path, state of the file, choices) -> result of read_facts().
_last = session.cache()


def read_facts(path, choices):
    """Returns (StoredVolume, "") of a file, or (None, reason). Reads each file only once."""
    try:
        state = os.stat(path)
        where = sorted((name, choices[name]) for name in choices.keys() - _NOT_ASKED)
        key = (path, state.st_mtime_ns, state.st_size, tuple(where))
    except OSError:
        return None, ""
    if key not in _last:
        _last.clear()
        _last[key] = _look(path, choices)
    return _last[key]


def _look(path, choices):
    try:
        if Path(path).is_dir() and not _may_be_volume(path):
            return None, ""
        return source_files.probe(path, **choices), ""
    except LeaflightError as error:
        # The dialog shows the path itself.
        return None, str(error).removeprefix(f"{path}: ")


def _may_be_volume(path):
    """True if a folder that the user browses is one volume."""
    try:
        readers.format_of(path)
    except LeaflightError:
        return False
    return True


def step_of(resolution, stored):
    """Returns how many voxels along each axis are averaged into one."""
    if resolution != "AUTO":
        return _STEPS[resolution]
    step = 1
    if stored is not None and stored.dims is not None:
        voxels = stored.dims[0] * stored.dims[1] * stored.dims[2]
        while voxels / step**3 > MOST_VOXELS and step < 8:
            step *= 2
    return step


def lines(path, stored, step, crop=None):
    """Returns the facts of a file as lines of text. crop: A Crop, or None."""
    facts = [source_files.format_of(path).name]
    if stored.dims is not None:
        facts.append(iface_("%s voxels, %s") % (_by(stored.dims), stored.dtype.name))
        if stored.voxel_size is not None:
            facts.append(_extent(stored))
        if step > 1:
            facts.append(iface_("Read as %s voxels") % _by(n // step for n in stored.dims))
        memory = stored.bytes(step)
        if crop is not None:
            dims = [max(1, n // step) for n in stored.dims]
            cropped = crop.dims(dims)
            facts.append(iface_("Cropped to %s voxels") % _by(cropped))
            memory *= prod(cropped) / prod(dims)
        facts.append(iface_("Memory: %s") % _megabytes(memory))
    return [*facts, *stored.notes]


def _extent(stored):
    """Returns the size in space as text, with the unit if the file gives one."""
    sides = (max(n - 1, 1) * size for n, size in zip(stored.dims, stored.voxel_size))
    return f"{' x '.join(f'{side:.4g}' for side in sides)} {stored.unit or iface_('(no unit)')}"


def _by(numbers):
    return " x ".join(str(number) for number in numbers)


def _megabytes(count):
    return f"{count / 1e9:.1f} GB" if count >= 1e9 else f"{max(count / 1e6, 0.1):.1f} MB"
