# SPDX-License-Identifier: GPL-3.0-or-later
"""Flatland (thesis chapter 3): images, whose isolines are lit in the plane."""

from .flat_scene import flat_box, load_flat_scene
from .flatland import (
    BRIGHTNESS_CORRECTION,
    FlatBake,
    bake_flatland,
    bump_box_2d,
    picture,
    read_image,
)

__all__ = [
    "BRIGHTNESS_CORRECTION",
    "FlatBake",
    "bake_flatland",
    "bump_box_2d",
    "flat_box",
    "load_flat_scene",
    "picture",
    "read_image",
]
