# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels of Blender's images as linear colors, as Cycles uses them."""

import hashlib
import os

import bpy
import numpy as np
from leaflight import LeaflightError
from leaflight.srgb import linear_from_srgb

from .. import session

# Color spaces in which the values of an 8-bit image are linear.
_LINEAR = {"Linear", "Linear Rec.709", "Non-Color", "Raw"}

# Cache: _key() of an image -> (pixels, their SHA-256).
_pixels = session.cache()


def linear_pixels(what, image):
    """Returns the colors of an image, float32 [row, column, 3], bottom row first.

    what: the user of the image, for errors. Raises LeaflightError.
    """
    _check(what, image)
    key = _key(image)
    if key not in _pixels:
        _forget(image.name_full)
        pixels = _read(what, image)
        _pixels[key] = (pixels, hashlib.sha256(pixels).digest())
    return _pixels[key][0]


def digest(pixels):
    """Returns the SHA-256 of an array, from the cache if the array is that of an image."""
    for known, value in _pixels.values():
        if known is pixels:
            return value
    return hashlib.sha256(np.ascontiguousarray(pixels)).digest()


def _forget(name):
    """Frees the pixels of the image of this full name."""
    for key in [key for key in _pixels if key[0] == name]:
        del _pixels[key]


def _check(what, image):
    if image is None:
        raise LeaflightError(f"{what} has a texture node without an image: open one.")
    if image.source not in {"FILE", "GENERATED"}:
        raise LeaflightError(
            f'{what} uses the image "{image.name}", a {image.source.lower()}, but the bake models '
            "single images: choose one."
        )
    if image.size[0] == 0 or image.size[1] == 0:
        raise LeaflightError(
            f'{what} uses the image "{image.name}", whose file cannot be read: reload it or open '
            "another."
        )
    space = image.colorspace_settings.name
    if not image.is_float and space != "sRGB" and space not in _LINEAR:
        raise LeaflightError(
            f'{what} uses the image "{image.name}" in the color space {space}, which the bake does '
            "not support: set it to sRGB or Non-Color."
        )


def _key(image):
    try:
        changed = os.stat(bpy.path.abspath(image.filepath)).st_mtime_ns if image.filepath else 0
    except OSError:
        changed = 0
    return (
        image.name_full,
        image.filepath,
        changed,
        tuple(image.size),
        image.colorspace_settings.name,
        image.alpha_mode,
        # Only the pixels show that an image was painted or set by a script.
        _few_pixels(image) if image.is_dirty or image.source == "GENERATED" else b"",
    )


def _few_pixels(image):
    return hashlib.sha256(_raw(image)).digest()


def _raw(image):
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels


def _read(what, image):
    width, height = image.size
    raw = _raw(image)
    if raw.size != width * height * image.channels:
        raise LeaflightError(
            f'{what} uses the image "{image.name}", which is incomplete: reload it.'
        )
    raw = raw.reshape(height, width, image.channels)
    colors = raw[..., :3] if image.channels >= 3 else np.repeat(raw[..., :1], 3, axis=2)
    if not image.is_float:
        # Cycles multiplies 8-bit colors by their alpha before it decodes them.
        if image.channels == 4 and image.alpha_mode == "STRAIGHT":
            colors = colors * raw[..., 3:]
        if image.colorspace_settings.name == "sRGB":
            colors = linear_from_srgb(colors)
    if not np.isfinite(colors).all():
        raise LeaflightError(
            f'{what} uses the image "{image.name}", which holds pixels that are not finite '
            "numbers: repair or replace it."
        )
    return np.ascontiguousarray(colors, np.float32)
