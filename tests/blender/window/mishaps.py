# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python mishaps.py -- FOLDER: repeats the input that once
triggered bugs.

Prints a line WINDOW and a JSON object of the results. Writes pictures of the viewport to the
folder.
"""

import os
import sys
from pathlib import Path

import bpy
import leaflight
import mathutils
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from leaflight_addon.bake import continue_bake, stopped
from leaflight_addon.operators import failures, jobs
from leaflight_addon.stage import camera
from leaflight_addon.store import cache
from leaflight_addon.ui import clip_outline

sys.path.insert(0, os.path.dirname(__file__))
import gate  # noqa: E402
import hand  # noqa: E402
import stepwise  # noqa: E402

FOLDER = Path(sys.argv[-1])
# Target error in percent that no bake reaches.
UNREACHED = 0.01

found = {}


def main():
    view = bpy.context.preferences.view
    view.show_splash, view.ui_scale = False, 1.0
    view.filebrowser_display_type = "SCREEN"
    np.save(FOLDER / "bumps.npy", leaflight.bump_box(24).values)
    (FOLDER / "text.nrrd").write_text("This is no volume.\n")
    gate.install()
    stepwise.run(drive(), found)


def drive():
    yield from stepwise.wait(1.0)
    for row in (
        bake_before_stage,
        turn_up_and_front,
        continue_a_bake,
        keep_the_light_of_walls,
        close_the_window_of_a_bake,
        delete_the_volume_of_a_bake,
        import_what_is_no_volume,
        see_the_clip_box,
    ):
        print(f"Row: {row.__name__}", flush=True)
        yield from row()


# ---- The rows ----


def bake_before_stage():
    yield from open_volume()
    before = view().shading.type
    volume().leaflight.error = 20.0
    press(bpy.ops.leaflight.bake)
    yield from until_free()
    scene = bpy.context.scene
    found["bake before stage"] = {
        "before": before,
        "shading": view().shading.type,
        "cube": bpy.data.objects["Cube"].hide_render,
        "camera": scene.camera.name,
        "lit": bool(volume().leaflight.bake_id),
    }


def turn_up_and_front():
    for name, axis in (("up", "POS_Y"), ("front", "POS_X")):
        with over_viewport():
            setattr(volume().leaflight_orientation, name, axis)
        yield from stepwise.wait(0.5)
        found[f"turned {name}"] = {
            "perspective": view().region_3d.view_perspective,
            "camera": bpy.context.scene.camera.name,
            "height": height_in_frame(),
        }


def continue_a_bake():
    yield from open_volume(stages=True)
    volume().leaflight.error, volume().leaflight.light_walls = 20.0, False
    press(bpy.ops.leaflight.bake)
    yield from until_free()
    first = volume().leaflight.bake_id
    volume().leaflight.error = 0.4 * volume().leaflight.bake_error
    volume().leaflight.bake_needs_texels = False
    press(getattr(bpy.ops.leaflight, continue_bake.suited(volume()).bl_idname.partition(".")[2]))
    yield from until_free()
    found["continued"] = {
        "another": volume().leaflight.bake_id != first,
        "failure": failures.sentence(),
        "free": bpy.ops.leaflight.bake.poll(),
    }


def keep_the_light_of_walls():
    volume().leaflight.light_walls = True
    yield from begin_bake()
    yield from escape()
    press(bpy.ops.leaflight.keep_bake)
    yield from until_free()
    bake = cache.bake_of(volume())
    found["kept"] = {
        "walls": bake.walls is not None or "walls" in volume().leaflight.bake_warnings,
        "lit walls": bake.walls is not None,
    }


def close_the_window_of_a_bake():
    manager = bpy.context.window_manager
    with over_viewport():
        bpy.ops.wm.window_new()
    yield from stepwise.wait(1.0)
    second = manager.windows[-1]
    yield from begin_bake(second)
    work = jobs.running()
    with bpy.context.temp_override(window=second):
        bpy.ops.wm.window_close()
    yield from stepwise.until(lambda: len(manager.windows) == 1)
    yield from stepwise.wait(1.0)
    goes_on = jobs.running() is work and work.is_alive() and not work.progress.cancelled
    found["window closed"] = {"goes on": goes_on}
    yield from escape()
    found["window closed"]["offered"] = stopped.offered() is not None
    press(bpy.ops.leaflight.throw_bake_away)
    yield from stepwise.wait(0.2)


def delete_the_volume_of_a_bake():
    yield from begin_bake()
    hand.bind(hand.DELETE, "object.delete", {"confirm": False})
    with over_viewport():
        bpy.ops.object.select_all(action="DESELECT")
        volume().select_set(True)
        bpy.ops.ed.undo_push(message="Selected")
    yield from hand.key(hand.DELETE)
    yield from until_free()
    found["deleted"] = {"sentence": failures.sentence(), "offered": stopped.offered() is not None}
    # Esc closes the popup of the error, which receives all keys.
    yield from hand.key("ESC")
    yield from hand.key("Z", ctrl=True)
    yield from stepwise.wait(1.0)
    found["deleted"]["undone"] = volume() is not None and not failures.sentence()


def import_what_is_no_volume():
    with over_viewport():
        bpy.ops.leaflight.import_volume("INVOKE_DEFAULT", filepath=str(FOLDER / "text.nrrd"))
    yield from stepwise.until(lambda: browser() is not None)
    yield from stepwise.wait(2.0)
    with bpy.context.temp_override(window=window(), area=browser()):
        bpy.ops.file.execute()
    yield from stepwise.wait(1.0)
    found["no volume"] = {"free": jobs.running() is None}


def see_the_clip_box():
    yield from open_volume(stages=True)
    press(bpy.ops.leaflight.add_clip_box)
    area = view_area()
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
        "overlays": view().overlay.show_overlays,
        "pixels": int(change.sum()),
    }


# ---- The window ----


def open_volume(stages=False):
    """Opens the factory scene and imports the bump box, as a new user would."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield from stepwise.wait(0.5)
    with over_viewport():
        bpy.ops.leaflight.import_volume(filepath=str(FOLDER / "bumps.npy"))
    # Use few texels, because the quality of the light does not matter.
    volume().leaflight.resolution = 9
    yield from stepwise.wait(0.3)
    if stages:
        press(bpy.ops.leaflight.stage)
        yield from stepwise.wait(0.3)


def begin_bake(where=None):
    """Presses Bake in a window; the bake waits after its first pass, which is shown."""
    settings = volume().leaflight
    # With a short time limit, walls are lit coarsely.
    settings.error, settings.use_time_limit, settings.time_limit = UNREACHED, True, 1.0
    gate.close("pass")
    press(bpy.ops.leaflight.bake, where)
    yield from stepwise.until(lambda: gate.reached and job().latest is not None)


def until_free():
    yield from stepwise.wait(0.3)
    yield from stepwise.until(lambda: jobs.running() is None)


def escape():
    yield from hand.key("ESC")
    yield from until_free()


def press(operator, where=None):
    with over_viewport(where):
        operator("INVOKE_DEFAULT")


def job():
    return jobs.running()._job


def volume():
    return next((obj for obj in bpy.context.scene.objects if obj.leaflight.is_volume), None)


def height_in_frame():
    """Returns the share of the camera frame's height that the isosurface's large parts fill."""
    scene = bpy.context.scene
    places = map(mathutils.Vector, camera.shown_points([volume()]))
    heights = [world_to_camera_view(scene, scene.camera, place)[1] for place in places]
    return max(heights) - min(heights)


def window():
    return bpy.context.window_manager.windows[0]


def view_area(of_window=None):
    areas = (of_window or window()).screen.areas
    return max((a for a in areas if a.type == "VIEW_3D"), key=lambda a: a.width, default=None)


def view():
    return view_area().spaces.active


def browser():
    for each in bpy.context.window_manager.windows:
        for area in each.screen.areas:
            if area.type == "FILE_BROWSER" and area.spaces.active.active_operator is not None:
                return area
    return None


def over_viewport(where=None):
    where = where or window()
    area = view_area(where) or where.screen.areas[0]
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=where, area=area, region=region)


main()
