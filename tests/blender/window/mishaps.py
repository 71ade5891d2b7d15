# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python mishaps.py -- FOLDER: repeats the input that once
triggered bugs.

Prints a line WINDOW and a JSON object of the results. Writes pictures of the viewport to the
folder.
"""

import sys
from pathlib import Path

import bpy
import gate
import hand
import leaflight
import mathutils
import numpy as np
import stepwise
from bpy_extras.object_utils import world_to_camera_view
from leaflight_addon.bake import stopped
from leaflight_addon.operators import failures, jobs
from leaflight_addon.stage import camera
from leaflight_addon.store import cache
from leaflight_addon.ui import clip_outline

FOLDER = Path(sys.argv[-1])
# Target error in percent that no bake reaches.
UNREACHED = 0.01

found = {}


def main():
    np.save(FOLDER / "bumps.npy", leaflight.bump_box(24).values)
    (FOLDER / "text.nrrd").write_text("This is no volume.\n")
    gate.install()
    stepwise.run(drive(), found)


def drive():
    yield from stepwise.wait(1.0)
    for row in (
        bake_before_stage,
        turn_up_and_front,
        keep_the_light_of_walls,
        delete_the_volume_of_a_bake,
        import_what_is_no_volume,
        see_the_clip_box,
    ):
        print(f"Row: {row.__name__}", flush=True)
        yield from row()


# ---- The rows ----


def bake_before_stage():
    yield from open_volume()
    before = hand.view().spaces.active.shading.type
    hand.volume().leaflight.error = 20.0
    hand.press(bpy.ops.leaflight.bake)
    yield from until_free()
    scene = bpy.context.scene
    found["bake before stage"] = {
        "before": before,
        "shading": hand.view().spaces.active.shading.type,
        "cube": bpy.data.objects["Cube"].hide_render,
        "camera": scene.camera.name,
        "lit": bool(hand.volume().leaflight.bake_id),
    }


def turn_up_and_front():
    for name, axis in (("up", "POS_Y"), ("front", "POS_X")):
        with hand.in_view():
            setattr(hand.volume().leaflight_orientation, name, axis)
        yield from stepwise.wait(0.5)
        found[f"turned {name}"] = {
            "perspective": hand.view().spaces.active.region_3d.view_perspective,
            "camera": bpy.context.scene.camera.name,
            "height": height_in_frame(),
        }


def keep_the_light_of_walls():
    hand.volume().leaflight.light_walls = True
    yield from begin_bake()
    yield from escape()
    hand.press(bpy.ops.leaflight.keep_bake)
    yield from until_free()
    bake = cache.bake_of(hand.volume())
    found["kept"] = {
        "walls": bake.walls is not None or "walls" in hand.volume().leaflight.bake_warnings,
        "lit walls": bake.walls is not None,
    }


def delete_the_volume_of_a_bake():
    yield from begin_bake()
    hand.select_volume()
    yield from hand.key(hand.DELETE)
    yield from until_free()
    found["deleted"] = {"sentence": failures.sentence(), "offered": stopped.offered() is not None}
    # Esc closes the popup of the error, which receives all keys.
    yield from hand.key("ESC")
    yield from hand.key("Z", ctrl=True)
    yield from stepwise.wait(1.0)
    found["deleted"]["undone"] = hand.volume() is not None and not failures.sentence()


def import_what_is_no_volume():
    with hand.in_view():
        bpy.ops.leaflight.import_volume("INVOKE_DEFAULT", filepath=str(FOLDER / "text.nrrd"))
    yield from hand.press_browser()
    yield from stepwise.wait(1.0)
    found["no volume"] = {"free": jobs.running() is None}


def see_the_clip_box():
    yield from open_volume(stages=True)
    hand.press(bpy.ops.leaflight.add_clip_box)
    area = hand.view()
    area.spaces.active.show_region_ui = True
    pictures = {}
    for is_open in (False, True):
        bpy.types.LEAFLIGHT_PT_clip.bl_options = set() if is_open else {"DEFAULT_CLOSED"}
        clip_outline._shown.clear()
        if is_open:
            clip_outline._shown.add(area.as_pointer())
        seen = {}
        yield from stepwise.pixels_of(area, seen)
        pictures[is_open] = seen["pixels"]
    change = np.abs(pictures[True] - pictures[False]).max(axis=-1) > 0.1
    found["clip box"] = {
        "overlays": hand.view().spaces.active.overlay.show_overlays,
        "pixels": int(change.sum()),
    }


# ---- The window ----


def open_volume(stages=False):
    """Opens the factory scene and imports the bump box, as a new user would."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield from stepwise.wait(0.5)
    with hand.in_view():
        bpy.ops.leaflight.import_volume(filepath=str(FOLDER / "bumps.npy"))
    # Use few texels, because the quality of the light does not matter.
    hand.volume().leaflight.resolution = 9
    yield from stepwise.wait(0.3)
    if stages:
        hand.press(bpy.ops.leaflight.stage)
        yield from stepwise.wait(0.3)


def begin_bake():
    """Presses Bake; the bake waits after its first pass, which is shown."""
    settings = hand.volume().leaflight
    # With a short time limit, walls are lit coarsely.
    settings.error, settings.use_time_limit, settings.time_limit = UNREACHED, True, 1.0
    gate.close("pass")
    hand.press(bpy.ops.leaflight.bake)
    yield from stepwise.until(lambda: gate.reached and job().latest is not None)


def until_free():
    yield from stepwise.wait(0.3)
    yield from stepwise.until(lambda: jobs.running() is None)


def escape():
    yield from hand.key("ESC")
    yield from until_free()


def job():
    return jobs.running()._job


def height_in_frame():
    """Returns the share of the camera frame's height that the isosurface's large parts fill."""
    scene = bpy.context.scene
    places = map(mathutils.Vector, camera.shown_points([hand.volume()]))
    heights = [world_to_camera_view(scene, scene.camera, place)[1] for place in places]
    return max(heights) - min(heights)


main()
