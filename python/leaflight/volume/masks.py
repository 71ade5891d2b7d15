# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks: a volume that keeps its values only within labels of another volume.

The values fade to their lowest one across the boundary of the labels, where half of their height is
left. So isosurfaces are closed and as smooth as those of label_field(). With a sharp mask they
would have steps of a voxel.
"""

from collections.abc import Sequence

import numpy as np

import leaflight._core as _core

from .._core import LeaflightError
from ..arrays import Array
from .cuts import trimmed
from .label_field import label_field
from .label_table import label_numbers
from .memory import as_voxels, new_voxels
from .volume import Volume


def masked(
    volume: Volume, label_map: Volume, labels: Sequence[int], progress: _core.Progress
) -> Volume:
    """Returns the volume within labels, float32. World coordinates place the label map.

    labels: Their numbers; none are all above 0.
    Raises Cancelled, and LeaflightError without such labels, or if nothing is left.
    """
    shares = _core.Field(_shares(label_map, labels, progress), np.eye(4))
    to_map = np.linalg.inv(label_map.in_unit(volume.unit).index_to_world) @ volume.index_to_world
    # Without rounding, nodes on the border of an equal lattice might lie outside it.
    to_map = np.round(to_map, 9)
    low, shape = volume.data_range()[0], volume.values.shape
    values, is_anywhere = new_voxels(shape, np.float32), False
    y, x = np.mgrid[: shape[1], : shape[2]]
    for k, plane in enumerate(volume.values):
        progress.check()
        points = np.stack([x, y, np.full_like(x, k)], axis=-1) @ to_map[:3, :3].T + to_map[:3, 3]
        share = np.nan_to_num(shares.sample(points.reshape(-1, 3))).reshape(x.shape)
        values[k] = low + (as_voxels(plane) - np.float32(low)) * share
        is_anywhere |= bool((share >= 0.5).any())
    above = float(np.nextafter(np.float32(low), np.float32(np.inf)))
    if not is_anywhere or not any((plane >= above).any() for plane in values):
        raise LeaflightError(
            f"{volume.source or volume.name}: nothing of the volume is within the labels of "
            f"{label_map.source or label_map.name}: choose a label map in the same coordinates."
        )
    return volume.cropped(*trimmed(values, above))


def _shares(label_map: Volume, labels: Sequence[int], progress: _core.Progress) -> Array:
    """Returns the shares of the values that are left: 1 within labels, 0 outside."""
    name, known = label_map.source or label_map.name, label_numbers(label_map.values)
    for label in labels:
        if label not in known:
            some = ", ".join(map(str, known[:8])) + (", ..." if len(known) > 8 else "")
            raise LeaflightError(f"{name}: there is no label {label}: choose among {some or 0}.")
    inside = np.isin(label_map.values, labels) if labels else label_map.values > 0
    field = label_field(inside.view(np.uint8), progress)
    # The field of thin labels reaches neither 0 nor 1.
    shares: Array = np.interp(field, (field.min(), 0.5, field.max()), (0.0, 0.5, 1.0))
    return shares.astype(np.float32)
