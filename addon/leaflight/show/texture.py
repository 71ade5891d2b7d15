# SPDX-License-Identifier: GPL-3.0-or-later
"""The volumes whose values color the isosurfaces of another volume, or of themselves."""

from dataclasses import replace

import numpy as np
from leaflight import LeaflightError, gradient_of, height_of
from leaflight.scene.volume_texture import (
    check_overlap,
    label_texture,
    picture_stops,
    range_of,
    texture_of,
)
from leaflight.volume.label_table import without_labels

from .. import session, versions
from ..store import cache, frame_bakes, source_files
from . import display, fill

# Cache: full name of an object -> (values of its label map, hidden labels, VolumeTexture).
_labels = session.cache()
# Cache: (address of values, unit, place, name) -> (values, the Volume computed from them).
_derived = session.cache()

# Kinds of colors that need no other volume.
OWN = ("GRADIENT", "HEIGHT", "SLICES")
# Largest number of volumes in it. Playback loads many frames.
_MOST = 4
# Digits of a voxel's size that are the same before and after a bake.
_DIGITS = 8


def volumes_that_color(obj):
    """Returns the objects whose volumes color the isosurfaces of another volume."""
    return [other for other in _colors(obj) if other is not None]


def _colors(obj):
    """Returns an object, or three for red, green and blue of which None is black, or none."""
    settings = obj.leaflight
    if settings.texture_kind in OWN:
        return []
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


def is_colored(obj):
    """True if the isosurfaces of a volume object have a texture."""
    settings = obj.leaflight
    if settings.texture_kind == "SLICES":
        return bool(source_files.capped_cuts(settings))
    return settings.texture_kind in OWN or bool(volumes_that_color(obj))


def label_of(obj):
    """Returns a text that differs for different textures, or an empty text without one."""
    if not is_colored(obj):
        return ""
    others = _colors(obj)
    settings, sources = obj.leaflight, []
    for other in others:
        if other is None:
            sources.append("black")
            continue
        source = other.leaflight
        place = [round(x, 6) for row in _between(obj, other) for x in row]
        read = f"{source.source} {source.frame} {source.channel} {source.bake_id} {source.smooth}"
        sources.append(f"{read} {_plays(other)} {place}")
    if settings.texture_kind == "HEIGHT":
        sources.append(f"{_up(obj).round(6).tolist()}")
    if settings.texture_kind == "SLICES":
        sources.append(f"{settings.source} {settings.regions}")
    numbers = f"{settings.texture_low!r} {settings.texture_high!r} {settings.texture_srgb}"
    numbers += f" {_options(settings)}"
    label = f"{settings.texture_map} {settings.texture_kind} {numbers} {sources}"
    colors = _colors_of_labels(others[0]) if settings.texture_kind == "LABELS" else {}
    return f"{label} {hash(tuple(colors.items()))}" if colors else label


def world_texture(obj):
    """Returns the VolumeTexture of a volume in world space, or None. Raises LeaflightError."""
    to_world = np.array(obj.matrix_world, np.float64)
    return _texture(obj, cache.world_volume, to_world)


def local_texture(obj):
    """Returns the VolumeTexture of a volume in the object's coordinates, or None.

    The result works in any thread. Raises LeaflightError.
    """

    def local(other):
        volume = cache.volume_of(other)
        return cache.placed(volume, _between(obj, other) @ volume.index_to_world)

    found = _texture(obj, local, np.eye(4))
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


def _texture(obj, volume_of, to_place):
    """Returns the VolumeTexture of an object, or None.

    volume_of: function from its others. to_place: matrix (4, 4) from the coordinates of the object.
    """
    settings = obj.leaflight
    if not is_colored(obj):
        return None
    if settings.texture_kind in OWN:
        own = own_volume(obj)
        volumes = [cache.placed(own, to_place @ own.index_to_world)]
    else:
        # Color bars and captions show the names of the objects.
        volumes = [other and replace(volume_of(other), name=other.name) for other in _colors(obj)]
    if None in volumes:
        volumes = _with_black(volumes, settings.texture_low)
    try:
        _check_frames(settings, volumes_that_color(obj))
        if settings.texture_kind == "LABELS":
            return _label_texture(obj, volumes[0], _colors_of_labels(_colors(obj)[0]))
        limits = settings.texture_low, settings.texture_high
        if len(volumes) == 3 and settings.texture_srgb:
            return texture_of(volumes, picture_stops(*limits))
        colors = settings.texture_map if len(volumes) == 1 else None
        return texture_of(volumes, colors, limits, **_options(settings))
    except LeaflightError as error:
        names = " and ".join(f'"{other.name}"' for other in volumes_that_color(obj) or [obj])
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


def _with_black(volumes, low):
    """Returns volumes with the lowest value of the colors in place of None."""
    one = next(volume for volume in volumes if volume is not None)
    black = replace(one, values=np.full(one.values.shape, low, np.float32))
    return [black if volume is None else volume for volume in volumes]


def _options(settings):
    """Returns the options of texture_of()."""
    return {
        "reverse": settings.texture_reverse,
        "symmetric": settings.texture_symmetric,
        "steps": settings.texture_steps,
    }


def own_volume(obj):
    """Returns the gradient, the height or the slices of a volume, in the object's coordinates.

    Heights are in the coordinates of the file. Raises LeaflightError.
    """
    settings = obj.leaflight
    if settings.texture_kind == "SLICES":
        return replace(cache.slices_of(obj), name=obj.name)
    volume = cache.volume_of(obj)
    is_height = settings.texture_kind == "HEIGHT"
    up, origin = _up(obj), np.array(settings.origin, np.float64)
    place = f"{up.tolist()} {origin.tolist()}" if is_height else ""
    key = id(volume.values), f"{settings.unit} {place} {obj.name}"
    if key not in _derived:
        matrix = _rounded(volume.index_to_world)
        local = replace(volume, index_to_world=matrix, unit=settings.unit, name=obj.name)
        made = height_of(local, up) if is_height else gradient_of(local)
        if is_height:
            made = replace(made, values=made.values + np.float32(up @ origin))
        if len(_derived) >= _MOST:
            _derived.pop(next(iter(_derived)))
        # Keep the array, so that no other gets its address.
        _derived[key] = volume.values, made
    return _derived[key][1]


def own_range(obj):
    """Returns the values at the ends of a color map of own_volume(). Raises LeaflightError."""
    if obj.leaflight.texture_kind == "SLICES":
        return obj.leaflight.low, obj.leaflight.high
    return range_of(own_volume(obj))


def _up(obj):
    """Returns the unit vector that points up in the scene, in the coordinates of the object."""
    up = np.array(obj.matrix_world, np.float64)[2, :3]
    return up / np.linalg.norm(up)


def _rounded(matrix):
    """Returns a matrix without the rounding that differs before and after a bake."""
    digits = _DIGITS - int(np.ceil(np.log10(np.abs(matrix[:3, :3]).max())))
    return np.round(matrix, digits)


def _label_texture(obj, volume, colors):
    """Returns the texture of a label map without the hidden labels of the object that it colors."""
    hide = obj.leaflight.hide
    values, hidden, found = _labels.get(obj.name_full, (None, None, None))
    if values is not volume.values or hidden != hide:
        shown = without_labels(volume.values, map(int, hide.split())) if hide else volume.values
        found = label_texture(replace(volume, values=shown))
        _labels[obj.name_full] = volume.values, hide, found
    channel = replace(found.channels[0], index_to_world=volume.index_to_world)
    stops = sorted({**dict(found.colors), **colors}.items())
    return replace(found, channels=(channel,), colors=stops)


def _colors_of_labels(label_map):
    """Returns {number: color} of the list of labels of an object."""
    labels = label_map.leaflight.labels
    numbers = fill.read(labels, "number", np.int32)
    colors = fill.read(labels, "color", np.float32, 3)
    return dict(zip(map(float, numbers), map(tuple, colors.tolist())))


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
