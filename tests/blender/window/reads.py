# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --enable-event-simulate --python reads.py -- FOLDER: opens .blend files whose bake, or
volume, takes long to read, and works meanwhile.

A gate holds the thread that reads. Prints a line WINDOW and a JSON object of the state in each step
while the thread is held ("held") and afterwards.
"""

import sys
import threading
from pathlib import Path

import bpy
import hand
import numpy as np
import seen
import sidebar
import stepwise
from leaflight_addon.bake import live
from leaflight_addon.show import distribution, surface_object, walls
from leaflight_addon.store import cache, reading, source_files

FOLDER = Path(sys.argv[-1])
NODES = 32
# Isovalues in the saved file, and after a drag while the file is read.
SAVED, DRAGGED = 50.0, 60.0

found = {}
# Texts of the status bar since the last file was opened.
status = []


class Gate:
    """A gate for functions that read a file, (path, progress, ...), which wait until it opens.

    reads: for each call "thread", or "window" if it would freeze the window.
    """

    def __init__(self):
        self._is_open, self.reads = threading.Event(), []

    def close(self):
        self._is_open.clear()
        self.reads.clear()

    def open(self):
        self._is_open.set()

    def holds(self, read):
        def held(path, *more, **choices):
            if threading.current_thread() is threading.main_thread():
                self.reads.append("window")
                return read(path, *more, **choices)
            self.reads.append("thread")
            while not self._is_open.wait(0.01):
                more[0].check()
            return read(path, *more, **choices)

        return held


gate = Gate()


def main():
    hand.draw_quickly()
    x = np.linspace(-1.0, 1.0, NODES)
    distance = np.sqrt(x[:, None, None] ** 2 + x[:, None] ** 2 + x**2)
    np.save(FOLDER / "ball.npy", 100.0 - 60.0 * distance)
    stepwise.run(drive(), found)


def drive():
    yield from stepwise.wait(1.0)
    yield from make()
    bpy.types.WorkSpace.status_text_set = lambda _workspace, text: status.append(text)
    reading.open_bake = gate.holds(reading.open_bake)
    source_files.read_volume = gate.holds(source_files.read_volume)
    for name, step in (
        ("dragged", drag),
        ("unlit", drag_unlit),
        ("pressed", press),
        ("live", go_live),
        ("rendered", render),
        ("deleted", delete),
        ("left", leave),
        ("damaged", damage),
    ):
        print(f"Step: {name}", flush=True)
        found[name] = yield from step()


def make():
    """Saves the unlit volume, and the volume with a bake that lights walls."""
    hand.stage_file(FOLDER / "ball.npy", 20.0, 80.0, SAVED)
    with hand.in_view():
        bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "unlit.blend"))
        bpy.ops.leaflight.bake()
    yield from hand.steps(2)
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "lit.blend"))


def open_held(name):
    """Opens a .blend whose files are held, and drags the isovalue."""
    gate.close()
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / f"{name}.blend"))
    status.clear()
    yield from hand.steps(2)
    set_isovalue(DRAGGED)
    yield from hand.steps(8)


def set_isovalue(isovalue):
    seen.volume().leaflight["isovalue"] = isovalue
    seen.volume().update_tag()
    bpy.context.view_layer.update()


def release():
    """Releases the thread, and yields until everything is shown."""
    gate.open()
    yield from stepwise.until(lambda: not cache._readings)
    yield from hand.steps(8)
    yield from stepwise.until(lambda: not surface_object.is_coarse(seen.volume().data))


def shown():
    """Returns the isovalue of the mesh, whether its bake lights it, and the problems."""
    obj = seen.volume()
    isovalue = float(surface_object.shown_isovalue(obj))
    return {
        "isovalue": isovalue,
        "lit": is_lit(obj),
        "problems": [*surface_object.problems.values()],
    }


def is_lit(obj):
    """True if the vertices have the radiance of the bake."""
    mesh, bake = obj.data, cache._bakes.get(obj.leaflight.bake_id)
    if "radiance" not in mesh.attributes or bake is None:
        return False
    vertices, colors = (
        np.empty(3 * len(mesh.vertices), np.float32),
        np.empty(4 * len(mesh.vertices)),
    )
    mesh.vertices.foreach_get("co", vertices)
    mesh.attributes["radiance"].data.foreach_get("color", colors)
    expected = bake.grid.lookup(cache.volume_of(obj).field(), vertices.reshape(-1, 3))
    return bool(np.abs(colors.reshape(-1, 4)[:, :3] - expected).max() < 1e-3 * expected.max())


def refused(operator, **options):
    """Returns the error of an operator."""
    try:
        with hand.in_view():
            operator("INVOKE_DEFAULT", **options)
    except RuntimeError as error:
        return str(error)
    return ""


def drag():
    """Drags the isovalue with the sidebar open; "walls" counts those that show its light."""
    yield from open_held("lit")
    sidebar.show_all_panels()
    is_drawn = yield from sidebar.is_drawn()
    obj = seen.volume()
    held = {
        **shown(),
        "sidebar": is_drawn,
        "asked": obj.leaflight["isovalue"],
        "distribution": distribution.of(obj) is not None,
        "walls": lit_walls(),
        "reads": list(gate.reads),
        "status": status[-1:],
    }
    yield from release()
    yield from stepwise.until(lambda: distribution.of(seen.volume()) is not None)
    return {"held": held, **shown(), "walls": lit_walls(), "status": status[-1:]}


def lit_walls():
    """Returns the number of walls, and the number with the light of the volume's isovalue."""
    label, displays = walls._label(seen.volume()), walls._displays(bpy.context.scene)
    isovalue = repr(float(seen.volume().leaflight["isovalue"]))
    right = [obj for obj in displays if obj.data["leaflight_shown"] == label]
    return [len(displays), len(right) if label.startswith(isovalue) else 0]


def drag_unlit():
    yield from open_held("unlit")
    held = {**shown(), "reads": list(gate.reads), "status": status[-1:]}
    yield from release()
    return {"held": held, **shown(), "status": status[-1:]}


def press():
    """Presses buttons; returns their answers and the state afterwards."""
    yield from open_held("lit")
    answers = {
        "add": refused(bpy.ops.leaflight.add_isosurface),
        "box": refused(bpy.ops.leaflight.add_clip_box),
        "bake": refused(bpy.ops.leaflight.bake),
        "continue": refused(bpy.ops.leaflight.continue_bake),
    }
    export = FOLDER / "ball.am"
    refused(bpy.ops.leaflight.export, filepath=str(export), file_type=".am", asked=True)
    yield from hand.steps(4)
    held = {**shown(), "exported": export.exists(), "at work": seen.SEEN["at work"]()}
    yield from release()
    yield from stepwise.until(lambda: not seen.SEEN["at work"]())
    # Scripts wait for the file.
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "lit.blend"))
    with hand.in_view():
        bpy.ops.leaflight.add_isosurface()
    added = len(seen.SEEN["isosurfaces"]())
    yield from release()
    return {
        "held": held,
        "answers": answers,
        "exported": export.exists(),
        "added": added,
        **shown(),
    }


def go_live():
    """Switches Live on, and moves a lamp."""
    yield from open_held("lit")
    bpy.context.scene.leaflight_live = True
    hand.lamp().location.x += 0.1
    yield from hand.steps(8)
    held = {"live": live.at_work() is not None, "sentence": live.sentence()}
    gate.open()
    yield from stepwise.until(lambda: live.at_work() is not None)
    begun = {"live": live.at_work() is not None, "sentence": live.sentence()}
    bpy.context.scene.leaflight_live = False
    yield from stepwise.until(lambda: live.at_work() is None)
    return {"held": held, "begun": begun}


def render():
    """Renders; "pictures" have the isovalue and the light of their mesh."""
    yield from open_held("lit")
    pictures = []
    look = lambda *_: pictures.append(picture())  # noqa: E731
    bpy.app.handlers.render_post.append(look)
    hand.render()
    yield from hand.steps(10)
    held = list(pictures)
    gate.open()
    yield from stepwise.until(lambda: pictures)
    bpy.app.handlers.render_post.remove(look)
    yield from stepwise.until(lambda: not bpy.app.is_job_running("RENDER"))
    yield from release()
    return {"held": held, "pictures": pictures, **shown()}


def picture():
    return {**shown(), "coarse": surface_object.is_coarse(seen.volume().data), "walls": lit_walls()}


def delete():
    """Deletes the object and undoes that, before and after the thread is released."""
    yield from open_held("lit")
    hand.select_volume()
    for _ in range(2):
        yield from hand.key(hand.DELETE)
        yield from hand.steps(4)
        held = len(seen.volumes())
        yield from hand.key("Z", ctrl=True)
        yield from hand.steps(4)
    yield from hand.key(hand.DELETE)
    gate.open()
    yield from stepwise.until(lambda: not cache._readings)
    gone = len(seen.volumes())
    yield from hand.key("Z", ctrl=True)
    yield from release()
    return {"volumes": [held, gone, len(seen.volumes())], **shown()}


def leave():
    """Opens another file: the thread must end without reading further."""
    yield from open_held("lit")
    begun = next(iter(cache._readings.values()))
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "unlit.blend"))
    yield from stepwise.until(lambda: not begun.is_alive())
    yield from hand.steps(8)
    return {"opened": begun.found is not None, "status": status[-1:], **shown()}


def damage():
    """Simulates a damaged file, and a bug in the reader."""
    read, results = reading.open_bake, []
    for error in (reading.LeaflightError("The file is damaged."), RuntimeError("of a bug")):
        reading.open_bake = gate.holds(fails_with(error))
        yield from open_held("lit")
        gate.open()
        yield from stepwise.until(lambda: surface_object.problems)
        yield from hand.steps(20)
        results.append({**shown(), "reads": list(gate.reads)})
    reading.open_bake = read
    return results


def fails_with(error):
    def fails(*_):
        raise error

    return fails


main()
