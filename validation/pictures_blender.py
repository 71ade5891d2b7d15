# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of validation/pictures that runs within Blender."""

import argparse
import sys
from pathlib import Path

import bpy
import numpy as np

SIZE = 360
SHARES = (0.25, 0.5, 0.75)  # of the baked isovalue range


def main():
    parser = argparse.ArgumentParser()
    for name in ("addon", "volume", "bakes", "out"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])
    bpy.ops.preferences.addon_install(filepath=str(arguments.addon.resolve()))
    bpy.ops.preferences.addon_enable(module="leaflight_addon")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.leaflight.import_volume(filepath=str(arguments.volume.resolve()))
    isosurface = bpy.context.object
    bpy.ops.leaflight.stage(preset="CORNELL")
    settings = isosurface.leaflight
    settings.bake_folder = str(arguments.bakes.resolve())
    settings.light_walls = True
    bpy.ops.leaflight.bake()

    scene = bpy.context.scene
    scene.render.engine = "BLENDER_EEVEE"
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    row = []
    for share in SHARES:
        settings.isovalue = settings.low + share * (settings.high - settings.low)
        scene.render.filepath = str((arguments.bakes / f"{share}.png").resolve())
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = np.empty(SIZE * SIZE * 4, np.float32)
        image.pixels.foreach_get(pixels)
        row += [pixels.reshape(SIZE, SIZE, 4), np.ones((SIZE, 6, 4), np.float32)]
    save(np.concatenate(row[:-1], axis=1), arguments.out.resolve() / "lit_walls.png")


def save(pixels, path):
    image = bpy.data.images.new("Row", pixels.shape[1], pixels.shape[0])
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    image.filepath_raw = str(path)
    image.file_format = "PNG"
    image.save()


main()
