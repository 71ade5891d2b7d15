# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python stands.py -- FOLDER: repeats steps that once froze the
window.

A lit scan with a noisy background is opened again, operators that use the bake are pressed, the
isovalue moves into the noise, and a picture is rendered. Prints a line WINDOW and a JSON object.
Each step has the longest freeze and the function of Leaflight during it. The step into the noise
also has the first number of triangles. "beside walls": see beside_walls().
"""

import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import bpy
import hand
import heartbeat
import numpy as np
import seen
import stepwise
from leaflight_addon.bake import live
from leaflight_addon.export import export_bake
from leaflight_addon.operators import jobs
from leaflight_addon.show import surface_object, walls
from leaflight_addon.store import cache, reading

FOLDER = Path(sys.argv[-1])
NODES = 96
# Isovalues of the blob, and of the noise around it.
BLOB, NOISE = 50.0, 5.0

found = {}


def main():
    hand.draw_quickly()
    x = np.linspace(-1.0, 1.0, NODES)
    distance = np.sqrt(x[:, None, None] ** 2 + x[:, None] ** 2 + x**2)
    noise = np.random.default_rng(1).normal(NOISE, 2.0, distance.shape)
    np.save(FOLDER / "scan.npy", np.where(distance < 0.6, 100.0 - 100.0 * distance, noise))
    stepwise.run(drive(), found)


def drive():
    yield from stepwise.wait(1.0)
    beat = heartbeat.Heartbeat()
    yield from light()
    for name, step in (
        ("reopened", reopen),
        ("beside walls", beside_walls),
        ("among noise", go_among_noise),
        ("rendered", render),
        ("deleted", delete),
        ("without walls", open_without_walls),
    ):
        print(f"Step: {name}", flush=True)
        beat.start()
        result = yield from step()
        yield from settle()
        found[name] = {"seconds": beat.seconds, "where": beat.where, "found": result}


def light():
    hand.stage_file(FOLDER / "scan.npy", 2.0, 60.0, BLOB)
    hand.press(bpy.ops.leaflight.bake)
    yield from settle()
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "scene.blend"))


def reopen():
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "scene.blend"))
    yield from hand.steps(2)


def beside_walls():
    """Works after a file is opened, when the walls have no light yet.

    Returns the steps that "waited" for it in Blender's thread, the "box", the "size" of a page and
    whether "live" was at work. "walls" counts lit walls when they are needed, after a rendering and
    at the end; "status" are texts of the status bar.
    """
    may_go_on, with_walls, result = threading.Event(), reading.with_walls, reading.Reading.result
    step, waited, status, shown = "", [], [], {}

    def record(begun, *arguments):
        if threading.current_thread().name != "Leaflight" and begun.is_alive():
            waited.append(step)
            may_go_on.set()
        return result(begun, *arguments)

    reading.with_walls = lambda *read: may_go_on.wait() and with_walls(*read)
    reading.Reading.result = record
    bpy.types.WorkSpace.status_text_set = lambda _workspace, text: status.append(text)
    for step, press in (
        ("box", add_box),
        ("size", see_size),
        ("picture", render),
        ("live", go_live),
    ):
        shown[step] = yield from press()
    step = "walls"
    bpy.context.scene.leaflight.show_walls = False
    bpy.context.scene.leaflight.show_walls = True
    shown["walls"] = [len(seen.displays("wall"))]
    yield from stepwise.until(lambda: status or waited)
    step = "dark picture"
    yield from render()
    shown["walls"] += [len(seen.displays("wall"))]
    may_go_on.set()
    yield from stepwise.until(lambda: not cache._readings and None in status)
    shown["walls"] += [len(seen.displays("wall"))]
    yield from stepwise.until(lambda: page_size() != shown["size"])
    shown["size"] = [shown["size"], page_size()]
    lighting = [text for text in status if text and text.endswith("Lighting walls")]
    return {**shown, "waited": waited, "status": [lighting[:1], status[-1:]]}


def add_box():
    with hand.in_view():
        bpy.ops.leaflight.add_clip_box()
    yield from hand.steps(2)
    return seen.volume().leaflight_look.box is not None


def see_size():
    yield from hand.steps(1)
    return page_size()


def page_size():
    return export_bake.LEAFLIGHT_OT_export_page._size(SimpleNamespace(coarser=0), seen.volume())


def go_live():
    """Moves a lamp and restores it; returns whether Live was at work."""
    lamp = hand.lamp()
    bpy.context.scene.leaflight_live = True
    lamp.location.x += 0.1
    yield from hand.steps(8)
    was_at_work = live.at_work() is not None
    bpy.context.scene.leaflight_live = False
    lamp.location.x -= 0.1
    yield from stepwise.until(lambda: live.at_work() is None)
    return was_at_work


def go_among_noise():
    """Moves the isovalue into the noise; returns the first number of triangles."""
    seen.volume().leaflight["isovalue"] = NOISE
    seen.volume().update_tag()
    bpy.context.view_layer.update()
    triangles = len(seen.volume().data.polygons)
    yield from hand.steps(2)
    return triangles


def render():
    done = []
    bpy.app.handlers.render_complete.append(lambda *_: done.append(True))
    hand.render()
    yield from stepwise.until(lambda: done)


def delete():
    """Returns the numbers of volumes, lit walls and objects that these hide, after each key."""
    hand.select_volume()
    states = []
    for key, modifiers in (
        (hand.DELETE, {}),
        ("Z", {"ctrl": True}),
        ("Z", {"ctrl": True, "shift": True}),
        ("Z", {"ctrl": True}),
    ):
        yield from hand.key(key, **modifiers)
        yield from hand.steps(8)
        hidden = sum(map(walls.is_hidden, bpy.context.scene.objects))
        states.append([len(seen.volumes()), len(seen.displays("wall")), hidden])
    return states


def open_without_walls():
    """Returns whether a thread lights the walls of a bake that has none."""
    seen.volume().leaflight.light_walls = False
    hand.press(bpy.ops.leaflight.bake)
    yield from settle()
    bpy.ops.wm.save_mainfile()
    begun, with_walls = [], reading.with_walls
    reading.with_walls = lambda *read: begun.append(True) or with_walls(*read)
    yield from reopen()
    return cache.bake_of(seen.volume()) is None or bool(begun)


def settle():
    yield from hand.steps(8)
    coarse = lambda: surface_object.is_coarse(seen.volume().data)  # noqa: E731
    yield from stepwise.until(lambda: jobs.running() is None and not coarse())


main()
