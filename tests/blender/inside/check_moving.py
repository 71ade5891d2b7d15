# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the surface is coarse while the isovalue moves, and has full detail at rest, in
renders and in scripts.
"""

import bpy
import numpy as np
import pytest
from leaflight import _core
from leaflight_addon.show import isovalues, properties, surface_object, whole_detail
from leaflight_addon.stage import scene_export, staleness
from leaflight_addon.store import cache
from leaflight_addon.ui import bake_panel
from passes import drawn
from tools import (
    Clock,
    assert_shows,
    close,
    edit_as_the_slider_does,
    expected_surface,
    look_down,
    render_exr,
    rest,
    tick,
    vertices_of,
)

MOST = 250


@pytest.fixture
def large(monkeypatch):
    """Lowers the limit of triangles, so that a small surface is too large to move in full
    detail.
    """
    monkeypatch.setattr(surface_object, "MOVING_TRIANGLES", MOST)


def _field_misses(obj, isovalue):
    """Returns the RMS distance of the vertices from the isosurface, in voxels."""
    field = cache.volume_of(obj).field()
    points = vertices_of(obj)
    values = field.sample(points)
    steps = [field.sample(points + 1e-3 * axis) - values for axis in np.eye(3)]
    slopes = np.linalg.norm(steps, axis=0) / 1e-3
    return np.sqrt(np.nanmean(((values - isovalue) / slopes) ** 2)) / 1.0


def check_it_is_coarse_while_it_moves_and_whole_at_rest(baked, interactive, large):
    assert len(baked.data.polygons) > 2 * MOST
    for isovalue in (50.0, 60.0, 40.0):
        edit_as_the_slider_does(baked, isovalue)
        mesh = baked.data
        assert surface_object.is_coarse(mesh) and "radiance" in mesh.attributes
        assert 50 < len(mesh.polygons) < 0.4 * len(expected_surface(baked, isovalue)[1])
        assert _field_misses(baked, isovalue) < 0.01
        assert surface_object.shown_isovalue(baked) == isovalue
    moved = whole_detail.time.now
    rest()
    assert whole_detail.time.now - moved > whole_detail.PAUSE
    assert_shows(baked, 40.0)


def check_a_surface_that_is_small_moves_between_nodes(baked, interactive):
    """Checks that its edges are not split at steps of the light."""
    edit_as_the_slider_does(baked, 50.0)
    vertices = _core.contour(cache.volume_of(baked).field(), 50.0)[0]
    close(vertices_of(baked), vertices, 1e-6)
    rest()
    assert len(vertices_of(baked)) > 1.1 * len(vertices)
    assert_shows(baked, 50.0)


def check_without_light_what_is_small_is_never_coarse(bumps, interactive):
    edit_as_the_slider_does(bumps, 50.0)
    assert_shows(bumps, 50.0)
    assert not whole_detail._jobs


def check_before_the_bake_too(bumps, interactive, large):
    edit_as_the_slider_does(bumps, 60.0)
    assert surface_object.is_coarse(bumps.data)
    rest()
    assert_shows(bumps, 60.0)


def check_finer_texels_wait_for_rest(uncut, boxed, interactive):
    """Checks that texels finer than voxels split the mesh only at rest."""
    boxed.leaflight.resolution = 47
    bpy.ops.leaflight.bake()
    whole = len(boxed.data.polygons)
    edit_as_the_slider_does(boxed, boxed.leaflight.isovalue + 1.0)
    assert surface_object.is_coarse(boxed.data)
    assert 0.2 * whole < len(boxed.data.polygons) < 0.3 * whole
    edit_as_the_slider_does(boxed, 60.0)
    rest()
    assert_shows(boxed, 60.0)


def check_a_move_ends_the_making_of_the_whole(baked, interactive, large):
    edit_as_the_slider_does(baked, 50.0)
    tick()
    assert whole_detail._jobs[baked.name]._work is None
    whole_detail.time.now += whole_detail.PAUSE
    tick()
    assert whole_detail._jobs[baked.name]._work is not None
    edit_as_the_slider_does(baked, 60.0)
    assert whole_detail._jobs[baked.name]._work is None
    rest()
    assert_shows(baked, 60.0)


def check_without_a_window_it_is_always_whole(baked, large):
    for isovalue in (50.0, 60.0):
        edit_as_the_slider_does(baked, isovalue)
        assert_shows(baked, isovalue)


def check_scripts_get_it_whole(baked, interactive, large):
    edit_as_the_slider_does(baked, 50.0)
    baked.leaflight.isovalue = 60.0
    assert_shows(baked, 60.0)


def check_a_frame_that_is_chosen_is_whole(baked, interactive, large):
    for frame, isovalue in ((1, 40.0), (11, 60.0)):
        baked.leaflight.isovalue = isovalue
        baked.keyframe_insert(properties.ISOVALUE_PATH, frame=frame)
    bpy.context.scene.frame_set(11)
    assert_shows(baked, 60.0)
    bpy.context.scene.frame_set(1)
    assert_shows(baked, 40.0)


def check_a_render_is_whole(baked, interactive, large, tmp_path):
    look_down(5.0, 2.2)
    edit_as_the_slider_does(baked, 50.0)
    assert surface_object.is_coarse(baked.data)
    render_exr(tmp_path / "still.exr")
    assert_shows(baked, 50.0)
    assert not surface_object.is_coarse(baked.data)
    assert not whole_detail._jobs


def check_vertices_where_light_steps_do_not_make_it_large(baked, interactive, monkeypatch):
    edit_as_the_slider_does(baked, 50.0)
    between_nodes = len(baked.data.polygons)
    rest()
    assert len(baked.data.polygons) > 1.1 * between_nodes
    monkeypatch.setattr(surface_object, "MOVING_TRIANGLES", between_nodes)
    edit_as_the_slider_does(baked, 50.1)
    assert len(baked.data.polygons) > 0.9 * between_nodes


def check_undo_keeps_the_coarse_surface(baked, interactive, large):
    """Checks that an undo step keeps the surface of the moment when the slider is released."""
    name = baked.name
    bpy.ops.ed.undo_push(message="start")
    edit_as_the_slider_does(baked, 50.0)
    bpy.ops.ed.undo_push(message="fifty")
    rest()
    edit_as_the_slider_does(baked, 60.0)
    bpy.ops.ed.undo_push(message="sixty")
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    assert surface_object.is_coarse(obj.data)
    assert surface_object.shown_isovalue(obj) == 50.0
    rest()
    assert_shows(obj, 50.0)


@pytest.fixture
def exports(monkeypatch):
    """Returns a list that records the exports of the scene."""
    found = []
    export = scene_export.export_scene

    def counted(*arguments):
        found.append(arguments)
        return export(*arguments)

    monkeypatch.setattr(scene_export, "export_scene", counted)
    return found


@pytest.mark.parametrize("ramp", [False, True])
def check_a_scrub_step_reads_no_scene(baked, interactive, exports, ramp):
    if ramp:
        for _ in range(2):
            bpy.ops.leaflight.add_stop()
            edit_as_the_slider_does(baked, baked.leaflight.isovalue + 5.0)
        baked.leaflight.isosurface_stops[0].color = (0.1, 0.2, 0.3)
        bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, baked) == ""
    exports.clear()
    for isovalue in (50.0, 60.0, 70.0):
        edit_as_the_slider_does(baked, isovalue)
        bpy.context.view_layer.update()
        drawn(bake_panel.LEAFLIGHT_PT_bake)
        assert staleness.change_since_bake(bpy.context, baked) == ""
    assert not exports
    edit_as_the_slider_does(baked, 55.0)
    baked.location.x += 1.0
    bpy.context.view_layer.update()
    assert "bake again" in staleness.change_since_bake(bpy.context, baked)
    assert len(exports) == 1


def check_a_move_of_place_and_isovalue_together_is_noticed(baked):
    assert staleness.change_since_bake(bpy.context, baked) == ""
    baked.location.x += 1.0
    edit_as_the_slider_does(baked, 55.0)
    assert "bake again" in staleness.change_since_bake(bpy.context, baked)


def check_panels_tell_of_a_change_when_the_scene_rests(baked, exports, monkeypatch):
    class App:
        background = False
        timers = bpy.app.timers

    class Bpy:
        app, context, types = App, bpy.context, bpy.types

    clock = Clock()
    monkeypatch.setattr(staleness, "bpy", Bpy)
    monkeypatch.setattr(staleness, "time", clock)
    assert staleness.change_since_bake(bpy.context, baked) == ""
    exports.clear()
    bpy.data.objects["floor"].location.z -= 0.1
    bpy.context.view_layer.update()
    for _ in range(3):
        drawn(bake_panel.LEAFLIGHT_PT_bake)
    assert not exports
    assert staleness._look() == staleness.PAUSE and not exports
    clock.now += staleness.PAUSE
    assert staleness._look() is None and len(exports) == 1
    assert any("The scene has changed" in text for text in drawn(bake_panel.LEAFLIGHT_PT_bake))
    bpy.app.timers.unregister(staleness._look)


def check_handlers_leave_the_surfaces_alone_when_others_change(baked, monkeypatch):
    asked = []
    for name in ("update", "_show"):
        monkeypatch.setattr(isovalues, name, lambda *a: asked.append(a) or [])
    bpy.data.objects["floor"].location.z -= 0.1
    bpy.context.view_layer.update()
    bpy.data.objects["floor"].data.materials[0].diffuse_color = (1, 0, 0, 1)
    bpy.context.view_layer.update()
    assert not asked
    edit_as_the_slider_does(baked, 50.0)
    assert asked
