# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane faces within a volume, colored by its values.

They are the faces of a clip box, which close the cut, and slices across the volume's axes. A child
of the volume's object holds the values at a grid on each face. Its material colors them and hides
values below an isovalue. New colors or a new isovalue therefore need no new mesh.
"""

from dataclasses import dataclass

import bpy
import numpy as np
from leaflight import LeaflightError, color_maps
from mathutils import Color

from .. import versions
from ..store import cache, source_files
from . import display, exploded, fill, look, shader, surface_object


def _linear(hexadecimal):
    color = Color(byte / 255 for byte in bytes.fromhex(hexadecimal))
    return tuple(color.from_srgb_to_scene_linear())


# Colors from black to white in perceptually even steps.
_GRAYS = tuple(_linear(3 * f"{round(255 * i / 8):02x}") for i in range(9))
# Color maps: key -> (name, description, nine evenly spaced colors).
MAPS = {
    key: (name, text, tuple(map(_linear, colors)))
    for key, (name, text, colors) in color_maps.MAPS.items()
}


VALUE = "value"
GRAY = "GRAY"
COLORS = [
    (GRAY, "Gray", "Black to white"),
    *((key, name, text) for key, (name, text, _) in MAPS.items()),
]

_SHOWN = "leaflight_shown"
_BUILT = "leaflight_built"
# Largest number of nodes along a side of a face.
_MOST = 320


@dataclass(frozen=True)
class Face:
    """A parallelogram in the volume's coordinates: a corner (3,), and the sides from it."""

    corner: np.ndarray
    u: np.ndarray
    v: np.ndarray


def child(volume, kind):
    """Returns the object of a volume's faces of this kind, or None."""
    found = [obj for obj in volume.children if display.is_display(obj, kind)]
    display.note(found)
    return next(iter(found), None)


def new_child(volume, kind, title):
    name = f"{volume.name} {title}"
    obj = display.new_display(volume, kind, name, bpy.data.meshes.new(name))
    obj.parent = volume
    obj.hide_select = True
    obj.data.materials.append(bpy.data.materials.new(name))
    display.note([obj])
    return obj


def clear(obj):
    """Removes the geometry of an object of child(), which may be None."""
    if obj is not None and obj.data.get(_SHOWN):
        obj.data.clear_geometry()
        obj.data[_SHOWN] = ""


def show(obj, data, label, faces):
    """Fills the object with Faces of a Volume. label: a text that is unique to the faces."""
    settings = obj.parent.leaflight
    values = f"{settings.frame} {settings.bake_id} {source_files.changes_of(settings)}"
    label = f"{label} {data.name} {data.values.shape} {values}"
    if obj.data.get(_SHOWN) == label:
        return
    obj.data[_SHOWN] = label
    points, quads = _grids(data, faces)
    values = _values(data, points) if len(points) else np.empty(0)
    known = np.isfinite(values)
    quads = quads[known[quads].all(axis=1)] if len(quads) else quads
    if not len(quads):
        obj.data.clear_geometry()
        return
    used, quads = np.unique(quads, return_inverse=True)
    fill.fill(obj.data, points[used], quads.reshape(-1, 4), {})
    attribute = obj.data.attributes.get(VALUE) or obj.data.attributes.new(VALUE, "FLOAT", "POINT")
    attribute.data.foreach_set("value", values[used].astype(np.float32))
    obj.data.update()


def shade(obj, colors, settings, isovalue):
    """Colors the values from an isovalue up. colors: a key of COLORS, over the volume's range."""
    material = obj.data.materials[0]
    if material.get(_BUILT) != colors:
        chosen = _GRAYS if colors == GRAY else MAPS[colors][2]
        versions.do_not_sample_as_light(material)
        shader.build_slice(material, VALUE, chosen)
        material[_BUILT] = colors
    exposure = bpy.context.scene.view_settings.exposure
    shader.set_slice(material, settings.low, settings.high, isovalue, 2.0**-exposure)


def _grids(data, faces):
    """Returns nodes (n, 3) and quads (m, 4) of Faces, about as fine as the voxels."""
    voxel = np.linalg.norm(data.index_to_world[:3, :3], axis=0).min()
    points, quads, first = [np.empty((0, 3))], [np.empty((0, 4), np.int64)], 0
    for face in faces:
        counts = [
            int(np.clip(np.linalg.norm(side) / voxel + 1, 2, _MOST)) for side in (face.u, face.v)
        ]
        s, t = (np.linspace(0.0, 1.0, count) for count in counts)
        at = face.corner + s[:, None, None] * face.u + t[:, None] * face.v
        points.append(at.reshape(-1, 3))
        n = first + np.arange(counts[0] * counts[1]).reshape(counts)
        corner = n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]
        quads.append(np.stack(corner, axis=-1).reshape(-1, 4))
        first += n.size
    return np.concatenate(points), np.concatenate(quads)


def _values(data, points):
    """Returns the values at points (n, 3), NaN outside the volume.

    A margin counts points on the border as inside in spite of rounding.
    """
    low, high = np.asarray(data.field().bounds, np.float64)
    margin = 1e-4 * (high - low)
    within = ((points > low - margin) & (points < high + margin)).all(axis=1)
    values = data.field().sample(np.clip(points, low + 0.01 * margin, high - 0.01 * margin))
    return np.where(within, values, np.nan)


OPEN = "NONE"
CUT_COLORS = [
    (OPEN, "Open", "Open cut"),
    (GRAY, "Gray", "Slice of the data, from black to white"),
    *COLORS[1:],
]

_CUT = "cut"


def cut_faces_of(volume):
    """Returns the object of a volume's cut faces, or None."""
    return child(volume, _CUT)


def update_cut(volume, depsgraph=None):
    """Shows the cut faces of a volume object at the present place of its clip box.

    depsgraph: the one that has evaluated an animation of the box, or None.
    """
    if volume.library is not None or volume.override_library is not None:
        return
    obj, cut = cut_faces_of(volume), _cut_of(volume)
    if cut is None:
        clear(obj)
        return
    box, owner = cut.box, volume
    if depsgraph is not None:
        box, owner = box.evaluated_get(depsgraph), volume.evaluated_get(depsgraph)
    local_from_box = np.array(owner.matrix_world.inverted_safe() @ box.matrix_world)
    try:
        data = cache.volume_of(volume)
    except LeaflightError:
        return
    obj = obj or new_child(volume, _CUT, "Cut")
    corners = np.array((cut.low, cut.high))
    label = f"{local_from_box.round(6).tolist()} {corners.tolist()}"
    show(obj, data, label, _cut_faces(data, local_from_box, corners))
    surfaces = display.surfaces_of(volume)
    # In a render the isovalue of the original lags behind.
    cuts = [surface_object.shown_isovalue(o) for o in surfaces if look.view_of(o).cut is not None]
    shade(obj, volume.leaflight_look.cut_colors, volume.leaflight, min(cuts))


def _cut_of(volume):
    """Returns the shader_graph.Cut of the isosurfaces, None without a cut or if it stays open."""
    # A face would stay where its part was.
    is_exploded = exploded.axis_of(volume) is not None
    if is_exploded or volume.leaflight_look.cut_colors == OPEN:
        return None
    cuts = (look.view_of(obj).cut for obj in display.surfaces_of(volume))
    return next((cut for cut in cuts if cut is not None), None)


def _cut_faces(data, local_from_box, corners):
    """Returns the parts of the box's faces that lie within the volume."""
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
                found.append(Face(linear @ corner + origin, *sides))
    return found


def _within(data, local_from_box, corners):
    """Returns the lowest and highest corner of the volume's bounds within the box.

    They are in the box's coordinates.
    """
    bounds = np.asarray(data.field().bounds, np.float64)
    ends = np.array([[bounds[i, 0], bounds[j, 1], bounds[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])
    box_from_local = np.linalg.pinv(local_from_box)
    ends = ends @ box_from_local[:3, :3].T + box_from_local[:3, 3]
    return np.maximum(corners[0], ends.min(axis=0)), np.minimum(corners[1], ends.max(axis=0))


_SLICES = "slices"


def slices_of(volume):
    """Returns the object of a volume's slices, or None."""
    return child(volume, _SLICES)


def update_slices(volume, depsgraph=None):
    """Shows the slices of a volume object.

    depsgraph: the one that has evaluated their animation, or None.
    """
    if volume.library is not None or volume.override_library is not None:
        return
    owner = volume if depsgraph is None else volume.evaluated_get(depsgraph)
    wanted, obj = owner.leaflight_look, slices_of(volume)
    places = {axis: wanted.slice_places[axis] for axis in range(3) if wanted.slice_axes[axis]}
    if not places:
        clear(obj)
        return
    try:
        data = cache.volume_of(volume)
    except LeaflightError:
        return
    obj = obj or new_child(volume, _SLICES, "Slices")
    low, high = np.asarray(data.field().bounds, np.float64)
    faces = [_slice(low, high, axis, place) for axis, place in places.items()]
    show(obj, data, f"{places}", faces)
    settings = volume.leaflight
    least = surface_object.shown_isovalue(volume) if wanted.slices_inside else settings.low
    shade(obj, wanted.slice_colors, settings, least)


def slice_position(volume, axis):
    """Returns the position of a slice in the coordinates of the file. Raises LeaflightError."""
    low, high = np.asarray(cache.volume_of(volume).field().bounds, np.float64)[:, axis]
    low, high = (end + volume.leaflight.origin[axis] for end in (low, high))
    return low + volume.leaflight_look.slice_places[axis] * (high - low)


def _slice(low, high, axis, place):
    """Returns the Face across an axis, at a share of the volume's length."""
    corner, sides = low.copy(), np.diag(high - low)
    corner[axis] += place * (high - low)[axis]
    return Face(corner, sides[(axis + 1) % 3], sides[(axis + 2) % 3])
