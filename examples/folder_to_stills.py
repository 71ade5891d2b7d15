# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a picture of every scan in a folder.

    blender --background --python examples/folder_to_stills.py -- scans/ --out stills/

Enable the Leaflight add-on first. Scans that cannot be read are reported and left out. The exit
status is 1 then.
"""

import argparse
import sys
from pathlib import Path

import bpy
from leaflight import LeaflightError, blender


def main():
    options = parsed(sys.argv[sys.argv.index("--") + 1 :])
    out = Path(options.out).resolve()
    out.mkdir(parents=True, exist_ok=True)
    failed = 0
    for scan in sorted(Path(options.scans).iterdir()):
        try:
            print("Wrote", still(scan, out, options))
        except LeaflightError as error:
            failed += 1
            print("Left out:", error, file=sys.stderr)
    sys.exit(1 if failed else 0)


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="folder_to_stills.py")
    parser.add_argument("scans", help="folder of volumes")
    parser.add_argument("--out", default="stills", help="folder for the pictures (stills)")
    parser.add_argument("--isovalue", type=float, help="isovalue of all scans (a default for each)")
    parser.add_argument(
        "--error", type=float, default=3.0, help="error of the bakes in percent (3)"
    )
    parser.add_argument(
        "--time", type=float, default=60, help="time limit of a bake in seconds (60)"
    )
    parser.add_argument(
        "--size", type=int, default=960, help="size of the pictures in pixels (960)"
    )
    parser.add_argument(
        "--samples", type=int, default=64, help="samples of Cycles, for the walls (64)"
    )
    return parser.parse_args(arguments)


def still(scan, out, options):
    """Renders one scan in an empty scene; returns the path of the picture."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    volume = blender.import_volume(scan)
    isovalue = options.isovalue
    if isovalue is None:
        isovalue = volume.leaflight.isovalue
    blender.stage(volume)
    # Bake a narrow isovalue range around one isosurface, which is faster.
    spread = 0.02 * (volume.leaflight.high - volume.leaflight.low)
    isovalue_range = (isovalue - spread, isovalue + spread)
    blender.bake(volume, isovalue_range, error=options.error, time_limit=options.time)
    blender.show(volume, isovalue)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = options.samples
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = options.size
    scene.render.image_settings.file_format = "PNG"
    path = out / f"{scan.name.partition('.')[0]}.png"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return path


main()
