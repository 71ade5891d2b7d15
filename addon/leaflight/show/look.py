# SPDX-License-Identifier: GPL-3.0-or-later
"""The display of one isosurface beside its light: opacity, color, gloss and clip box."""

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.scene import ramp_at
from leaflight.volume.backs import MOSTLY, back_shares

from .. import session, versions
from ..store import cache, source_files
from ..translations import iface_
from . import display, isosurface, isosurfaces, shader_graph, texture
from .isosurface import RADIANCE_BACK, TEXTURE

# Note in panels if a color is not the baked one.
NEW_COLOR = "Indirect light still uses the baked color: bake again"
# Note in panels if an isosurface has a color other than its volume's, with which it was baked.
OWN_COLOR = "Indirect light uses the color of the volume"

# Path of the property for keyframes and drivers, from the object.
OPACITY_PATH = "leaflight_look.opacity"

# Albedo of a channel below which the incident light cannot be computed from the radiance.
_DARK = 1e-3

# Relative difference of albedos that the rounding of Blender's properties may cause.
_ALIKE = 1e-5


def view_of(obj):
    """Returns the shader_graph.View of an isosurface."""
    volume = display.volume_object(obj)
    others = (o for o in display.surfaces_of(volume) if o != obj)
    is_glossy = obj.leaflight_look.gloss > 0 and volume.leaflight.isosurface_scattering == "DIFFUSE"
    among = any(map(_is_translucent, others))
    name = TEXTURE if texture.is_colored(volume) else ""
    return shader_graph.View(_is_translucent(obj), among, _cut_of(obj), is_glossy, name)


def _is_translucent(obj):
    return obj.leaflight_look.opacity < 1.0 or versions.is_animated(obj, OPACITY_PATH)


def box_of(obj):
    """Returns the clip box of an isosurface, or None."""
    box = display.volume_object(obj).leaflight_look.box
    # A deleted object is in no scene, but lives on while a property refers to it.
    return box if obj.leaflight_look.is_cut and box is not None and box.users_scene else None


def albedo_at(obj, isovalue):
    """Returns the albedo (r, g, b) of an isosurface: its own, or that of its volume."""
    look = obj.leaflight_look
    if display.is_added(obj) and look.use_color:
        return tuple(look.color)
    return isosurfaces.albedo_at(display.volume_object(obj), isovalue)


def recoloring(obj, isovalue):
    """Returns (factor, offset), each (r, g, b), that give baked radiance the present albedo.

    The incident light stays that of the bake. Light that the surface has reflected before still
    has the baked color. Raises LeaflightError.
    """
    bake, index = isosurface.lit_by(obj)
    baked = bake.scene.isosurfaces[index]
    before = ramp_at(baked.albedo, isovalue)
    factor = np.array(albedo_at(obj, isovalue)) / np.maximum(before, _DARK)
    factor[(before < _DARK) | (np.abs(factor - 1.0) < _ALIKE)] = 1.0
    # The factor must not scale emission, which is independent of the albedo.
    emission = ramp_at(baked.emission, isovalue)
    return tuple(factor), tuple((1.0 - factor) * emission)


def is_in_data(volume, box):
    """True if the data of a volume object are cut by a box, so that the picture need not be.

    The data do not follow an animated box.
    """
    return not _is_animated(box) and any(
        item["on"] and source_files.is_box_cut(item) and item["object"] == box.name
        for item in source_files.regions_of(volume.leaflight)
    )


def _is_animated(box):
    data = box.animation_data
    return data is not None and bool(data.action or data.drivers)


def _cut_of(obj):
    box = box_of(obj)
    if box is None or is_in_data(display.volume_object(obj), box):
        return None
    keeps = display.volume_object(obj).leaflight_look.keep == "INSIDE"
    low, high = bounds_of(box)
    return shader_graph.Cut(box, box.name_full, low, high, keeps)


def bounds_of(box):
    """Returns the lowest and the highest corner (x, y, z) of a clip box in local coordinates."""
    if box.type == "EMPTY":
        size = box.empty_display_size
        return (-size,) * 3, (size,) * 3
    corners = np.array(box.bound_box)
    return tuple(corners.min(axis=0).tolist()), tuple(corners.max(axis=0).tolist())


# Cache: (address of a volume, isovalue) -> share of the isosurface that shows its back.
_shares = session.cache()


def note_on_backs(volume):
    """Returns a sentence for the panel if a bake lacks the visible side, or an empty text."""
    if not volume.leaflight.bake_id or RADIANCE_BACK in volume.data.attributes:
        return ""
    surfaces = display.surfaces_of(volume)
    try:
        data = cache.volume_of(volume)
    except LeaflightError:
        return ""
    if any(_back_share(data, obj.leaflight.isovalue) > MOSTLY for obj in surfaces):
        return iface_(
            "The visible back of this isosurface is not baked: turn on Both Sides and bake again"
        )
    capped = [region.get("object") for region in source_files.capped_cuts(volume.leaflight)]
    boxes = [box for box in map(box_of, surfaces) if box is not None]
    if any(box.name not in capped for box in boxes):
        return iface_(
            "The visible backs at the cut are not baked: turn on Both Sides and bake again"
        )
    return ""


def _back_share(data, isovalue):
    key = id(data), isovalue
    if key not in _shares:
        (_shares[key],) = back_shares(data.data(), data.index_to_world, [isovalue])
    return _shares[key]
