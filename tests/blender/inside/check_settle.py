# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces at rest: renders show light that was traced at the vertices, moves the bake's."""

import time

import bpy
import numpy as np
import pytest
from leaflight_addon.show import settling, surface_object
from leaflight_addon.store import cache
from tools import assert_shows, close, colours_of, look_down, render_exr, to_world, vertices_of


@pytest.fixture
def resting(baked):
    baked.leaflight.settle = True
    return baked


def _expected(obj, back=False):
    """Radiance of the settled surface, by the package itself."""
    return cache.bake_of(obj).surface(obj.leaflight.isovalue, back=back, settle=True).radiance


def _wait(obj, seconds=60):
    """Runs the timer of the background work as Blender's event loop would, until it ends."""
    end = time.monotonic() + seconds
    seen = []
    while settling._tick() is not None:
        seen.append(surface_object.settled_state(obj.data))
        assert time.monotonic() < end
        time.sleep(0.02)
    return seen


@pytest.fixture
def interactive(monkeypatch):
    """Checks run without a window, where nothing settles until a render asks for it."""

    class App:
        background = False
        timers = bpy.app.timers

    class Bpy:
        app, data = App, bpy.data

    monkeypatch.setattr(settling, "bpy", Bpy)
    monkeypatch.setattr(settling, "PAUSE", 0.05)
    yield
    settling.forget()
    if bpy.app.timers.is_registered(settling._tick):
        bpy.app.timers.unregister(settling._tick)


@pytest.mark.parametrize("shading", ["ATLAS", "ATTRIBUTE"])
def check_a_still_shows_the_settled_light(resting, tmp_path, shading):
    resting.leaflight.shading = shading
    for obj in bpy.context.scene.objects:
        obj.hide_render = obj != resting
    look_down(5.0, 2.0)
    resting.leaflight.settle = False
    before = render_exr(tmp_path / "baked.exr", size=32)[..., :3]
    baked = colours_of(resting)
    resting.leaflight.settle = True
    after = render_exr(tmp_path / "settled.exr", size=32)[..., :3]
    expected = _expected(resting)
    close(colours_of(resting), expected, 1e-6)
    assert surface_object.settled_state(resting.data) == (True, True)
    assert np.abs(expected - baked).max() > 0.05
    # What the camera sees changes with it.
    assert np.abs(after - before).max() > 0.02
    resting.leaflight.settle = False
    again = render_exr(tmp_path / "again.exr", size=32)[..., :3]
    close(again, before, 1e-4)


def check_a_move_shows_the_bake_again(resting):
    settling.settle_now([resting])
    assert surface_object.settled_state(resting.data) == (True, True)
    resting.leaflight.isovalue += 7.0
    assert surface_object.settled_state(resting.data) == (False, False)
    assert_shows(resting, resting.leaflight.isovalue)


def check_without_a_render_a_background_blender_settles_nothing(resting):
    settling.watch([resting])
    assert not settling._jobs


def check_a_surface_at_rest_settles_in_the_background(resting, interactive):
    settling.watch([resting])
    seen = _wait(resting)
    assert (True, True) not in seen[:1]
    assert surface_object.settled_state(resting.data) == (True, True)
    close(colours_of(resting), _expected(resting), 1e-6)
    settling.watch([resting])
    assert not settling._jobs


def check_a_move_ends_the_work_at_once(resting, interactive):
    settling.watch([resting])
    while settling._jobs[resting.name_full]._work is None:
        settling._tick()
    work = settling._jobs[resting.name_full]._work
    resting.leaflight.isovalue += 7.0
    start = time.monotonic()
    settling.watch([resting])
    work.wait(5.0)
    assert not work.is_alive() and time.monotonic() - start < 0.5
    assert_shows(resting, resting.leaflight.isovalue)
    _wait(resting)
    assert surface_object.settled_state(resting.data) == (True, True)


def check_the_setting_off_brings_the_bake_back(resting, interactive):
    settling.settle_now([resting])
    resting.leaflight.settle = False
    assert surface_object.settled_state(resting.data) == (False, False)
    assert_shows(resting, resting.leaflight.isovalue)
    settling.watch([resting])
    assert not settling._jobs


def check_both_sides_settle(boxed):
    boxed.leaflight.both_sides = True
    bpy.ops.leaflight.bake()
    boxed.leaflight.settle = True
    settling.settle_now([boxed])
    for name, back in (("radiance", False), ("radiance_back", True)):
        close(colours_of(boxed, name), _expected(boxed, back), 1e-6)


def check_a_moved_object_keeps_the_light_of_its_bake(resting):
    settling.settle_now([resting])
    before = colours_of(resting).copy()
    resting.location.x += 3.0
    bpy.context.view_layer.update()
    isovalue = resting.leaflight.isovalue
    resting.leaflight.isovalue = isovalue + 1.0
    resting.leaflight.isovalue = isovalue
    settling.settle_now([resting])
    close(colours_of(resting), before, 1e-6)
    assert len(to_world(resting, vertices_of(resting))) == len(before)
