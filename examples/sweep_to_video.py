# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a sweep through the isovalues of a volume as a video, from one bake.

    blender --background --python examples/sweep_to_video.py -- head.nii.gz --out head.mp4 \
        --isovalues 20 120 --frames 120

Enable the Leaflight add-on first. Frames differ in their isovalue, and one bake lights them all.
"""

import argparse
import sys
from pathlib import Path

import bpy
import numpy as np
from leaflight import blender


def main():
    options = parsed(sys.argv[sys.argv.index("--") + 1 :])
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    volume = blender.import_volume(options.volume)
    low, high = options.isovalues or (volume.leaflight.low, volume.leaflight.high)
    blender.stage(volume)
    print("Baked into", blender.bake(volume, (low, high), error=options.error))
    # Isosurfaces at the ends of the isovalue range are only specks.
    isovalues = np.linspace(low, high, options.frames + 2)[1:-1]
    blender.animate(volume, isovalues)
    render(options.out, options.size, options.samples)


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="sweep_to_video.py")
    parser.add_argument("volume", help="file of a volume")
    parser.add_argument("--out", default="sweep.mp4", help="video to write (sweep.mp4)")
    parser.add_argument("--isovalues", type=float, nargs=2, metavar=("LO", "HI"))
    parser.add_argument(
        "--frames", type=int, default=96, help="number of isovalues, 24 per second (96)"
    )
    parser.add_argument(
        "--error", type=float, default=1.5, help="error of the bake in percent (1.5)"
    )
    parser.add_argument("--size", type=int, nargs=2, default=(960, 960), metavar=("X", "Y"))
    parser.add_argument(
        "--samples", type=int, default=32, help="samples of Cycles, for the walls (32)"
    )
    return parser.parse_args(arguments)


def render(out, size, samples):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.fps = 24
    image = scene.render.image_settings
    if hasattr(image, "media_type"):  # from 5.0 on
        image.media_type = "VIDEO"
    image.file_format = "FFMPEG"
    scene.render.ffmpeg.format = "MPEG4"
    scene.render.ffmpeg.codec = "H264"
    scene.render.ffmpeg.constant_rate_factor = "HIGH"
    scene.render.use_file_extension = False
    scene.render.filepath = str(Path(out).resolve())
    bpy.ops.render.render(animation=True)
    print("Wrote", scene.render.filepath)


main()
