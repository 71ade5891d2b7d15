# SPDX-License-Identifier: GPL-3.0-or-later
"""python read_bake.py BAKE.vdb OUT.npz: writes the light of a bake's texels and of an
isosurface.
"""

import sys

import leaflight
import numpy as np

bake = leaflight.load_bake(sys.argv[1])
surface = bake.surface(100.5)
np.savez(
    sys.argv[2],
    mask=bake.grid.mask(),
    radiance=bake.grid.dense("radiance"),
    vertices=surface.vertices,
    triangles=surface.triangles,
    lit=surface.radiance,
)
