# SPDX-License-Identifier: GPL-3.0-or-later
"""The volumes whose values color the isosurfaces of another volume."""

from dataclasses import replace

import numpy as np
from leaflight import LeaflightError
from leaflight.scene.volume_texture import check_overlap, label_texture, texture_of

from .. import session, versions
from ..store import cache, frame_bakes
from . import display

# Cache: address of labels -> (labels, their VolumeTexture).
_labels = session.cache()


def volumes_that_color(obj):
    """Returns the objects whose volumes color the isosurfaces of another volume.

    There is one, or three for red, green and blue, or none.
    """
    settings = obj.leaflight
    others = [settings.texture_volume]
    if settings.texture_kind == "CHANNELS":
        others += [settings.texture_green, settings.texture_blue]
    # A deleted object is in no scene, but lives on while a property refers to it.
    usable = [
        other
        for other in others
        if other is not None and other.users_scene and other.leaflight.is_volume and other != obj
    ]
    return usable if len(usable) == len(others) else []


def label_of(obj):
    """Returns a text that differs for different textures, or an empty text without one."""
    others = volumes_that_color(obj)
    if not others:
        return ""
    settings, sources = obj.leaflight, []
    for other in others:
        source = other.leaflight
        place = [round(x, 6) for row in _between(obj, other) for x in row]
        read = f"{source.source} {source.frame} {source.channel} {source.bake_id} {source.smooth}"
        sources.append(f"{read} {_plays(other)} {place}")
    numbers = f"{settings.texture_low!r} {settings.texture_high!r}"
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

    found = _texture(obj, local)
    if found is not None:
        check_overlap(found, cache.volume_of(obj))
    return found


def texture_in_bake(obj):
    """Returns the texture that an object shows now, in the world of its bake, or None.

    Raises LeaflightError.
    """
    colors = local_texture(obj)
    if colors is None:
        return None
    to_world = np.array(obj.leaflight.bake_matrix, np.float64).reshape(4, 4)
    channels = (replace(c, index_to_world=to_world @ c.index_to_world) for c in colors.channels)
    return replace(colors, channels=tuple(channels))


def retextured(bake, textures):
    """Returns a bake for an export, with other textures, {number of a volume: texture or None}."""
    isosurfaces, grids = list(bake.scene.isosurfaces), list(bake.grids)
    for index, colors in textures.items():
        isosurfaces[index] = replace(isosurfaces[index], texture=colors)
        on_field = isosurfaces[index].texture_on(bake.volumes[index].field())
        grids[index] = grids[index].with_texture(on_field)
    return replace(bake, scene=replace(bake.scene, isosurfaces=isosurfaces), grids=grids)


def _between(obj, other):
    """Returns the matrix from the coordinates of the other object to those of the first."""
    to_world, from_other = (np.array(one.matrix_world, np.float64) for one in (obj, other))
    return np.linalg.inv(to_world) @ from_other


def _texture(obj, volume_of):
    """Returns the VolumeTexture of an object, or None. volume_of: function from its others."""
    others, settings = volumes_that_color(obj), obj.leaflight
    if not others:
        return None
    volumes = [volume_of(other) for other in others]
    try:
        _check_frames(settings, others)
        if settings.texture_kind == "LABELS":
            return _label_texture(volumes[0])
        limits = settings.texture_low, settings.texture_high
        return texture_of(volumes, settings.texture_map if len(volumes) == 1 else None, limits)
    except LeaflightError as error:
        names = " and ".join(f'"{other.name}"' for other in others)
        raise LeaflightError(f'"{obj.name}" cannot be colored by {names}: {error}') from None


def _check_frames(settings, others):
    for other in others:
        frames = other.leaflight.frames
        if _plays(other) and settings.frames not in (1, frames):
            raise LeaflightError(
                f"the series has {frames} frames, but this volume has {settings.frames}: choose "
                "one with as many, or delete its keyframes."
            )


def _plays(other):
    return other.leaflight.frames > 1 and versions.is_animated(other, frame_bakes.PATH)


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
