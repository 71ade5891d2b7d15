# SPDX-License-Identifier: GPL-3.0-or-later
"""Common color maps, for the add-on and for pages."""

# Color maps by key: (name, description, nine evenly spaced sRGB colors). They are from matplotlib
# 3.6 and colorcet 3.2 (Kovesi 2015).
MAPS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    key: (name, text, tuple(colors.split()))
    for key, name, text, colors in (
        (
            "VIRIDIS",
            "Viridis",
            "Dark blue over green to yellow, even in lightness (matplotlib)",
            "440154 472d7b 3b528b 2c728e 21918c 27ad81 5cc863 aadc32 fde725",
        ),
        (
            "MAGMA",
            "Magma",
            "Black over purple to light yellow, even in lightness (matplotlib)",
            "000004 1d1147 51127c 832681 b73779 e55064 fb8761 fec287 fcfdbf",
        ),
        (
            "BONE_MAP",
            "Bone Map",
            "Black to white with a tinge of blue, as for radiographs (matplotlib)",
            "000000 1c1c27 38384e 545574 707b90 8ba1ab a7c7c7 d3e3e3 ffffff",
        ),
        (
            "CET_L3",
            "CET Fire",
            "Black over red and yellow to white, even in lightness (colorcet, CET-L3)",
            "000000 4a0000 7d0200 b40500 ed1400 fe6600 ffa401 ffd909 ffffff",
        ),
        (
            "CET_R2",
            "CET Rainbow",
            "Blue over green to red without false edges (colorcet, CET-R2)",
            "0033f5 00729d 3e944d 6aaf11 b4c120 f5cc2c ffa41c ff740a fc3000",
        ),
        (
            "CET_D1",
            "CET Cool Warm",
            "Blue over light gray to red (colorcet, CET-D1)",
            "2050da 7075e1 a09ce7 c9c5ec ede7e9 f0beb1 e78c76 d6573f bf0205",
        ),
    )
}
