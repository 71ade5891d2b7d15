# SPDX-License-Identifier: GPL-3.0-or-later
"""The faces of a clip box within a volume, with the slices of its data: they close the cut.

A child of the volume's object holds the values at a grid on each face. Its material colors them,
and leaves out what lies outside of the isosurfaces, so that only box and volume make a new mesh.
"""

import bpy
import leaflight
import numpy as np

from .. import versions
from ..store import cache
from . import added, color_maps, display, fill, look, shader

VALUE = "value"
NONE, GRAY = "NONE", "GRAY"
ITEMS = [
    (NONE, "Open", "Leave the cut open"),
    (GRAY, "Gray", "Close it with the slice of the data, from black to white"),
    *((key, name, text) for key, (name, text, _) in color_maps.MAPS.items()),
]

_KIND = "cut"
_SHOWN = "leaflight_shown"
_BUILT = "leaflight_built"
# Nodes along a side of a face at most.
_MOST = 320

# Names of such objects of this file.
_seen = set()


def faces_of(volume):
    """The object of a volume's cut faces, or None."""
    return next((obj for obj in volume.children if display.is_display(obj, _KIND)), None)


def update(volume, depsgraph=None):
    """Shows the cut faces of a volume object as its clip box stands now.

    depsgraph: that has evaluated an animation of the box.
    """
    if volume.library is not None or volume.override_library is not None:
        return
    obj, cut = faces_of(volume), _cut(volume)
    if obj is not None:
        _seen.add(obj.name)
    if cut is None:
        if obj is not None and obj.data.get(_SHOWN):
            obj.data.clear_geometry()
            obj.data[_SHOWN] = ""
        return
    box, owner = cut.box, volume
    if depsgraph is not None:
        box, owner = box.evaluated_get(depsgraph), volume.evaluated_get(depsgraph)
    local_from_box = np.array(owner.matrix_world.inverted_safe() @ box.matrix_world)
    try:
        data = cache.volume_of(volume)
    except leaflight.LeaflightError:
        return
    if obj is None:
        obj = _new(volume)
    corners = np.array((cut.low, cut.high))
    label = f"{local_from_box.round(6).tolist()} {corners.tolist()} {data.name} {data.values.shape}"
    if obj.data.get(_SHOWN) != label:
        _fill(obj.data, data, local_from_box, corners)
        obj.data[_SHOWN] = label
    _shade(obj, volume)


def follow(volumes, depsgraph):
    """update() of volume objects, as an evaluated animation has them."""
    for volume in volumes:
        update(volume, depsgraph)


def left_alone():
    """Those whose volumes are gone."""
    found = (bpy.data.objects.get((name, None)) for name in _seen)
    return [obj for obj in found if obj is not None and obj.parent is None]


def _cut(volume):
    """The shader.Cut of the isosurfaces that are cut, None where the cut is open."""
    if volume.leaflight_look.cut_colors == NONE:
        return None
    cuts = (look.view_of(obj).cut for obj in (volume, *added.added_to(volume)))
    return next((cut for cut in cuts if cut is not None), None)


def _new(volume):
    name = f"{volume.name} Cut"
    obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    display.mark(obj, _KIND)
    obj.parent = volume
    obj.hide_select = True
    # It has the color of the data, and lights nothing.
    obj.visible_diffuse = obj.visible_glossy = obj.visible_shadow = False
    added.link_beside(obj, volume)
    obj.data.materials.append(bpy.data.materials.new(name))
    return obj


def _fill(mesh, data, local_from_box, corners):
    points, quads = _grids(data, local_from_box, corners)
    values = _values(data, points) if len(points) else np.empty(0)
    known = np.isfinite(values)
    quads = quads[known[quads].all(axis=1)] if len(quads) else quads
    if not len(quads):
        mesh.clear_geometry()
        return
    used, quads = np.unique(quads, return_inverse=True)
    fill.fill(mesh, points[used], quads.reshape(-1, 4), {})
    attribute = mesh.attributes.get(VALUE) or mesh.attributes.new(VALUE, "FLOAT", "POINT")
    attribute.data.foreach_set("value", values[used].astype(np.float32))
    mesh.update()


def _values(data, points):
    """Those at points (n, 3), NaN outside; rounding puts none on the border there."""
    low, high = np.asarray(data.field().bounds, np.float64)
    margin = 1e-4 * (high - low)
    within = ((points > low - margin) & (points < high + margin)).all(axis=1)
    values = data.field().sample(np.clip(points, low + 0.01 * margin, high - 0.01 * margin))
    return np.where(within, values, np.nan)


def _grids(data, local_from_box, corners):
    """Nodes (n, 3), in the volume's coordinates, and quads (m, 4) of the faces in the volume."""
    low, high = _within(data, local_from_box, corners)
    voxel = np.linalg.norm(data.index_to_world[:3, :3], axis=0).min()
    points, quads, first = [np.empty((0, 3))], [np.empty((0, 4), np.int64)], 0
    for axis in range(3) if (low < high).all() else ():
        u, v = (axis + 1) % 3, (axis + 2) % 3
        counts = [_nodes(local_from_box[:3, a], high[a] - low[a], voxel) for a in (u, v)]
        for end in range(2):
            place = corners[end, axis]
            if not low[axis] <= place <= high[axis]:
                continue
            at = np.empty((counts[0], counts[1], 3))
            at[..., axis] = place
            at[..., u] = np.linspace(low[u], high[u], counts[0])[:, None]
            at[..., v] = np.linspace(low[v], high[v], counts[1])
            points.append(at.reshape(-1, 3) @ local_from_box[:3, :3].T + local_from_box[:3, 3])
            n = first + np.arange(counts[0] * counts[1]).reshape(counts)
            corner = n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]
            quads.append(np.stack(corner, axis=-1).reshape(-1, 4))
            first += n.size
    return np.concatenate(points), np.concatenate(quads)


def _within(data, local_from_box, corners):
    """Lowest and highest corner, in the box's coordinates, of its part that holds the volume."""
    bounds = np.asarray(data.field().bounds, np.float64)
    ends = np.array([[bounds[i, 0], bounds[j, 1], bounds[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])
    box_from_local = np.linalg.pinv(local_from_box)
    ends = ends @ box_from_local[:3, :3].T + box_from_local[:3, 3]
    return np.maximum(corners[0], ends.min(axis=0)), np.minimum(corners[1], ends.max(axis=0))


def _nodes(direction, length, voxel):
    return int(np.clip(np.linalg.norm(direction) * length / voxel + 1, 2, _MOST))


def _shade(obj, volume):
    settings, chosen = volume.leaflight, volume.leaflight_look.cut_colors
    material = obj.data.materials[0]
    if material.get(_BUILT) != chosen:
        gray = ((0.0,) * 3, (1.0,) * 3)
        colors = gray if chosen == GRAY else color_maps.MAPS[chosen][2]
        versions.do_not_sample_as_light(material)
        shader.build_slice(material, VALUE, colors)
        material[_BUILT] = chosen
    surfaces = (volume, *added.added_to(volume))
    cut = [o.leaflight.isovalue for o in surfaces if look.view_of(o).cut is not None]
    exposure = bpy.context.scene.view_settings.exposure
    shader.set_slice(material, settings.low, settings.high, min(cut), 2.0**-exposure)
