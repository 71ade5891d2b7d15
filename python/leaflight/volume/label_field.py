# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of other values: the boundary of labels, and values without their sign.

The isosurface at one half is the boundary of labels, which are numbers above 0. The boundary is
smooth. It encloses as much volume as the voxels with labels. It lies between the same voxels as
before, so it moves by less than half a voxel.
"""

from dataclasses import replace

import numpy as np

import leaflight._core as _core

from .._core import LeaflightError
from ..arrays import Array
from .first_isovalue import is_mostly_zero
from .label_table import label_numbers
from .memory import as_voxels
from .smoothing import smoothed
from .volume import Volume

# Standard deviation of the Gaussian, in voxels.
_WIDTH = 1.0
# Least distance of the field from one half, at which labels would touch their outside.
_APART = 0.02
# Voxels around labels beyond which the Gaussian is 0.
_MARGIN = 6
# Number of bisections of the offset that keeps the volume, to 1/4096 of the range of the field.
_BISECTIONS = 12


def label_field(values: Array, progress: _core.Progress) -> Array:
    """Returns the field, float32 in 0..1, of labels [z, y, x]. NaN is outside.

    Raises Cancelled, and LeaflightError as label_numbers(), or without labels or anything else.
    """
    label_numbers(values)
    inside = values > 0
    count = int(np.count_nonzero(inside))
    if count in (0, inside.size):
        raise LeaflightError("There are no labels above 0, or nothing around them.")
    box = _box_of(inside)
    inside = inside[box]
    smooth = smoothed(inside.astype(np.float32), _WIDTH, progress)
    low, high = -0.5, 0.5
    progress.begin("Keeping the volume")
    progress.expect(_BISECTIONS)
    for _ in range(_BISECTIONS):
        progress.check()
        progress.advance(1)
        offset = 0.5 * (low + high)
        if _enclosed(_apart(smooth, inside, offset)) < count:
            low = offset
        else:
            high = offset
    offset = 0.5 * (low + high)
    field = np.full(values.shape, np.clip(offset, 0.0, 0.5 - _APART), np.float32)
    field[box] = _apart(smooth, inside, offset)
    return field


def _box_of(inside: Array) -> tuple[slice, ...]:
    """Returns the box of labels and their margin, outside which the field is constant."""
    box = []
    for axis in range(3):
        others = tuple(other for other in range(3) if other != axis)
        places = np.flatnonzero(inside.any(axis=others))
        box.append(slice(max(0, places[0] - _MARGIN), places[-1] + 1 + _MARGIN))
    return tuple(box)


def _apart(smooth: Array, inside: Array, offset: float) -> Array:
    """Returns the field with an offset, on the right side of one half at each voxel."""
    field = np.clip(smooth + np.float32(offset), 0.0, 1.0)
    outside = np.minimum(field, np.float32(0.5 - _APART))
    found: Array = np.where(inside, np.maximum(field, np.float32(0.5 + _APART)), outside)
    return found


def _enclosed(field: Array) -> float:
    """Returns the volume within the isosurface at one half, in voxels. The border closes it."""
    closed = np.pad(field, 1, constant_values=0.0)
    vertices, _, triangles = _core.contour(_core.Field(closed, np.eye(4)), 0.5)
    a, b, c = np.moveaxis(vertices[triangles].astype(np.float64), 1, 0)
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0


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
