# SPDX-License-Identifier: GPL-3.0-or-later
"""The faces of a clip box within a volume, with the slices of its data: they close the cut."""

import numpy as np
from leaflight import LeaflightError

from ..store import cache
from . import added, data_faces, look

NONE = "NONE"
ITEMS = [
    (NONE, "Open", "Leave the cut open"),
    (data_faces.GRAY, "Gray", "Close it with the slice of the data, from black to white"),
    *data_faces.COLORS[1:],
]

_KIND = "cut"


def faces_of(volume):
    """The object of a volume's cut faces, or None."""
    return data_faces.child(volume, _KIND)


def update(volume, depsgraph=None):
    """Shows the cut faces of a volume object as its clip box stands now.

    depsgraph: that has evaluated an animation of the box.
    """
    if volume.library is not None or volume.override_library is not None:
        return
    obj, cut = faces_of(volume), _cut(volume)
    if cut is None:
        data_faces.clear(obj)
        return
    box, owner = cut.box, volume
    if depsgraph is not None:
        box, owner = box.evaluated_get(depsgraph), volume.evaluated_get(depsgraph)
    local_from_box = np.array(owner.matrix_world.inverted_safe() @ box.matrix_world)
    try:
        data = cache.volume_of(volume)
    except LeaflightError:
        return
    obj = obj or data_faces.new_child(volume, _KIND, "Cut")
    corners = np.array((cut.low, cut.high))
    label = f"{local_from_box.round(6).tolist()} {corners.tolist()}"
    data_faces.show(obj, data, label, _faces(data, local_from_box, corners))
    surfaces = (volume, *added.added_to(volume))
    cuts = [o.leaflight.isovalue for o in surfaces if look.view_of(o).cut is not None]
    data_faces.shade(obj, volume.leaflight_look.cut_colors, volume.leaflight, min(cuts))


def _cut(volume):
    """The shader_graph.Cut of the isosurfaces that are cut, None where the cut is open."""
    if volume.leaflight_look.cut_colors == NONE:
        return None
    cuts = (look.view_of(obj).cut for obj in (volume, *added.added_to(volume)))
    return next((cut for cut in cuts if cut is not None), None)


def _faces(data, local_from_box, corners):
    """The parts within the volume of the box's faces."""
    low, high = _within(data, local_from_box, corners)
    linear, origin = local_from_box[:3, :3], local_from_box[:3, 3]
    found = []
    for axis in range(3) if (low < high).all() else ():
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for place in corners[:, axis]:
            if low[axis] <= place <= high[axis]:
                corner = low.copy()
                corner[axis] = place
                sides = ((high[a] - low[a]) * linear[:, a] for a in (u, v))
                found.append(data_faces.Face(linear @ corner + origin, *sides))
    return found


def _within(data, local_from_box, corners):
    """Lowest and highest corner, in the box's coordinates, of its part that holds the volume."""
    bounds = np.asarray(data.field().bounds, np.float64)
    ends = np.array([[bounds[i, 0], bounds[j, 1], bounds[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])
    box_from_local = np.linalg.pinv(local_from_box)
    ends = ends @ box_from_local[:3, :3].T + box_from_local[:3, 3]
    return np.maximum(corners[0], ends.min(axis=0)), np.minimum(corners[1], ends.max(axis=0))
