# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes the bump box with all kinds of results, saves it, and writes every array to an .npz:
python bake_arrays.py SCENE OUT.npz
"""

import sys
from pathlib import Path

import leaflight
import numpy as np

NAMES = ("radiance", "radiance_indirect", "radiance_error", "radiance_back")


def main():
    scene, out = sys.argv[1], Path(sys.argv[2])
    baked = leaflight.bake(
        leaflight.bump_box(32),
        leaflight.load_scene(scene),
        error=5.0,
        resolution=32,
        both_sides=True,
        walls=True,
    )
    baked.save(out.with_suffix(".vdb"))
    read = leaflight.load_bake(out.with_suffix(".vdb"))
    arrays = {}
    for origin, bake in (("baked", baked), ("read", read)):
        arrays[f"{origin}/mask"] = bake.grid.mask()
        for name in NAMES:
            arrays[f"{origin}/{name}"] = bake.grid.dense(name)
        for mesh in range(bake.walls.count):
            for back in (False, True):
                values = [bake.walls.radiance(mesh, c, back) for c in np.linspace(20, 180, 5)]
                arrays[f"{origin}/walls/{mesh}/{back}"] = np.array(values)
    surface = baked.surface(47.0)
    for name in ("vertices", "normals", "triangles", "radiance"):
        arrays[f"surface/{name}"] = getattr(surface, name)
    np.savez(out, **arrays)
    print(np.__version__, leaflight.__file__)


if __name__ == "__main__":
    main()
