# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of isosurfaces, for the add-on and for pages."""

from dataclasses import dataclass

Color = tuple[float, float, float]


@dataclass(frozen=True)
class Preset:
    """A preset of an isosurface's material.

    name, text: Label and description.
    color: Linear albedo.
    gloss: Weight of a clear coat, 0 to 1.
    roughness: Roughness of the coat.
    background: A linear color or None.
    """

    name: str
    text: str
    color: Color
    gloss: float = 0.0
    roughness: float = 0.3
    background: Color | None = None


LOOKS = {
    "PLASTER": Preset("Plaster", "Plain light gray, matte", (0.8, 0.8, 0.8)),
    "BONE": Preset(
        "Bone",
        "Warm white with a soft sheen, before dark blue",
        (0.82, 0.73, 0.56),
        *(0.5, 0.35, (0.10, 0.13, 0.18)),
    ),
    "SKIN": Preset(
        "Skin",
        "Rosy, with wide highlights, before blue gray",
        (0.76, 0.46, 0.34),
        *(0.6, 0.45, (0.22, 0.26, 0.31)),
    ),
    "IVORY": Preset(
        "Ivory",
        "Creamy and polished, before dark red",
        (0.88, 0.81, 0.66),
        *(1.0, 0.15, (0.18, 0.06, 0.05)),
    ),
    "CLAY": Preset(
        "Clay",
        "Fired clay, matte, before warm gray",
        (0.58, 0.27, 0.16),
        *(0.15, 0.6, (0.42, 0.38, 0.34)),
    ),
    "COPPER": Preset(
        "Copper",
        "Lacquered copper, before dark gray green",
        (0.72, 0.31, 0.17),
        *(1.0, 0.2, (0.10, 0.12, 0.12)),
    ),
}
