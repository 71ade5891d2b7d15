# SPDX-License-Identifier: GPL-3.0-or-later
"""Common color maps by name, for the add-on, pages and textures."""

from .color_tables import TABLES

_CONTINUOUS = (
    ("VIRIDIS", "Viridis", "Dark blue over green to yellow, even in lightness (matplotlib)"),
    ("MAGMA", "Magma", "Black over purple to light yellow, even in lightness (matplotlib)"),
    (
        "BONE_MAP",
        "Bone Map",
        "Black to white with a tinge of blue, as for radiographs (matplotlib)",
    ),
    ("CET_L3", "CET Fire", "Black over red and yellow to white, even in lightness (CET-L3)"),
    ("CET_R2", "CET Rainbow", "Blue over green to red without false edges (CET-R2)"),
    ("CET_D1", "CET Cool Warm", "Blue over light gray to red (CET-D1)"),
    ("INFERNO", "Inferno", "Black over red to light yellow, even in lightness (matplotlib)"),
    ("PLASMA", "Plasma", "Blue over red to yellow, even in lightness (matplotlib)"),
    ("CIVIDIS", "Cividis", "Dark blue to yellow, for every kind of color vision (matplotlib)"),
    ("BATLOW", "Batlow", "Dark blue over green and orange to pink, even in lightness (Crameri)"),
    ("LAJOLLA", "Lajolla", "Black over red and yellow to white, even in lightness (Crameri)"),
    ("OSLO", "Oslo", "Black over blue to white, even in lightness (Crameri)"),
    ("CET_L1", "CET Gray", "Black to white, even in lightness (CET-L1)"),
    ("TURBO", "Turbo", "Dark blue over green to dark red, a smooth rainbow (Google)"),
    ("COOLWARM", "Cool Warm", "Blue over gray to red, the default of ParaView (Moreland)"),
    ("VIK", "Vik", "Dark blue over white to dark red (Crameri)"),
    ("BERLIN", "Berlin", "Light blue over black to light red (Crameri)"),
    ("ROMA", "Roma", "Brown over yellow to blue (Crameri)"),
    ("TWILIGHT", "Twilight", "Cyclic: light gray over blue, black and red (matplotlib)"),
    ("ROMAO", "RomaO", "Cyclic: brown over yellow and blue (Crameri)"),
    ("CET_C6", "CET Phase", "Cyclic: six hues, for phases (CET-C6)"),
)
_CATEGORICAL = (
    ("TAB10", "Ten Colors", "Ten separate colors (Tableau)"),
    ("OKABE_ITO", "Okabe Ito", "Seven separate colors for every kind of color vision"),
)


def colors_of(key: str) -> tuple[str, ...]:
    """Returns all colors of a map, as six hexadecimal digits of sRGB. Raises KeyError."""
    return tuple(TABLES[key].split())


# Color maps by key: (name, description, nine evenly spaced colors of colors_of()).
MAPS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    key: (name, text, colors_of(key)[::4]) for key, name, text in _CONTINUOUS
}
# Color maps without colors between, by key: (name, description, colors).
CATEGORICAL: dict[str, tuple[str, str, tuple[str, ...]]] = {
    key: (name, text, colors_of(key)) for key, name, text in _CATEGORICAL
}
