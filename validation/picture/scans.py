# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- FOLDER FILE NAME LOOK SMOOTH.

Makes four clicks and chooses a preset, smoothed by SMOOTH voxels, then renders the same view by
Cycles. Prints how many pixels are white or black in both, and the figures of the comparison.
"""

import json
import os
import sys

import bpy
import hand
import numpy as np
import stepwise
from leaflight import blender

sys.path.insert(0, os.path.dirname(__file__))
from first_brain import FOLDER, bake, call, open_tab, picture  # noqa: E402

FILE, NAME, LOOK, SMOOTH = sys.argv[-4:]
# Size of the compared stills in percent of 1920 x 1080, and samples of Cycles.
PERCENTAGE, SAMPLES = 25, 32
# Lowest level of white pixels and highest level of black ones, of 255.
BURNT, BLACK = 254, 1


def drive():
    yield from open_tab()
    options = {"filepath": FILE, "smooth": float(SMOOTH)}
    call(bpy.ops.leaflight.import_volume, "EXEC_DEFAULT", **options)
    yield 2.0
    picture(f"{NAME}_imported")
    yield 0.5
    call(bpy.ops.leaflight.stage)
    yield 30.0  # shaders are compiled
    call(bpy.ops.leaflight.isosurface_preset, "EXEC_DEFAULT", preset=LOOK)
    yield 1.0
    yield from bake()
    # A render waits for shaders that the viewport compiles.
    scene = bpy.context.scene
    scene.render.resolution_percentage = 5
    bpy.ops.render.render()
    yield 20.0
    picture(f"{NAME}_baked")
    yield 0.5
    obj = bpy.context.object
    scene.render.resolution_percentage = PERCENTAGE
    shown = os.path.join(FOLDER, f"{NAME}_viewport.png")
    render_viewport(shown)
    yield 0.5
    figures = blender.compare(obj, os.path.join(FOLDER, NAME), SAMPLES, 16)
    cycles = os.path.join(FOLDER, NAME, f"{obj.name}_{figures['isovalue']:g}_cycles.png")
    counts = {"viewport": extremes(shown), "cycles": extremes(cycles)}
    print("SCAN", NAME, json.dumps({**counts, **figures}), flush=True)
    yield 0.5
    scene.render.resolution_percentage = 100
    scene.render.filepath = os.path.join(FOLDER, f"{NAME}.png")
    bpy.ops.render.render(write_still=True)


def render_viewport(path):
    bpy.context.scene.render.filepath = path
    with hand.in_view():
        bpy.ops.render.opengl(write_still=True, view_context=True)


def extremes(path):
    """Returns the numbers of white and of black pixels of a picture."""
    image = bpy.data.images.load(path)
    pixels = 255 * np.array(image.pixels, np.float32).reshape(-1, 4)[:, :3]
    bpy.data.images.remove(image)
    return {
        "burnt": int((pixels.min(axis=1) >= BURNT).sum()),
        "black": int((pixels.max(axis=1) <= BLACK).sum()),
    }


if __name__ == "__main__":
    stepwise.run(drive(), {})
