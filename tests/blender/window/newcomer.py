# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python newcomer.py -- VOLUME FOLDER: goes from the factory
scene to a lit isosurface by counted mouse clicks, and beyond.

Writes pictures of the viewport to the folder. Prints a line WINDOW and a JSON object of the results
of each step. The file browser gets the path of the file.
"""

import os
import sys
import time
from pathlib import Path

import bpy
import hand
import numpy as np
import stepwise
from leaflight import blender
from leaflight_addon.bake import bake, stopped
from leaflight_addon.operators import failures, jobs
from leaflight_addon.show import surface_object, whole_detail

VOLUME, FOLDER = sys.argv[-2], Path(sys.argv[-1])
# Pixels from the upper border of the window to the entry Import in the menu File.
IMPORT = 295 if bpy.app.version < (5, 0, 0) else 311

found = {"clicks": 0}


def drive():
    yield from stepwise.wait(1.0)
    yield from import_by_menu()
    yield from stage_and_bake()
    yield from stop_and_keep()
    yield from undo_and_redo()
    yield from save_and_load()
    yield from copy_and_delete()
    yield from play()


# ---- The four clicks ----


def import_by_menu():
    found["objects"] = sorted(obj.name for obj in bpy.data.objects)
    top = hand.window().height
    # Start below Blender's own entries.
    for row in (*range(9, 40), *range(9)):
        # Open File, then move down to Import, whose submenu opens under the mouse, and to an entry.
        yield from click((46, top - 13))
        yield from stepwise.wait(0.4)
        x, y = 80, top - IMPORT
        yield from move((x, y))
        yield from stepwise.wait(0.5)
        # Move to the right first, because crossing other entries would open theirs.
        for place in ((x + 200, y), (x + 200, y - 21 * row)):
            yield from move(place)
        yield from click(None)
        yield from stepwise.wait(0.8)
        operator = chosen_operator()
        if operator is not None and operator.bl_idname == "LEAFLIGHT_OT_import_volume":
            break
        yield from key("ESC")
        yield from key("ESC")
        yield from stepwise.wait(0.3)
    else:
        raise RuntimeError("The menu Import has no volume for Leaflight.")
    # Do not count the clicks of the search.
    found["clicks"] = 2
    area = next(area for area in hand.window().screen.areas if area.type == "FILE_BROWSER")
    parameters = area.spaces.active.params
    parameters.directory = os.path.dirname(VOLUME).encode()
    parameters.filename = os.path.basename(VOLUME)
    with bpy.context.temp_override(window=hand.window(), area=area):
        bpy.ops.file.execute()
    yield from stepwise.until(lambda: hand.volume() is not None)
    yield from stepwise.wait(1.0)


def chosen_operator():
    for area in hand.window().screen.areas:
        if area.type == "FILE_BROWSER":
            return area.spaces.active.active_operator
    return None


def stage_and_bake():
    yield from click(header_button(275))
    yield from stepwise.until(lambda: "backdrop" in bpy.data.objects)
    yield from stepwise.wait(2.0)
    found["staged"] = {
        "hidden": sorted(o.name for o in bpy.data.objects if o.hide_render),
        "camera": bpy.context.scene.camera.name,
        "perspective": hand.view().spaces.active.region_3d.view_perspective,
        "shading": hand.view().spaces.active.shading.type,
        "overlays": hand.view().spaces.active.overlay.show_overlays,
    }
    passes = note_passes()
    yield from click(header_button(386))
    yield from stepwise.until(lambda: jobs.running() is not None)
    yield from stepwise.until(lambda: jobs.running() is None)
    print("baked", flush=True)
    found["bake"] = {
        "passes": len(passes),
        "lit": "radiance" in hand.volume().data.attributes,
        "clicks": found["clicks"],
        "failure": failures.sentence(),
    }
    yield from stepwise.until(lambda: not surface_object.is_coarse(hand.volume().data))
    yield from stepwise.wait(1.0)
    yield from take_pictures()


def note_passes():
    """Returns the set of passes that the next bake shows; the bake waits until each is shown."""
    shown, light, show = set(), bake.BakeJob._light, bake.BakeJob.show

    def until_shown(job, on_pass, progress):
        def hold(baked):
            on_pass(baked)
            while job._shown is not baked and not progress.cancelled:
                time.sleep(0.01)

        bake.BakeJob._light = light
        return light(job, on_pass=hold, progress=progress)

    def note(job):
        show(job)
        label = surface_object.label_of(hand.volume().data) or ""
        shown.update({label} if '"pass ' in label else ())

    bake.BakeJob._light, bake.BakeJob.show = until_shown, note
    return shown


def take_pictures():
    """Takes pictures of the window, and of the camera's view with and without the volume."""
    with bpy.context.temp_override(window=hand.window()):
        bpy.ops.screen.screenshot(filepath=str(FOLDER / "screen.png"))
    yield from stepwise.wait(0.5)
    scene = bpy.context.scene
    scene.render.resolution_percentage = 50
    for name, hidden in (("with.png", False), ("without.png", True)):
        hand.volume().hide_set(hidden)
        yield from stepwise.wait(1.0)
        picture(FOLDER / name)
    hand.volume().hide_set(False)


def picture(path):
    scene = bpy.context.scene
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = str(path)
    with hand.in_view():
        bpy.ops.render.opengl(write_still=True, view_context=True)


# ---- What follows ----


def stop_and_keep():
    first = hand.volume().leaflight.bake_id
    # Ask for more work than anyone waits for.
    hand.volume().leaflight.error = 0.01
    hand.volume().leaflight.use_resolution = False
    yield from click(header_button(386))
    yield from stepwise.until(lambda: jobs.running() is not None)
    yield from stepwise.until(
        lambda: '"pass ' in (surface_object.label_of(hand.volume().data) or "")
    )
    yield from key("ESC")
    start = time.perf_counter()
    yield from stepwise.until(lambda: jobs.running() is None)
    found["stopped"] = {
        "seconds": time.perf_counter() - start,
        "offered": stopped.offered() is not None,
        "bake": hand.volume().leaflight.bake_id == first,
    }
    # Keep Bake replaces Bake, once the header is drawn. A busy machine draws it late, and takes
    # clicks later still; a second one would bake again.
    yield from stepwise.wait(1.0)
    while stopped.offered() is not None:
        yield from click(header_button(386))
        end = time.perf_counter() + 60
        yield from stepwise.until(
            lambda end=end: jobs.running() is not None or time.perf_counter() > end
        )
        yield from stepwise.until(lambda: jobs.running() is None)
    yield from stepwise.until(lambda: hand.volume().leaflight.bake_id != first)
    yield from stepwise.until(lambda: jobs.running() is None)
    found["first"], found["second"] = first, hand.volume().leaflight.bake_id


def undo_and_redo():
    def bake_id():
        return hand.volume().leaflight.bake_id

    yield from stepwise.wait(1.0)
    second = bake_id()
    yield from key("Z", ctrl=True)
    yield from stepwise.until(lambda: bake_id() != second)
    found["undone"] = bake_id()
    yield from stepwise.wait(1.0)
    yield from key("Z", ctrl=True, shift=True)
    yield from stepwise.until(lambda: bake_id() != found["undone"])
    found["redone"] = bake_id()
    yield from stepwise.wait(1.0)


def save_and_load():
    path = FOLDER / "saved" / "head.blend"
    path.parent.mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    yield from stepwise.wait(0.5)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    yield from stepwise.wait(3.0)
    obj = hand.volume()
    radiance = np.empty(4 * len(obj.data.vertices), np.float32)
    obj.data.attributes["radiance"].data.foreach_get("color", radiance)
    found["loaded"] = {
        "bake": obj.leaflight.bake_id,
        "path": obj.leaflight.bake_path,
        "brightest": float(radiance.reshape(-1, 4)[:, :3].max()),
        "problem": surface_object.problems.get(obj.name_full, ""),
    }


def copy_and_delete():
    first = hand.volume()
    name, isovalue = first.name, first.leaflight.isovalue
    other = isovalue + 0.3 * (first.leaflight.high - isovalue)
    with hand.in_view():
        bpy.ops.object.select_all(action="DESELECT")
        first.select_set(True)
        bpy.context.view_layer.objects.active = first
        bpy.ops.object.duplicate()
    yield from stepwise.wait(0.5)
    copy = bpy.context.view_layer.objects.active
    copy.leaflight.linked = False
    copy.leaflight.isovalue = other
    yield from stepwise.wait(1.0)
    found["copied"] = {
        "names": copy.name != name,
        "original": surface_object.shown_isovalue(bpy.data.objects[name]) == isovalue,
        "copy": abs(surface_object.shown_isovalue(copy) - other) < 1e-4,
    }
    with hand.in_view():
        bpy.ops.object.delete()
    yield from stepwise.wait(0.5)
    found["deleted"] = [o.name for o in bpy.context.scene.objects if o.leaflight.is_volume] == [
        name
    ]
    whole_detail.forget()


def play():
    """Plays an animation through the isovalue range."""
    obj, scene = hand.volume(), bpy.context.scene
    isovalues = np.linspace(obj.leaflight.bake_low, obj.leaflight.bake_high, 24)
    blender.animate(obj, isovalues)
    yield from stepwise.wait(1.0)
    with hand.in_view():
        bpy.ops.screen.animation_play()
    frames, off = set(), []

    def has_played():
        frames.add(scene.frame_current)
        expected = isovalues[scene.frame_current - 1]
        off.append(abs(surface_object.shown_isovalue(obj) - expected))
        return len(frames) > 5

    yield from stepwise.until(has_played)
    with hand.in_view():
        bpy.ops.screen.animation_cancel(restore_frame=False)
    yield from stepwise.until(lambda: not surface_object.is_coarse(obj.data))
    found["played"] = {
        "frames": len(frames),
        "off": float(max(off)) / float(isovalues[-1] - isovalues[0]),
        "lit": "radiance" in obj.data.attributes,
    }
    whole_detail.forget()


# ---- The window and the mouse ----


def header_button(x):
    """Returns the position of a button above the viewport, at this many pixels from the left."""
    region = hand.region("TOOL_HEADER")
    return region.x + x, region.y + region.height // 2


_mouse = [0, 0]


def move(place):
    """Moves the mouse in small steps, because menus judge its direction."""
    for k in range(1, 5):
        x, y = (round(a + (b - a) * k / 4) for a, b in zip(_mouse, place))
        hand.window().event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
        yield 0.03
    _mouse[:] = place


def click(place):
    if place is not None:
        yield from move(place)
    for value in ("PRESS", "RELEASE"):
        hand.window().event_simulate(type="LEFTMOUSE", value=value, x=_mouse[0], y=_mouse[1])
        yield 0.1
    found["clicks"] += 1


def key(name, **modifiers):
    """Presses a key over the middle of the viewport."""
    areas = [area for area in hand.window().screen.areas if area.type == "VIEW_3D"]
    if areas:
        yield from move((areas[0].x + areas[0].width // 2, areas[0].y + areas[0].height // 2))
    for value in ("PRESS", "RELEASE"):
        hand.window().event_simulate(type=name, value=value, x=_mouse[0], y=_mouse[1], **modifiers)
        yield 0.1


stepwise.run(drive(), found)
