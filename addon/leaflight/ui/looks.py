# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of isosurfaces by name: color, gloss and background together, and color maps."""

from dataclasses import dataclass, field

from leaflight.looks import LOOKS as OF_ONE_COLOR

from ..show import color_maps


@dataclass(frozen=True)
class Look:
    """name, text: for people; settings: of Object.leaflight; stops: (part of the isovalue range,
    linear color); gloss, roughness: of Object.leaflight_look; background: linear color or None.
    """

    name: str
    text: str
    settings: dict = field(default_factory=dict)
    stops: tuple = ()
    gloss: float = 0.0
    roughness: float = 0.3
    background: tuple = None


def _one_color(look):
    settings = {"isosurface_albedo": look.color}
    return Look(look.name, look.text, settings, (), look.gloss, look.roughness, look.background)


def _mapped(name, text, colors):
    stops = tuple((i / (len(colors) - 1), color) for i, color in enumerate(colors))
    return Look(name, text, stops=stops)


LOOKS = {
    **{key: _one_color(look) for key, look in OF_ONE_COLOR.items()},
    "TISSUE": Look(
        "Tissue",
        "Skin, flesh and bone from low to high isovalues",
        stops=((0.0, (0.8, 0.55, 0.42)), (0.45, (0.6, 0.2, 0.15)), (1.0, (0.88, 0.84, 0.72))),
        gloss=0.4,
    ),
    "GLOW": Look(
        "Glowing",
        "Sends light of its own",
        {"isosurface_emission": (1.0, 0.75, 0.45), "isosurface_emission_strength": 1.0},
    ),
    "MIRROR": Look(
        "Mirror",
        "Polished metal; what it shows is rendered, not baked",
        {"isosurface_scattering": "MIRROR", "isosurface_albedo": (0.9, 0.9, 0.9)},
    ),
    "GLASS": Look(
        "Glass",
        "Clear glass, which throws caustics",
        {
            "isosurface_scattering": "GLASS",
            "isosurface_albedo": (1.0, 1.0, 1.0),
            "isosurface_ior": 1.45,
        },
    ),
}
MAPS = {key: _mapped(*of) for key, of in color_maps.MAPS.items()}
