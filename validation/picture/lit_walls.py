# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- VOLUME FOLDER PICTURE.png.

Renders one bake with lit walls at three isovalues. Eevee renders it, so that all colors on the
walls come from the bake.
"""

import sys

import bpy
from leaflight import blender
from PIL import Image

VOLUME, FOLDER, PICTURE = sys.argv[-3:]
SIZE, GAP = 360, 6
SHARES = (0.25, 0.5, 0.75)  # shares of the baked isovalue range

bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
obj = blender.import_volume(VOLUME)
blender.stage(obj, "CORNELL")
blender.bake(obj, light_walls=True, bake_folder=FOLDER)
scene = bpy.context.scene
scene.render.engine = "BLENDER_EEVEE"
scene.render.resolution_x = scene.render.resolution_y = SIZE
scene.render.resolution_percentage = 100
row = Image.new("RGB", (3 * SIZE + 2 * GAP, SIZE), (255, 255, 255))
low, high = obj.leaflight.low, obj.leaflight.high
for number, share in enumerate(SHARES):
    blender.show(obj, low + share * (high - low))
    scene.render.filepath = f"{FOLDER}/{share}.png"
    bpy.ops.render.render(write_still=True)
    row.paste(Image.open(scene.render.filepath).convert("RGB"), (number * (SIZE + GAP), 0))
row.save(PICTURE)
