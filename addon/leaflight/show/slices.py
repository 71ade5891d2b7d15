# SPDX-License-Identifier: GPL-3.0-or-later
"""Slices of a volume's data: planes across its axes, beside or within its isosurfaces."""

import numpy as np
from leaflight import LeaflightError

from ..store import cache
from . import data_faces

_KIND = "slices"


def slices_of(volume):
    """The object of a volume's slices, or None."""
    return data_faces.child(volume, _KIND)


def update(volume, depsgraph=None):
    """Shows the slices of a volume object; depsgraph: that has evaluated their animation."""
    if volume.library is not None or volume.override_library is not None:
        return
    owner = volume if depsgraph is None else volume.evaluated_get(depsgraph)
    look, obj = owner.leaflight_look, slices_of(volume)
    places = {axis: look.slice_places[axis] for axis in range(3) if look.slice_axes[axis]}
    if not places:
        data_faces.clear(obj)
        return
    try:
        data = cache.volume_of(volume)
    except LeaflightError:
        return
    obj = obj or data_faces.new_child(volume, _KIND, "Slices")
    low, high = np.asarray(data.field().bounds, np.float64)
    faces = [_face(low, high, axis, place) for axis, place in places.items()]
    data_faces.show(obj, data, f"{places}", faces)
    settings = volume.leaflight
    least = settings.isovalue if look.slices_inside else settings.low
    data_faces.shade(obj, look.slice_colors, settings, least)


def position(volume, axis):
    """The place of a slice in the coordinates of the file. Raises LeaflightError."""
    low, high = np.asarray(cache.volume_of(volume).field().bounds, np.float64)[:, axis]
    low, high = (end + volume.leaflight.origin[axis] for end in (low, high))
    return low + volume.leaflight_look.slice_places[axis] * (high - low)


def _face(low, high, axis, place):
    """Across an axis, at a share of the volume's length."""
    corner, sides = low.copy(), np.diag(high - low)
    corner[axis] += place * (high - low)[axis]
    return data_faces.Face(corner, sides[(axis + 1) % 3], sides[(axis + 2) % 3])
