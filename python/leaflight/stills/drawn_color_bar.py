# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the color bar of a texture into a picture."""

from typing import Any

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Bake
from ..io.images import display_colors
from ..scene.color_bar import ColorBar, color_bar_of

# Sizes as shares of the picture's height: of the bar, of texts, and of the space around them.
_LENGTH, _WIDTH, _TEXT, _SPACE = 0.45, 0.03, 0.032, 0.02
_BACKGROUND, _WHITE = (21, 23, 26, 176), (255, 255, 255, 255)
# Fonts of Linux, Windows and macOS, for Pillow before 10.1, which has none of every size.
_FONTS = ("DejaVuSans.ttf", "arial.ttf", "Arial.ttf")


def bar_of_bake(bake: Bake) -> ColorBar:
    """Returns the color bar of the first volume that has one. Raises LeaflightError."""
    bars = (color_bar_of(isosurfaces.texture) for isosurfaces in bake.scene.isosurfaces)
    found = next((bar for bar in bars if bar is not None), None)
    if found is None:
        raise LeaflightError(
            "There is no color bar, because no volume is colored by a range of values: leave it "
            "out, or bake with such colors."
        )
    return found


def with_color_bar(pixels: Array, bar: ColorBar) -> Array:
    """Returns a picture uint8 [row, column, RGBA] with a color bar at its right border."""
    from PIL import Image, ImageDraw

    height, width = pixels.shape[:2]
    unit = float(height)
    font, space = _font(max(8, round(_TEXT * unit))), round(_SPACE * unit)
    texts = [text for _, text in bar.ticks]
    size = max(1, round(_WIDTH * unit)), max(2, round(_LENGTH * unit))
    line = _extent(font, "0")[1] + space
    numbers = max(_extent(font, text)[0] for text in texts)
    inner = max(numbers + space + size[0], _extent(font, bar.title)[0])
    right, top = width - 2 * space, (height - size[1]) // 2
    layer = Image.new("RGBA", (width, height), (0, 0, 0, 0))
    draw = ImageDraw.Draw(layer)
    box = right - inner - space, top - 2 * line, right + space, top + size[1] + line
    draw.rounded_rectangle(box, radius=space / 2, fill=_BACKGROUND)
    strip = Image.fromarray(_strip(bar, size[1], size[0]))
    layer.paste(strip, (right - size[0], top))
    _write(draw, bar.title, (right - inner, top - 1.5 * line), font, middle=False)
    for share, text in bar.ticks:
        place = right - size[0] - space, top + (1.0 - share) * size[1]
        _write(draw, text, (place[0] - _extent(font, text)[0], place[1]), font)
    return np.asarray(Image.alpha_composite(Image.fromarray(pixels), layer))


def _strip(bar: ColorBar, length: int, width: int) -> Array:
    """Returns the colors uint8 [row, column, RGB], those of high values first."""
    places = 1.0 - (np.arange(length) + 0.5) / length
    shares = [share for share, _ in bar.stops]
    channels = [np.interp(places, shares, c) for c in np.transpose([c for _, c in bar.stops])]
    colors = display_colors(np.transpose(channels), 1.0)
    return np.ascontiguousarray(np.broadcast_to(colors[:, None], (length, width, 3)))


def _font(size: int) -> Any:
    from PIL import ImageFont

    for name in _FONTS:
        try:
            return ImageFont.truetype(name, size)
        except (OSError, ImportError):
            continue
    try:
        return ImageFont.load_default(size)
    except TypeError:
        return ImageFont.load_default()


def _extent(font: Any, text: str) -> tuple[int, int]:
    """Returns the width and the height of a text in pixels."""
    left, top, right, bottom = font.getbbox(_writable(font, text))
    return int(right - left), int(bottom - top)


def _writable(font: Any, text: str) -> str:
    """Returns the text without letters that a font without outlines lacks."""
    return text if hasattr(font, "path") else text.encode("latin-1", "replace").decode("latin-1")


def _write(
    draw: Any, text: str, place: tuple[float, float], font: Any, middle: bool = True
) -> None:
    """Writes a text from its left end, with its middle or its top at the height of the place."""
    text = _writable(font, text)
    _, top, _, bottom = font.getbbox(text)
    lift = 0.5 * (top + bottom) if middle else top
    draw.text((place[0], place[1] - lift), text, fill=_WHITE, font=font)
