# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- FOLDER PICTURE.png. Renders translucent gray matter over white matter, cut
by a box. The volume is Colin27 of Debian's mricron-data.
"""

import sys
from pathlib import Path

import bpy
from leaflight import blender
from PIL import Image

BRAIN = "/usr/share/mricron/templates/ch2bet.nii.gz"
GRAY, WHITE = 55.0, 115.0
GRAY_COLOR, WHITE_COLOR = (0.75, 0.45, 0.38), (0.85, 0.82, 0.75)

folder, picture = map(Path, sys.argv[-2:])
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
brain = blender.import_volume(BRAIN)
blender.stage(brain, preset="OPEN_FLOOR")
for isovalue, color in ((GRAY, GRAY_COLOR), (WHITE, WHITE_COLOR)):
    stop = brain.leaflight.isosurface_stops.add()
    stop.isovalue, stop.color = isovalue, color
# Let Cycles light the floor, with less noise than a bake of some minutes.
settings = {"light_walls": False, "error": 3.0, "bake_folder": str(folder)}
blender.bake(brain, isovalues=(GRAY - 5, WHITE + 5), **settings)
blender.show(brain, WHITE)
skin = blender.add_isosurface(brain, GRAY, opacity=0.35)

scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.use_denoising = 64, False
scene.render.resolution_x = scene.render.resolution_y = 480
scene.render.resolution_percentage = 100
stills = []
for name in ("through", "cut"):
    if name == "cut":
        skin.leaflight_look.opacity = 1.0
        brain.leaflight_look.is_cut = False
        bpy.ops.leaflight.add_clip_box()
    scene.render.filepath = str(folder / f"{name}.png")
    bpy.ops.render.render(write_still=True)
    stills.append(Image.open(scene.render.filepath).convert("RGB"))
pair = Image.new("RGB", (2 * 480 + 6, 480), (255, 255, 255))
for still, x in zip(stills, (0, 486)):
    pair.paste(still, (x, 0))
pair.save(picture)
