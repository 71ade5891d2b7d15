# SPDX-License-Identifier: GPL-3.0-or-later
"""The color bar at the right border of the camera's picture.

Its object is a child of the camera and stores the volume whose colors it shows. Its children are
the numbers and the title.
"""

from contextlib import suppress

import bpy
import numpy as np
from leaflight import LeaflightError
from leaflight.scene.color_bar import color_bar_of
from mathutils import Vector

from . import display, fill, label_parts, shader, texture
from .display import COLOR_BAR, VOLUME

_MATERIAL = "leaflight_color_bar"
# Cycles takes the name "color" for that of volumes.
_COLOR = "bar_color"
# Shares of the picture's height: length and width of the bar, its margin, size of the texts.
_LENGTH, _WIDTH, _MARGIN, _TEXT = 0.5, 0.03, 0.06, 0.03


def add(scene, volume):
    """Adds the color bar to the camera's picture, in place of an earlier one.

    Raises LeaflightError.
    """
    camera = scene.camera
    if camera is None:
        raise LeaflightError("The scene has no camera for the color bar: add one, or use Stage.")
    colors = color_bar_of(texture.local_texture(volume))
    if colors is None:
        raise LeaflightError(
            f'"{volume.name}": its colors have no range for a color bar: choose Color Map, '
            "Gradient or Height as Colors."
        )
    for bar in _bars():
        _fill(bar, None)
        bpy.data.meshes.remove(bar.data)
    material = shader.shared_material(_MATERIAL, "Leaflight Color Bar", _COLOR)
    bar = _object(volume, camera, bpy.data.meshes.new("Color Bar"), material)
    bar[VOLUME] = volume
    low, high = label_parts.picture_corners(scene, camera)
    height = high.y - low.y
    # The bar's own unit is the height of the picture.
    bar.scale = Vector((height,) * 3)
    left = high.x - (_MARGIN + _WIDTH) * height
    bar.location = Vector((left, 0.5 * (low.y + high.y - _LENGTH * height), low.z))
    _fill(bar, colors)


def update(volume):
    """Shows the present colors and numbers of a volume in its color bar, if there is one."""
    for bar in _bars():
        if bar.get(VOLUME) == volume:
            colors = None
            # An unreadable volume shows its error elsewhere.
            with suppress(LeaflightError):
                colors = color_bar_of(texture.local_texture(volume))
            _fill(bar, colors)


def _bars():
    return [obj for obj in bpy.data.objects if display.is_display(obj, COLOR_BAR) and VOLUME in obj]


def _fill(bar, colors):
    """Fills a bar with a ColorBar, or with nothing for None."""
    for text in bar.children:
        # This removes the object, too.
        bpy.data.curves.remove(text.data)
    if colors is None:
        bar.data.clear_geometry()
        return
    heights = _LENGTH * np.array([share for share, _ in colors.stops])
    points = np.zeros((len(heights), 2, 3))
    points[:, 1, 0] = _WIDTH
    points[:, :, 1] = heights[:, None]
    first = 2 * np.arange(len(heights) - 1)[:, None]
    shown = [label_parts.exposed(color) for _, color in colors.stops]
    faces, vertices = first + (0, 1, 3, 2), points.reshape(-1, 3)
    fill.fill(bar.data, vertices, faces, {_COLOR: np.repeat(shown, 2, axis=0)})
    volume = bar[VOLUME]
    for share, words in colors.ticks:
        text = _text(volume, bar, words)
        text.location = Vector((-0.5 * _TEXT, share * _LENGTH, 0.0))
    title = _text(volume, bar, colors.title)
    title.location = Vector((_WIDTH, _LENGTH + 1.7 * _TEXT, 0.0))


def _text(volume, bar, words):
    curve = label_parts.text_curve(words, _TEXT)
    curve.align_x = "RIGHT"
    return _object(volume, bar, curve, label_parts.white_material())


def _object(volume, parent, data, material):
    obj = display.new_display(volume, COLOR_BAR, data.name, data)
    obj.parent = parent
    obj.hide_select = True
    data.materials.append(material)
    return obj
