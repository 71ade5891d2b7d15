# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume whose values color the isosurfaces of another volume."""

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.volume_texture import VolumeTexture, label_colors, texture_of

from .. import session
from ..store import cache
from . import display

# Cache: address of labels -> (labels, their colors).
_colors = session.cache()


def volume_that_colors(obj):
    """Returns the object whose volume colors the isosurfaces of another volume, or None."""
    other = obj.leaflight.texture_volume
    # A deleted object is in no scene, but lives on while a property refers to it.
    is_usable = other is not None and other.users_scene and other.leaflight.is_volume
    return other if is_usable and other != obj else None


def label_of(obj):
    """Returns a text that differs for different textures, or an empty text without one."""
    other = volume_that_colors(obj)
    if other is None:
        return ""
    settings, source = obj.leaflight, other.leaflight
    numbers = f"{settings.texture_low!r} {settings.texture_high!r}"
    chosen = f"{settings.texture_map} {settings.texture_labels} {numbers}"
    part = f"{source.source} {source.frame} {source.channel} {source.bake_id} {source.smooth}"
    place = [round(x, 6) for row in _between(obj, other) for x in row]
    return f"{chosen} {part} {place}"


def world_texture(obj):
    """Returns the VolumeTexture of a volume in world space, or None. Raises LeaflightError."""
    other = volume_that_colors(obj)
    return None if other is None else _texture(obj, other, cache.world_volume(other))


def texture_on(obj, field):
    """Returns the texture for the grids of a volume, and None without one. Raises LeaflightError.

    field: of the volume, in the object's coordinates.
    """
    texture = _local_texture(obj)
    return None if texture is None else texture.core().on(field)


def colors_at(obj, points):
    """Returns the colors (n, 3) at points in the object's coordinates, or None.

    Raises LeaflightError.
    """
    texture = _local_texture(obj)
    return None if texture is None else texture.at(points)


def _local_texture(obj):
    other = volume_that_colors(obj)
    if other is None:
        return None
    volume = cache.volume_of(other)
    index_to_local = _between(obj, other) @ volume.index_to_world
    return _texture(obj, other, cache.placed(volume, index_to_local))


def _between(obj, other):
    """Returns the matrix from the coordinates of the other object to those of the first."""
    matrices = (np.array(one.matrix_world, np.float64) for one in (obj, other))
    to_world, from_other = matrices
    return np.linalg.inv(to_world) @ from_other


def _texture(obj, other, volume):
    settings = obj.leaflight
    try:
        if settings.texture_labels:
            return VolumeTexture((volume,), _colors_of(volume), nearest=True)
        limits = settings.texture_low, settings.texture_high
        return texture_of(volume, settings.texture_map, limits)
    except LeaflightError as error:
        raise LeaflightError(f'"{obj.name}" cannot be colored by "{other.name}": {error}') from None


def _colors_of(volume):
    key = id(volume.values)
    if key not in _colors:
        # Keep the array, so that no other gets its address.
        _colors[key] = volume.values, label_colors(volume.data())
    return _colors[key][1]


def begin(obj):
    """Prepares a volume object as the colors of another: hides it, and returns its data range.

    Its isovalue no longer moves with others, because its isosurfaces are not seen.
    """
    obj.leaflight.linked = False
    obj.hide_render = True
    obj.hide_set(True)
    for added in display.added_to(obj):
        added.hide_render = True
        added.hide_set(True)
    limits = obj.leaflight.id_properties_ui("isovalue").as_dict()
    return limits["min"], limits["max"]
