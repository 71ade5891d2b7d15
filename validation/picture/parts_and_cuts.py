# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: ... -- NAME DATA WORK OUT. Makes the picture NAME of docs/guide.md.

exploded: The metal parts of an engine in its housing, and moved apart. DATA holds engine.vti.
several_cuts: Colin27's skin, gray matter and white matter, which are copies of one volume. The
first two have cuts of their own, and one bake lights all.
"""

import sys
from pathlib import Path

import bpy
from leaflight import blender
from leaflight_addon.show import display

sys.path.append(str(Path(__file__).parent))

from colors_and_cuts import frame
from rendering import empty_scene, rendered, turn
from sheets import save_webp, sheet

HEAD = "/usr/share/mricron/templates/ch2.nii.gz"
QUALITY = 88
ERROR, SAMPLES = 3.0, 96
# Stops of exposure above that of the stage.
EXPOSURE = 0.6

# Isovalues and colors of the engine, and the voxels by which its parts move apart.
METAL, METAL_COLOR = 200.0, (0.62, 0.27, 0.12)
HOUSING, HOUSING_COLOR = 60.0, (0.55, 0.6, 0.65)
APART = 260.0

# Isovalue and color of each copy of the head, from the outside to the inside, and how far away its
# cut is (add_cut()); 0 is no cut.
COPIES = (
    (45.0, (0.78, 0.55, 0.44), 1.0),
    (88.0, (0.72, 0.42, 0.37), 1.25),
    (106.0, (0.86, 0.82, 0.72), 0.0),
)
# Half of the isovalue range of each copy.
AROUND = 8.0


def main():
    name, *folders = sys.argv[-4:]
    data, work, out = map(Path, folders)
    empty_scene()
    pictures = MAKERS[name](data, work)
    save_webp(sheet(pictures, len(pictures)), out / f"{name}.webp", QUALITY)
    print("docs/images", name)


def exploded(data, work):
    engine = blender.import_volume(data / "engine.vti", smooth=0.7)
    # Lay the engine on its side, along whose axis the parts then move.
    turn(engine, 0, 90, 0)
    for isovalue, color in ((METAL, METAL_COLOR), (HOUSING, HOUSING_COLOR)):
        stop = engine.leaflight.isosurface_stops.add()
        stop.isovalue, stop.color = isovalue, color
    blender.show(engine, HOUSING)
    blender.stage(engine)
    stand_on_floor(engine)
    blender.show(engine, METAL)
    look = engine.leaflight_look
    look.dust = 10.0
    blender.add_isosurface(engine, HOUSING, opacity=0.25)
    # Let Cycles light the floor, where the shadows of the parts then follow them.
    limits = {"error": ERROR, "use_resolution": True, "resolution": 80}
    isovalues = (HOUSING - 5, METAL + 5)
    blender.bake(engine, isovalues, light_walls=False, bake_folder=str(work), **limits)
    blender.show(engine, METAL)
    look.explode_axis, look.explode_distance = "Z", APART
    bpy.ops.leaflight.frame_isosurface()
    bpy.context.scene.view_settings.exposure += EXPOSURE
    pictures = []
    for distance in (0.0, APART):
        look.explode_distance = distance
        pictures.append(rendered(work / f"apart_{distance:g}.png", (800, 500), SAMPLES))
    return pictures


def stand_on_floor(obj):
    """Closes the gap that a stage leaves under an isosurface, which baked walls need."""
    meshes = {each for each in bpy.context.scene.objects if each.type == "MESH" and each != obj}
    obj.location.z += min(map(lowest, meshes)) - lowest(obj)
    bpy.context.view_layer.update()


def lowest(obj):
    return min((obj.matrix_world @ vertex.co).z for vertex in obj.data.vertices)


def several_cuts(_, work):
    skin = blender.import_volume(HEAD, smooth=1.2)
    turn(skin, 0, 0, 60)
    blender.show(skin, COPIES[0][0])
    bpy.ops.leaflight.clean_data(kind="largest_part")
    blender.stage(skin)
    frame(skin, rise=14.0, zoom=1.2)
    copies = [skin, *(copy_of(skin) for _ in COPIES[1:])]
    for obj, (isovalue, color, away) in zip(copies, COPIES):
        settings = obj.leaflight
        settings.low, settings.high = isovalue - AROUND, isovalue + AROUND
        settings.isosurface_albedo, settings.capped = color, True
        blender.show(obj, isovalue)
        display.select(bpy.context, [obj], obj)
        if obj != skin:
            # Remove the scalp, which is as bright as the brain.
            bpy.ops.leaflight.clean_data(kind="largest_part")
        if away:
            add_cut(obj, away)
    limits = {"error": ERROR, "use_resolution": True, "resolution": 72}
    blender.bake(skin, light_walls=True, bake_folder=str(work), **limits)
    bpy.context.scene.view_settings.exposure += EXPOSURE
    return [rendered(work / "several_cuts.png", (1280, 800), 16)]


def copy_of(obj):
    copy = obj.copy()
    copy.data = obj.data.copy()
    bpy.context.collection.objects.link(copy)
    return copy


def add_cut(obj, away):
    """Cuts the data of a volume at the corner nearest to the camera.

    away: Distance of the cut's box from the middle, relative to that of a new clip box.
    """
    bpy.ops.leaflight.add_clip_box()
    box = obj.leaflight_look.box
    local = obj.matrix_world.inverted() @ box.matrix_world
    local.translation *= away
    box.matrix_world = obj.matrix_world @ local
    bpy.context.view_layer.update()
    bpy.ops.leaflight.cut_data(cut="capped")
    # The box would still cut the shown isosurface, along the same faces.
    obj.leaflight_look.box = None


MAKERS = {"exploded": exploded, "several_cuts": several_cuts}

if __name__ == "__main__":
    main()
