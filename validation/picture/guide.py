# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- VOLUME FOLDER IMAGES. Makes the pictures of docs/guide.md.

The picture lit_walls shows one bake with lit walls at three isovalues. Eevee renders it, so that
all colors on the walls come from the bake. The picture comparison is that of Render Comparison. The
picture several_isosurfaces shows translucent gray matter over white matter, cut by a box. The
volume is Colin27 of Debian's mricron-data.
"""

import shutil
import sys
from pathlib import Path

import bpy
from leaflight import blender
from PIL import Image

sys.path.append(str(Path(__file__).parent))

from rendering import empty_scene
from sheets import sheet

BRAIN = "/usr/share/mricron/templates/ch2bet.nii.gz"
GRAY, WHITE = 55.0, 115.0
GRAY_COLOR, WHITE_COLOR = (0.75, 0.45, 0.38), (0.85, 0.82, 0.75)
SHARES = (0.25, 0.5, 0.75)  # shares of the baked isovalue range

VOLUME, FOLDER, IMAGES = sys.argv[-3], *map(Path, sys.argv[-2:])


def staged(volume, preset, size, engine):
    """Returns the object of a volume on a stage, in a new scene with square pictures."""
    empty_scene()
    obj = blender.import_volume(volume)
    blender.stage(obj, preset)
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    return obj


def rendered(name):
    bpy.context.scene.render.filepath = str(FOLDER / f"{name}.png")
    bpy.ops.render.render(write_still=True)
    return Image.open(bpy.context.scene.render.filepath).convert("RGB")


def show_share(obj, share):
    low, high = obj.leaflight.low, obj.leaflight.high
    blender.show(obj, low + share * (high - low))


def lit_walls():
    obj, stills = staged(VOLUME, "CORNELL", 360, "BLENDER_EEVEE"), []
    blender.bake(obj, light_walls=True, bake_folder=str(FOLDER))
    for share in SHARES:
        show_share(obj, share)
        stills.append(rendered(share))
    sheet(stills, len(stills)).save(IMAGES / "lit_walls.png")


def comparison():
    obj, folder = staged(VOLUME, "CORNELL", 400, "CYCLES"), FOLDER / "compared"
    blender.bake(obj, error=2.0, light_walls=True, bake_folder=str(folder))
    show_share(obj, 0.35)
    blender.compare(obj, str(folder), samples=256, baked_samples=64)
    (written,) = folder.glob("*_comparison.png")
    shutil.copyfile(written, IMAGES / "comparison.png")


def several_isosurfaces():
    brain = staged(BRAIN, "OPEN_FLOOR", 480, "CYCLES")
    for isovalue, color in ((GRAY, GRAY_COLOR), (WHITE, WHITE_COLOR)):
        stop = brain.leaflight.isosurface_stops.add()
        stop.isovalue, stop.color = isovalue, color
    # Let Cycles light the floor, with less noise than a bake of some minutes.
    settings = {"light_walls": False, "error": 3.0, "bake_folder": str(FOLDER)}
    blender.bake(brain, isovalues=(GRAY - 5, WHITE + 5), **settings)
    blender.show(brain, WHITE)
    skin = blender.add_isosurface(brain, GRAY, opacity=0.35)
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    stills = [rendered("through")]
    skin.leaflight_look.opacity = 1.0
    brain.leaflight_look.is_cut = False
    bpy.ops.leaflight.add_clip_box()
    sheet([*stills, rendered("cut")], 2).save(IMAGES / "several_isosurfaces.png")


for make in (lit_walls, comparison, several_isosurfaces):
    make()
