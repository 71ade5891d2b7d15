# SPDX-License-Identifier: GPL-3.0-or-later
"""The points that a stage and its camera are fitted to: isosurfaces as shown, without dust."""

import leaflight._core as _core
import numpy as np

from ..show import added, isosurfaces

# A part of an isosurface counts from this share of its largest part on, in triangles.
_SHARE = 0.1


def shown_points(volumes):
    """World coordinates (n, 3) of the large parts of all isosurfaces that volume objects show.

    A volume that shows nothing counts with the corners of its box. Raises LeaflightError.
    """
    points = []
    for volume in volumes:
        shown = [_large_parts(obj) for obj in (volume, *added.added_to(volume))]
        if not any(map(len, shown)):
            box = isosurfaces.world_box(volume)
            shown = [np.array([[x, y, z] for x in box[:, 0] for y in box[:, 1] for z in box[:, 2]])]
        points += shown
    return np.concatenate(points)


def bounds(points):
    return points.min(axis=0), points.max(axis=0)


def _large_parts(obj):
    mesh = obj.data
    vertices = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", vertices)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    matrix = np.array(obj.matrix_world, np.float64)
    large = in_large_parts(len(mesh.vertices), corners.reshape(-1, 3))
    return vertices.reshape(-1, 3)[large] @ matrix[:3, :3].T + matrix[:3, 3]


def in_large_parts(count, triangles):
    """Whether each of so many vertices is in a large part of a mesh; triangles: (m, 3)."""
    if not len(triangles):
        return np.zeros(count, bool)
    part = _core.connected_parts(triangles, count)
    sizes = np.bincount(part[triangles[:, 0]], minlength=count)
    return sizes[part] >= _SHARE * sizes.max()
