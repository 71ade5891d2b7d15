# SPDX-License-Identifier: GPL-3.0-or-later
"""The volumes whose values color the isosurfaces of another volume."""

from dataclasses import replace

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.volume_texture import label_texture, picture_stops, texture_of

from .. import session
from ..store import cache
from . import display

# Cache: address of labels -> (labels, their VolumeTexture).
_labels = session.cache()


def volumes_that_color(obj):
    """Returns the objects whose volumes color the isosurfaces of another volume."""
    return [other for other in _colors(obj) if other is not None]


def _colors(obj):
    """Returns an object, or three for red, green and blue of which None is black, or none."""
    settings = obj.leaflight
    others, needed = [settings.texture_volume], 1
    if settings.texture_kind == "CHANNELS":
        others, needed = [*others, settings.texture_green, settings.texture_blue], 2
    # A deleted object is in no scene, but lives on while a property refers to it.
    usable = [
        other
        if other is not None and other.users_scene and other.leaflight.is_volume and other != obj
        else None
        for other in others
    ]
    return usable if len(usable) - usable.count(None) >= needed else []


def label_of(obj):
    """Returns a text that differs for different textures, or an empty text without one."""
    others = _colors(obj)
    if not others:
        return ""
    settings, sources = obj.leaflight, []
    for other in others:
        if other is None:
            sources.append("black")
            continue
        source = other.leaflight
        place = [round(x, 6) for row in _between(obj, other) for x in row]
        read = f"{source.source} {source.frame} {source.channel} {source.bake_id} {source.smooth}"
        sources.append(f"{read} {place}")
    numbers = f"{settings.texture_low!r} {settings.texture_high!r} {settings.texture_srgb}"
    return f"{settings.texture_map} {settings.texture_kind} {numbers} {sources}"


def world_texture(obj):
    """Returns the VolumeTexture of a volume in world space, or None. Raises LeaflightError."""
    return _texture(obj, cache.world_volume)


def local_texture(obj):
    """Returns the VolumeTexture of a volume in the object's coordinates, or None.

    The result works in any thread. Raises LeaflightError.
    """

    def local(other):
        volume = cache.volume_of(other)
        return cache.placed(volume, _between(obj, other) @ volume.index_to_world)

    return _texture(obj, local)


def _between(obj, other):
    """Returns the matrix from the coordinates of the other object to those of the first."""
    to_world, from_other = (np.array(one.matrix_world, np.float64) for one in (obj, other))
    return np.linalg.inv(to_world) @ from_other


def _texture(obj, volume_of):
    """Returns the VolumeTexture of an object, or None. volume_of: function from its others."""
    others, settings = volumes_that_color(obj), obj.leaflight
    if not others:
        return None
    volumes = [None if other is None else volume_of(other) for other in _colors(obj)]
    if None in volumes:
        volumes = _with_black(volumes, settings.texture_low)
    try:
        if settings.texture_kind == "LABELS":
            return _label_texture(volumes[0])
        limits = settings.texture_low, settings.texture_high
        if len(volumes) == 3 and settings.texture_srgb:
            return texture_of(volumes, picture_stops(*limits))
        return texture_of(volumes, settings.texture_map if len(volumes) == 1 else None, limits)
    except LeaflightError as error:
        names = " and ".join(f'"{other.name}"' for other in others)
        raise LeaflightError(f'"{obj.name}" cannot be colored by {names}: {error}') from None


def _with_black(volumes, low):
    """Returns volumes with the lowest value of the colors in place of None."""
    one = next(volume for volume in volumes if volume is not None)
    black = replace(one, values=np.full(one.values.shape, low, np.float32))
    return [black if volume is None else volume for volume in volumes]


def _label_texture(volume):
    key = id(volume.values)
    if key not in _labels:
        # Keep the array, so that no other gets its address.
        _labels[key] = volume.values, label_texture(volume)
    found = _labels[key][1]
    channel = replace(found.channels[0], index_to_world=volume.index_to_world)
    return replace(found, channels=(channel,))


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
