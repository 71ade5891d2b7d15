# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces at rest: renders show light that was traced at the vertices, moves the bake's."""

import time

import bpy
import leaflight
import numpy as np
import pytest
from leaflight_addon.show import settling, surface_object
from leaflight_addon.store import cache
from tools import (
    assert_shows,
    close,
    colours_of,
    look_down,
    render_exr,
    rest,
    tick,
    to_world,
    vertices_of,
)


@pytest.fixture
def resting(baked):
    baked.leaflight.settle = True
    return baked


def _expected(obj, back=False):
    """Radiance of the settled surface, by the package itself."""
    return cache.bake_of(obj).surface(obj.leaflight.isovalue, back=back, settle=True).radiance


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
    # The same mesh, whose edges were cut in two.
    assert len(expected) > 10 * len(baked)
    assert np.abs(expected[: len(baked)] - baked).max() > 0.05
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
    seen = rest(resting)
    assert (True, True) not in seen[:1]
    assert surface_object.settled_state(resting.data) == (True, True)
    close(colours_of(resting), _expected(resting), 1e-6)
    settling.watch([resting])
    assert not settling._jobs


def _settle_and_move(obj):
    """The work on a surface that has come to rest, after the next move."""
    settling.watch([obj])
    while settling._jobs[obj.name_full]._work is None:
        tick()
    work = settling._jobs[obj.name_full]._work
    obj.leaflight.isovalue += 7.0
    settling.watch([obj])
    return work


def check_a_move_ends_the_work(resting, interactive, monkeypatch):
    refine = settling._Job._refine

    def after_the_move(job, surface, progress):
        while not progress.cancelled:
            time.sleep(0.005)
        refine(job, surface, progress)

    with monkeypatch.context() as patch:
        patch.setattr(settling._Job, "_refine", after_the_move)
        work = _settle_and_move(resting)
        with pytest.raises(leaflight.Cancelled):
            work.result()
    assert_shows(resting, resting.leaflight.isovalue)
    rest(resting)
    assert surface_object.settled_state(resting.data) == (True, True)


@pytest.mark.machine
def check_a_move_ends_the_work_at_once(resting, interactive):
    work = _settle_and_move(resting)
    moved = time.monotonic()
    work.wait(5.0)
    assert not work.is_alive() and time.monotonic() - moved < 0.5


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


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-0.5, 0.7, 0.9)])
def check_an_object_baked_off_the_origin_stays_where_it_is(boxed, scale):
    boxed.location, boxed.rotation_euler = (0.1, -0.1, 0.05), (0.05, 0.1, 0.3)
    boxed.scale = np.multiply(boxed.scale, scale)
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    moving = vertices_of(boxed)
    facing = _volume_inside(boxed)
    boxed.leaflight.settle = True
    settling.settle_now([boxed])
    # Edges were cut in two, once or twice; the vertices that were there stay the first ones.
    assert len(vertices_of(boxed)) > 10 * len(moving)
    close(vertices_of(boxed)[: len(moving)], moving, 1e-5)
    assert 0.9 < _volume_inside(boxed) / facing < 1.1
    close(colours_of(boxed), _expected(boxed), 1e-6)


def _volume_inside(obj):
    """Signed volume between the triangles and the local origin."""
    obj.data.calc_loop_triangles()
    corners = np.empty((len(obj.data.loop_triangles), 3), np.int32)
    obj.data.loop_triangles.foreach_get("vertices", corners.ravel())
    a, b, c = np.moveaxis(vertices_of(obj)[corners], 1, 0).astype(np.float64)
    return np.einsum("ij,ij", a, np.cross(b, c)) / 6.0
