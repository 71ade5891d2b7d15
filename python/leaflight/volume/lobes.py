# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes with lobes of both signs, such as orbitals and potentials.

Isosurfaces of the values without their sign show both lobes at once, each seen from outside.
"""

from dataclasses import replace

import numpy as np

from ..arrays import Array
from .first_isovalue import is_mostly_zero
from .volume import Volume
from .voxels import as_voxels

# Least ratio of the heights of the lobes.
_ALIKE = 0.2


def has_lobes(volume: Volume) -> bool:
    """Returns True if a volume has lobes of both signs and similar height, with 0 between them."""
    low, high = volume.data_range()
    if not low < 0 < high or volume.values.ndim != 3:
        return False
    # Noise around 0 is shallow beside the peaks of an electron density.
    shallow, deep = sorted((-low, high))
    return shallow > _ALIKE * deep and is_mostly_zero(volume)


def without_sign(volume: Volume) -> Volume:
    """Returns the volume with the absolute values."""
    return replace(volume, values=unsigned(volume.values))


def unsigned(values: Array) -> Array:
    """Returns absolute values, in one of VOXEL_TYPES."""
    if values.dtype.kind == "u":
        return values
    # The absolute value of the lowest integer exceeds its type.
    return as_voxels(np.abs(values if values.dtype.kind == "f" else values.astype(np.float32)))
