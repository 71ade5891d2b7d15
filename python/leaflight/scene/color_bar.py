# SPDX-License-Identifier: GPL-3.0-or-later
"""The color bar of a texture: its colors, its numbers, and its title."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from .scene import SceneDescription
from .volume_texture import SIGN_WIDTH, Color, VolumeTexture, range_of


@dataclass(frozen=True)
class ColorBar:
    """A color bar.

    title: Name of the values.
    stops: (share of the bar in 0..1, linear color), linear between them.
    ticks: (share of the bar, text).
    """

    title: str
    stops: tuple[tuple[float, Color], ...]
    ticks: tuple[tuple[float, str], ...]

    @property
    def caption(self) -> str:
        """The title with the values at the ends."""
        return f"{self.title}, {self.ticks[0][1]} to {self.ticks[-1][1]}"


def color_bar_of(texture: VolumeTexture | None) -> ColorBar | None:
    """Returns the color bar of a texture; None for labels, for three channels and without one."""
    if texture is None or texture.nearest or len(texture.channels) != 1:
        return None
    low, high = texture.colors[0][0], texture.colors[-1][0]
    if not low < high:
        return None
    stops = tuple(((value - low) / (high - low), color) for value, color in texture.colors)
    if _is_sign(texture, low, high):
        return ColorBar(texture.name, stops, ((0.0, "negative"), (1.0, "positive")))
    values = low, 0.5 * (low + high), high
    return ColorBar(texture.name, stops, tuple(zip((0.0, 0.5, 1.0), rounded(values))))


def caption_of(texture: VolumeTexture) -> str:
    """Returns a text that says what gives a texture its colors."""
    bar = color_bar_of(texture)
    if bar is not None:
        return bar.caption
    names = [channel.name for channel in texture.channels]
    if len(names) == 3:
        return f"red: {names[0]}, green: {names[1]}, blue: {names[2]}"
    return f"{names[0]}, by label" if texture.nearest else names[0]


def captions_of(scene: SceneDescription) -> list[str]:
    """Returns the captions of all textures of a scene."""
    textures = [isosurfaces.texture for isosurfaces in scene.isosurfaces]
    return [caption_of(texture) for texture in textures if texture is not None]


def rounded(values: Sequence[float]) -> list[str]:
    """Returns values as text, rounded to a thousandth of their span."""
    span = max(values) - min(values)
    digits = max(0, 3 - math.floor(math.log10(span)))
    # Add zero, because -0.0 would be written with its sign.
    return [f"{round(value, digits) + 0.0:.10g}" for value in values]


def _is_sign(texture: VolumeTexture, low: float, high: float) -> bool:
    """True if the colors only show the sign of the values."""
    if low != -high:
        return False
    most = max(map(abs, range_of(texture.channels[0])))
    # Blender stores the range in single precision.
    return math.isclose(high, SIGN_WIDTH * most, rel_tol=1e-5)
