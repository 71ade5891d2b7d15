# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- VOLUME FOLDER PICTURE.png. Makes the picture of Render Comparison."""

import shutil
import sys
from pathlib import Path

import bpy
from leaflight import blender

volume, folder, picture = sys.argv[-3:]
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
obj = blender.import_volume(volume)
blender.stage(obj, "CORNELL")
low, high = obj.leaflight.low, obj.leaflight.high
blender.bake(obj, error=2.0, light_walls=True, bake_folder=folder)
blender.show(obj, low + 0.35 * (high - low))
scene = bpy.context.scene
scene.render.resolution_x = scene.render.resolution_y = 400
scene.render.resolution_percentage = 100
blender.compare(obj, folder, samples=256, baked_samples=64)
(written,) = Path(folder).glob("*_comparison.png")
shutil.copyfile(written, picture)
