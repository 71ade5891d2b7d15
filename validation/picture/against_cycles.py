# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- FILE FOLDER ROW.png OPTIONS ISOVALUE. Puts stills of a default bake with
lit walls beside those of Cycles, and prints their FLIP. OPTIONS: of the reader, as JSON.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
from leaflight import blender
from leaflight.io.images import display_colors, read_exr
from leaflight.measure.flip import flip
from PIL import Image

sys.path.append(str(Path(__file__).parent))

from rendering import empty_scene
from sheets import sheet

SIZE, CYCLES_SAMPLES, BAKED_SAMPLES = 480, 1024, 64
# Size of a crop, which is shown twice as large, in pixels.
CROP = SIZE // 4


def main():
    path, folder, row = map(Path, sys.argv[-5:-2])
    found = compared(path, json.loads(sys.argv[-2]), float(sys.argv[-1]), folder)
    print(line_of(path, found))
    row_of(found, folder).save(row)


def compared(path, options, isovalue, folder):
    """Bakes a volume with default settings and walls, and compares one isosurface with Cycles."""
    empty_scene()
    obj = blender.import_volume(path, **options)
    blender.stage(obj, "CORNELL")
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    blender.bake(obj, light_walls=True, bake_folder=str(folder))
    blender.show(obj, isovalue)
    return blender.compare(obj, folder, CYCLES_SAMPLES, BAKED_SAMPLES)


def line_of(path, found):
    cells = (
        path.name,
        f"{found['isovalue']:g}",
        f"{found['bake_seconds']:.1f}",
        f"{found['flip_mean']:.4f}",
        f"{found['flip_percentile_95']:.4f}",
    )
    return f"| {' | '.join(cells)} |"


def row_of(found, folder):
    """Returns both stills beside the two crops of largest FLIP."""
    stem = f"{found['name']}_{found['isovalue']:g}"
    baked, cycles = (
        read_exr(str(folder / f"{stem}_{still}.exr"))[..., :3] for still in ("baked", "cycles")
    )
    seen = flip(baked, cycles, found["exposure"]).map
    shown = [Image.fromarray(display_colors(still, found["exposure"])) for still in (baked, cycles)]
    crops = [enlarged(still, place) for place in largest(seen) for still in shown]
    return sheet([*shown, sheet(crops, 2, gap=0)], 3, gap=0)


def largest(seen):
    """Returns corners (y, x) of two separate squares with the largest mean of a map."""
    half = CROP // 2
    count = SIZE // half
    tiles = seen[: count * half, : count * half].reshape(count, half, count, half).mean((1, 3))
    sums = tiles[:-1, :-1] + tiles[1:, :-1] + tiles[:-1, 1:] + tiles[1:, 1:]
    corners = []
    for _ in range(2):
        y, x = np.unravel_index(np.argmax(sums), sums.shape)
        corners.append((y * half, x * half))
        sums[max(0, y - 1) : y + 2, max(0, x - 1) : x + 2] = -1
    return corners


def enlarged(picture, place):
    y, x = place
    return picture.crop((x, y, x + CROP, y + CROP)).resize((2 * CROP, 2 * CROP), Image.NEAREST)


main()
