# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks Live: moved lamps, walls and volumes are lit at once, and the final light without a
click.
"""

import time

import bpy
import leaflight
import mathutils
import numpy as np
import pytest
from blends import reopened
from leaflight_addon.bake import live
from leaflight_addon.show import display, preview
from leaflight_addon.stage import staleness
from leaflight_addon.store import cache
from leaflight_addon.ui import bake_panel
from passes import drawn
from tools import assert_shows, change, close, colors_of, to_world, vertices_of

CHANGED = "The scene has changed since the bake: bake again"


class Held:
    """A hold on passes of live bakes, until a check releases or cancels them."""

    def __init__(self, monkeypatch):
        self.may_pass = False
        light = live.LiveJob._light

        def wait(job, on_pass, progress):
            while not self.may_pass and not progress.cancelled:
                time.sleep(0.005)
            return light(job, on_pass=on_pass, progress=progress)

        monkeypatch.setattr(live.LiveJob, "_light", wait)


@pytest.fixture
def held(monkeypatch):
    monkeypatch.setattr(live, "_is_in_window", lambda: True)
    yield Held(monkeypatch)
    work = live.at_work()
    live.forget()
    if work is not None:
        work.wait(None)
    if bpy.app.timers.is_registered(live._tick):
        bpy.app.timers.unregister(live._tick)


@pytest.fixture
def lit(passes, held):
    """Bakes a volume with its walls, and switches Live on."""
    passes.leaflight.error = 20.0
    passes.leaflight.resolution = 16
    passes.leaflight.light_walls = True
    bpy.ops.leaflight.bake()
    bpy.context.scene.leaflight_live = True
    finish(held)
    assert live.at_work() is None and preview.of(passes) is None
    return passes


def lamp():
    return bpy.data.objects["lamp"]


def move_lamp(by=(0.4, -0.3, -0.2)):
    """Moves the lamp; returns its previous position."""
    before = tuple(lamp().location)
    put_lamp(np.add(before, by))
    return before


def put_lamp(place):
    lamp().location = place
    bpy.context.view_layer.update()


def tick():
    """Runs one step as Blender's event loop would."""
    live._tick()
    time.sleep(0.005)


def to_passes():
    """Waits until the direct light of the newest position is shown, and passes wait."""
    tick()
    work = live.at_work()
    while not (live._job is not None and live._job._can_be_cancelled and has_lit_walls()):
        assert live.at_work() is not None
        tick()
    tick()
    return work


def has_lit_walls():
    return live._job.latest is not None and live._job.latest.walls is not None


def finish(held):
    held.may_pass = True
    while live._tick() is not None:
        time.sleep(0.005)
    held.may_pass = False


def baked_anew(obj):
    """Returns a new bake of the present scene."""
    job = live.LiveJob(bpy.context, obj)
    return leaflight.bake(**job._arguments)


def walls():
    found = [obj for obj in bpy.context.scene.objects if display.is_display(obj, "wall")]
    return np.concatenate([colors_of(wall) for wall in found])


def assert_shows_moved(obj, fresh):
    """Checks for new direct light, equal bit by bit, over the indirect light of the bake."""
    shown = preview.of(obj).bake
    assert shown.is_moved and shown.original is cache.bake_of(obj)
    points = len(fresh.grid.direct.light_points)
    for point in range(points):
        ours, theirs = (one.grid.direct.codes(point) for one in (shown, fresh))
        np.testing.assert_array_equal(ours, theirs)
    expected = shown.radiance(to_world(obj, vertices_of(obj)))
    close(colors_of(obj), expected, 1e-4 * expected.max())
    far = np.abs(colors_of(obj) - fresh.radiance(to_world(obj, vertices_of(obj)))).mean()
    assert far < 0.1 * expected.mean()


def check_a_lamp_that_moves_lights_at_once_and_finally(lit, held):
    before, bake_id, on_walls = colors_of(lit), lit.leaflight.bake_id, walls()
    vertices = vertices_of(lit)
    move_lamp()
    fresh = baked_anew(lit)
    to_passes()
    assert_shows_moved(lit, fresh)
    # The mesh stays, and only its light changes.
    close(vertices_of(lit), vertices, 0)
    assert np.abs(colors_of(lit) - before).max() > 0.2 * before.max()
    assert np.abs(walls() - on_walls).max() > 0.2 * on_walls.max()
    assert lit.leaflight.bake_id == bake_id and change(lit) == CHANGED
    texts = drawn(bake_panel.LEAFLIGHT_PT_bake)
    assert "leaflight.stop_live" in texts and CHANGED not in texts
    finish(held)
    assert cache.bake_of(lit).id == fresh.id != bake_id
    assert change(lit) == "" and preview.of(lit) is None
    assert_shows(lit, 50.0)
    expected = [fresh.walls.radiance(m, 50.0) for m in range(fresh.walls.count)]
    close(walls(), np.concatenate(expected), 1e-5)
    assert "leaflight.stop_live" not in drawn(bake_panel.LEAFLIGHT_PT_bake)


def check_where_pictures_take_long_they_wait_for_direct_light(lit, held, monkeypatch):
    monkeypatch.setattr(live, "_picture", 60.0)
    monkeypatch.setattr(live, "_LONGEST_WAIT", 60.0)
    move_lamp()
    live._tick()
    assert preview.of(lit).bake.is_moved
    finish(held)


def check_the_newest_place_wins(lit, held):
    move_lamp()
    first = to_passes()
    job = live._job
    move_lamp((-0.6, 0.1, 0.0))
    fresh = baked_anew(lit)
    while live._job is job:
        tick()
    assert not first.is_alive() and first.progress.cancelled
    to_passes()
    assert_shows_moved(lit, fresh)
    finish(held)
    assert cache.bake_of(lit).id == fresh.id


def check_back_where_it_was_the_bake_is_shown(lit, held):
    before, on_walls, bake_id = colors_of(lit), walls(), lit.leaflight.bake_id
    place = move_lamp()
    to_passes()
    put_lamp(place)
    finish(held)
    assert live.at_work() is None and preview.of(lit) is None
    assert lit.leaflight.bake_id == bake_id
    close(colors_of(lit), before, 1e-5)
    close(walls(), on_walls, 1e-5)


def check_walls_and_the_volume_move(lit, held):
    wall = next(obj for obj in bpy.context.scene.objects if obj.get("leaflight_baked_as"))
    name = wall.name
    wall.location.z -= 0.1
    bpy.context.view_layer.update()
    fresh = baked_anew(lit)
    to_passes()
    assert_shows_moved(lit, fresh)
    shown = bpy.data.objects[f"{name} Lit"]
    index = shown["leaflight_wall"]
    expected = preview.of(lit).bake.walls.mesh(index)[0]
    close([vertex.co for vertex in shown.data.vertices], expected, 1e-5)
    lit.location.z += 0.05
    bpy.context.view_layer.update()
    fresh = baked_anew(lit)
    while live._job is None or live._job.fingerprint != live.LiveJob(bpy.context, lit).fingerprint:
        tick()
    to_passes()
    assert_shows_moved(lit, fresh)
    finish(held)
    assert cache.bake_of(lit).id == fresh.id and change(lit) == ""


def check_a_cut_follows_its_box(lit, held):
    bpy.ops.leaflight.add_clip_box()
    box, bake_id = lit.leaflight_look.box, lit.leaflight.bake_id
    bpy.ops.leaflight.cut_data(cut="capped")
    whole = vertices_of(lit)
    assert change(lit) == staleness.CUT
    estimated = colors_of(lit)[:, :3].mean(axis=1)
    assert estimated.min() > 0.02 * estimated.mean()
    finish(held)
    first = cache.bake_of(lit).id
    assert first != bake_id and change(lit) == ""
    # Direct light of the moved cut is exact, and passes follow.
    box.location -= mathutils.Vector((0.1, 0.1, 0.1))
    bpy.context.view_layer.update()
    assert len(vertices_of(lit)) != len(whole) and preview.of(lit) is None
    fresh = baked_anew(lit)
    to_passes()
    assert_shows_moved(lit, fresh)
    # The newest place wins.
    box.location += mathutils.Vector((0.05, 0.0, 0.0))
    bpy.context.view_layer.update()
    assert preview.of(lit) is None
    fresh = baked_anew(lit)
    finish(held)
    assert cache.bake_of(lit).id == fresh.id != first and change(lit) == ""
    assert_shows(lit, 50.0)


def check_stop_leaves_it_until_something_moves(lit, held):
    move_lamp()
    work = to_passes()
    shown = colors_of(lit)
    bpy.ops.leaflight.stop_live()
    finish(held)
    assert not work.is_alive() and live.at_work() is None
    close(colors_of(lit), shown, 0)
    assert "earlier position" in " ".join(drawn(bake_panel.LEAFLIGHT_PT_bake))
    # Moving an object that lights nothing must not restart the bake.
    live.changed(bpy.context.scene)
    finish(held)
    close(colors_of(lit), shown, 0)
    move_lamp((0.05, 0.0, 0.0))
    finish(held)
    assert change(lit) == "" and live.sentence() == ""
    assert_shows(lit, 50.0)


def check_light_that_cannot_be_shown_leaves_that_of_the_bake(lit, held, monkeypatch):
    def broken(_):
        raise leaflight.LeaflightError("broken on purpose")

    before = colors_of(lit)
    monkeypatch.setattr(live.LiveJob, "apply", broken)
    move_lamp()
    finish(held)
    assert "broken on purpose" in live.sentence() and preview.of(lit) is None
    close(colors_of(lit), before, 0)


def check_undo_and_redo(lit, held):
    before, bake_id = colors_of(lit), lit.leaflight.bake_id
    bpy.ops.ed.undo_push(message="baked")
    move_lamp()
    bpy.ops.ed.undo_push(message="moved")
    finish(held)
    after, new = colors_of(lit), lit.leaflight.bake_id
    assert new != bake_id
    bpy.ops.ed.undo()
    finish(held)
    obj = bpy.context.object
    assert obj.leaflight.bake_id == bake_id and change(obj) == ""
    close(colors_of(obj), before, 1e-5)
    bpy.ops.ed.redo()
    finish(held)
    obj = bpy.context.object
    assert obj.leaflight.bake_id == new and change(obj) == ""
    close(colors_of(obj), after, 1e-5)


def check_a_file_that_was_saved_meanwhile_is_not_final(uncut, lit, held, tmp_path):
    before, bake_id = colors_of(lit), lit.leaflight.bake_id
    move_lamp()
    to_passes()
    obj = reopened(tmp_path / "scene.blend")
    # The bake belongs to the previous position, and the panel says so.
    assert bpy.context.scene.leaflight_live and obj.leaflight.bake_id == bake_id
    assert change(obj) == CHANGED
    # The file stores half precision.
    close(colors_of(obj), before, 1e-3 * before.max())
    # Live must continue.
    to_passes()
    assert preview.of(obj).bake.is_moved
    finish(held)
    assert change(obj) == "" and obj.leaflight.bake_id != bake_id


def check_what_cannot_be_live_says_so(lit, held):
    before = colors_of(lit)
    high, lit.leaflight.high = lit.leaflight.high, 55.0
    place = move_lamp()
    finish(held)
    assert "isovalue range" in live.sentence()
    assert live.sentence() in " ".join(drawn(bake_panel.LEAFLIGHT_PT_bake))
    close(colors_of(lit), before, 1e-5)
    lit.leaflight.high = high
    put_lamp(place)
    finish(held)
    assert live.sentence() == "" and change(lit) == ""


def check_scripts_and_other_scenes_are_left_alone(passes, held, monkeypatch):
    scene = bpy.context.scene
    scene.leaflight_live = True
    move_lamp()
    assert live._tick() is None and live.at_work() is None
    passes.leaflight.error = 20.0
    passes.leaflight.resolution = 16
    bpy.ops.leaflight.bake()
    finish(held)
    scene.leaflight_live = False
    move_lamp()
    assert live._tick() is None and change(passes) == CHANGED
    monkeypatch.setattr(live, "_is_in_window", lambda: False)
    scene.leaflight_live = True
    move_lamp()
    assert not live._has_changed and live._tick() is None
