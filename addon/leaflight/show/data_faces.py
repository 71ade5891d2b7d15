# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane faces within a volume, colored by its values: those of a cut, and slices.

A child of the volume's object holds the values at a grid on each face. Its material colors them and
leaves out values below an isovalue, so that neither new colors nor a new isovalue make a new mesh.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from .. import session, versions
from . import added, color_maps, display, fill, shader

VALUE = "value"
GRAY = "GRAY"
COLORS = [
    (GRAY, "Gray", "From black to white"),
    *((key, name, text) for key, (name, text, _) in color_maps.MAPS.items()),
]

_SHOWN = "leaflight_shown"
_BUILT = "leaflight_built"
# Nodes along a side of a face at most.
_MOST = 320

# Names of such objects of this file.
_seen = session.remembered(set)


@dataclass(frozen=True)
class Face:
    """A parallelogram in the volume's coordinates: a corner (3,), and the sides from it."""

    corner: np.ndarray
    u: np.ndarray
    v: np.ndarray


def child(volume, kind):
    """The object of a volume's faces of this kind, or None."""
    obj = next((obj for obj in volume.children if display.is_display(obj, kind)), None)
    if obj is not None:
        _seen.add(obj.name)
    return obj


def new_child(volume, kind, title):
    name = f"{volume.name} {title}"
    obj = added.new_display(volume, kind, name, bpy.data.meshes.new(name))
    obj.parent = volume
    obj.hide_select = True
    obj.data.materials.append(bpy.data.materials.new(name))
    _seen.add(obj.name)
    return obj


def left_alone():
    """Those whose volumes are gone."""
    found = (bpy.data.objects.get((name, None)) for name in _seen)
    return [obj for obj in found if obj is not None and obj.parent is None]


def clear(obj):
    """Shows nothing in the object of child(), which may be None."""
    if obj is not None and obj.data.get(_SHOWN):
        obj.data.clear_geometry()
        obj.data[_SHOWN] = ""


def show(obj, data, label, faces):
    """Fills the object with Faces of a Volume; label: a text that differs where they do."""
    label = f"{label} {data.name} {data.values.shape}"
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
    """Colors the values of the volume's range, by a key of COLORS, from an isovalue on."""
    material = obj.data.materials[0]
    if material.get(_BUILT) != colors:
        chosen = color_maps.GRAY if colors == GRAY else color_maps.MAPS[colors][2]
        versions.do_not_sample_as_light(material)
        shader.build_slice(material, VALUE, chosen)
        material[_BUILT] = colors
    exposure = bpy.context.scene.view_settings.exposure
    shader.set_slice(material, settings.low, settings.high, isovalue, 2.0**-exposure)


def _grids(data, faces):
    """Nodes (n, 3) and quads (m, 4) of Faces, about as fine as the voxels."""
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
    """Those at points (n, 3), NaN outside; rounding puts none on the border there."""
    low, high = np.asarray(data.field().bounds, np.float64)
    margin = 1e-4 * (high - low)
    within = ((points > low - margin) & (points < high + margin)).all(axis=1)
    values = data.field().sample(np.clip(points, low + 0.01 * margin, high - 0.01 * margin))
    return np.where(within, values, np.nan)
