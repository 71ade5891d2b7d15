# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of isosurfaces by name: color, gloss and background together, and color maps."""

from dataclasses import dataclass, field

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


def _colored(name, text, color, gloss, roughness, background):
    return Look(name, text, {"isosurface_albedo": color}, (), gloss, roughness, background)


def _mapped(name, text, colors):
    stops = tuple((i / (len(colors) - 1), color) for i, color in enumerate(colors))
    return Look(name, text, stops=stops)


LOOKS = {
    "PLASTER": Look("Plaster", "Plain light gray, matte", {"isosurface_albedo": (0.8, 0.8, 0.8)}),
    "BONE": _colored(
        "Bone",
        "Warm white with a soft sheen, before dark blue",
        (0.82, 0.73, 0.56),
        *(0.5, 0.35, (0.10, 0.13, 0.18)),
    ),
    "SKIN": _colored(
        "Skin",
        "Rosy, with wide highlights, before blue gray",
        (0.76, 0.46, 0.34),
        *(0.6, 0.45, (0.22, 0.26, 0.31)),
    ),
    "IVORY": _colored(
        "Ivory",
        "Creamy and polished, before dark red",
        (0.88, 0.81, 0.66),
        *(1.0, 0.15, (0.18, 0.06, 0.05)),
    ),
    "CLAY": _colored(
        "Clay",
        "Fired clay, matte, before warm gray",
        (0.58, 0.27, 0.16),
        *(0.15, 0.6, (0.42, 0.38, 0.34)),
    ),
    "COPPER": _colored(
        "Copper",
        "Lacquered copper, before dark gray green",
        (0.72, 0.31, 0.17),
        *(1.0, 0.2, (0.10, 0.12, 0.12)),
    ),
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
