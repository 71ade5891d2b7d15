# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of scripts/demo that runs within Blender."""

import argparse
import contextlib
import json
import os
import re
import shutil
import sys
import time
from pathlib import Path

import bpy
import numpy as np

ISOVALUES = (24.5, 45.5, 70.5)
COMPARED = 45.5
ISOVALUE_RANGE = (20.0, 75.0)
SIZE = 480
STILL_SAMPLES = 32
CYCLES_SAMPLES = 96


def main():
    arguments = parse_arguments()
    install(arguments.addon)
    show_on_terminal()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    isosurface = build_scene(arguments.volume)
    isosurface.leaflight.bake_folder = str(arguments.bakes.resolve())
    bpy.ops.leaflight.bake()

    out = arguments.out.resolve()
    pictures, surface_seconds, still_seconds = [], [], []
    for isovalue in ISOVALUES:
        start = time.perf_counter()
        isosurface.leaflight.isovalue = isovalue
        surface_seconds.append(time.perf_counter() - start)
        picture = out / f"colin27_{isovalue}.png"
        pictures.append(picture)
        if isovalue == COMPARED:
            result = render_comparison(out, isosurface)
            shutil.copyfile(out / f"{isosurface.name}_{isovalue}_baked.png", picture)
            still_seconds.append(result["baked_seconds"])
        else:
            still_seconds.append(render_still(picture, f"Still {isovalue}"))
    cycles = out / f"colin27_{COMPARED}_cycles.png"
    side_by_side(out / "side_by_side.png", [*pictures, cycles])
    print_table(isosurface, surface_seconds, still_seconds, result, out)


def parse_arguments():
    parser = argparse.ArgumentParser()
    for name in ("addon", "volume", "bakes", "out"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def install(addon):
    bpy.ops.preferences.addon_install(filepath=str(addon.resolve()))
    bpy.ops.preferences.addon_enable(module="leaflight_addon")


def show_on_terminal():
    """Sends prints to the terminal of scripts/demo, descriptor 3; the rest goes to its log."""
    with contextlib.suppress(OSError):
        sys.stdout = os.fdopen(3, "w")


def build_scene(volume):
    """Returns the volume in a Cornell box, seen at three quarters."""
    bpy.ops.leaflight.import_volume(filepath=str(volume))
    isosurface = bpy.context.object
    isosurface.name = "colin27"
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    bpy.ops.leaflight.stage(preset="CORNELL")
    # Use the view transform of the comparison.
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    scene.view_settings.exposure = -0.6
    settings = isosurface.leaflight
    settings.light_walls = False
    settings.low, settings.high = ISOVALUE_RANGE
    bpy.context.view_layer.update()
    return isosurface


def render_still(path, label):
    """Renders the scene as the user's F12 would. Returns the seconds."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = STILL_SAMPLES
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = str(path)
    start = time.perf_counter()
    with render_progress(label, STILL_SAMPLES):
        bpy.ops.render.render(write_still=True)
    return time.perf_counter() - start


def render_comparison(folder, isosurface):
    with render_progress(f"Comparison with Cycles at {COMPARED}", STILL_SAMPLES + CYCLES_SAMPLES):
        bpy.ops.leaflight.render_comparison(
            samples=CYCLES_SAMPLES, baked_samples=STILL_SAMPLES, folder=str(folder)
        )
    return json.loads((folder / f"{isosurface.name}_{COMPARED}_comparison.json").read_text())


@contextlib.contextmanager
def render_progress(label, samples):
    """Yields a bar that follows the samples of one or more renders."""
    done = [0, 0]  # samples of finished renders, and of the current one

    def show(text, *_):
        match = re.search(r"Sample (\d+)/(\d+)", str(text))
        if match:
            sample = int(match[1])
            if sample < done[1]:
                done[0] += done[1]
            done[1] = sample
            draw_bar(label, min(sum(done) / samples, 1.0))

    bpy.app.handlers.render_stats.append(show)
    try:
        yield
    finally:
        bpy.app.handlers.render_stats.remove(show)
        draw_bar(label, 1.0)
        print()


def draw_bar(label, fraction):
    filled = round(30 * fraction)
    print(f"\r{label} [{'#' * filled}{'.' * (30 - filled)}] {100 * fraction:3.0f} %", end="")
    sys.stdout.flush()


def side_by_side(path, pictures):
    """Puts pictures of the same size into one row."""
    gap = np.ones((SIZE, 8, 4), np.float32)
    row = []
    for picture in pictures:
        image = bpy.data.images.load(str(picture))
        pixels = np.empty(SIZE * SIZE * 4, np.float32)
        image.pixels.foreach_get(pixels)
        row += [gap, pixels.reshape(SIZE, SIZE, 4)]
    row = np.concatenate(row[1:], axis=1)
    image = bpy.data.images.new("Side by Side", row.shape[1], SIZE)
    image.pixels.foreach_set(row.ravel())
    image.filepath_raw = str(path)
    image.file_format = "PNG"
    image.save()


def print_table(isosurface, surface_seconds, still_seconds, result, out):
    lines = [("Bake, all isovalues", f"{isosurface.leaflight.bake_seconds:.1f} s")]
    for isovalue, surface, still in zip(ISOVALUES, surface_seconds, still_seconds):
        lines.append((f"Isovalue {isovalue}: lit surface", f"{surface:.2f} s"))
        lines.append((f"Isovalue {isovalue}: still, {STILL_SAMPLES} samples", f"{still:.1f} s"))
    lines += [
        (
            f"Isovalue {COMPARED}: Cycles, {CYCLES_SAMPLES} samples",
            f"{result['cycles_seconds']:.1f} s",
        ),
        (
            f"Isovalue {COMPARED}: RMS error on the isosurface",
            f"{result['isosurface_rms_percent']:.2f} %",
        ),
        ("of which noise", f"{result['isosurface_noise_percent']:.2f} %"),
    ]
    width = max(len(name) for name, _ in lines)
    print()
    for name, value in lines:
        print(f"{name:<{width}}  {value:>8}")
    print(
        f"\n{os.path.relpath(out)}/side_by_side.png: baked {', '.join(map(str, ISOVALUES))}", end=""
    )
    print(f", then Cycles {COMPARED}")


if __name__ == "__main__":
    main()
