# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the surface follows its isovalue: slider, keyframe, driver, render, undo, saved
file.
"""

import sys

import bpy
import numpy as np
import pytest
from blends import open_blend, open_saved
from leaflight import _core
from leaflight_addon import versions
from leaflight_addon.show import properties
from leaflight_addon.store import cache
from leaflight_addon.ui import handlers
from tools import (
    ADDON,
    assert_shows,
    close,
    edit_as_the_slider_does,
    look_down,
    mesh_arrays,
    render_exr,
    to_world,
)


def _animate(obj):
    """Animates the isovalue linearly from 40 at frame 1 to 120 at frame 11."""
    for frame, isovalue in ((1, 40.0), (11, 120.0)):
        obj.leaflight.isovalue = isovalue
        obj.keyframe_insert(properties.ISOVALUE_PATH, frame=frame)
    (curve,) = versions.fcurves(obj)
    for key in curve.keyframe_points:
        key.interpolation = "LINEAR"


def check_slider_before_the_bake(bumps):
    for isovalue in (30.0, 100.0):
        edit_as_the_slider_does(bumps, isovalue)
        assert_shows(bumps, isovalue)


def check_slider_and_script(baked):
    for isovalue in (30.0, 47.0, 100.0):
        edit_as_the_slider_does(baked, isovalue)
        assert_shows(baked, isovalue)
    for isovalue in (60.0, 33.0):
        baked.leaflight.isovalue = isovalue
        assert_shows(baked, isovalue)


def check_keyframes(baked):
    _animate(baked)
    for frame, isovalue in ((1, 40.0), (6, 80.0), (11, 120.0), (2, 48.0)):
        bpy.context.scene.frame_set(frame)
        assert_shows(baked, isovalue)


def check_driver(baked):
    driver = baked.driver_add(properties.ISOVALUE_PATH).driver
    variable = driver.variables.new()
    variable.name = "height"
    target = variable.targets[0]
    target.id = bpy.data.objects["floor"]
    target.data_path = "scale.z"
    driver.expression = "20 + 30 * height"
    bpy.context.view_layer.update()
    assert_shows(baked, 50.0)
    bpy.data.objects["floor"].scale.z = 2.0
    bpy.context.view_layer.update()
    assert_shows(baked, 80.0)


def check_driver_by_frame(baked):
    driver = baked.driver_add(properties.ISOVALUE_PATH).driver
    driver.expression = "30 + 10 * frame"
    for frame in (2, 5):
        bpy.context.scene.frame_set(frame)
        assert_shows(baked, 30.0 + 10.0 * frame)


@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def check_every_frame_of_a_rendered_animation(uncut, baked, tmp_path, engine):
    """Checks that the frames of one render command equal separate stills."""
    scene = bpy.context.scene
    baked.leaflight.shading = "ATTRIBUTE"
    bpy.data.objects["ceiling"].hide_render = True
    look_down(5.0, 2.2)
    stills = {}
    for frame, isovalue in ((2, 48.0), (9, 104.0)):
        baked.leaflight.isovalue = isovalue
        stills[frame] = render_exr(tmp_path / f"still{frame}.exr", engine)
    assert np.abs(stills[2] - stills[9]).max() > 0.01

    _animate(baked)
    scene.frame_set(1)
    scene.frame_start, scene.frame_end, scene.frame_step = 2, 9, 7
    scene.render.filepath = str(tmp_path / "frame####")
    shown = {}

    def remember(scene, *_):
        shown[scene.frame_current] = mesh_arrays(bpy.data.objects[baked.name])[0]

    bpy.app.handlers.render_post.append(remember)
    try:
        bpy.ops.render.render(animation=True)
    finally:
        bpy.app.handlers.render_post.remove(remember)
    for frame, isovalue in ((2, 48.0), (9, 104.0)):
        frame_pixels = _core.read_exr(str(tmp_path / f"frame{frame:04}.exr"))
        close(frame_pixels, stills[frame], 1e-4)
        expected = _core.contour(cache.volume_of(baked).field(), isovalue)[0]
        close(shown[frame], expected, 1e-5)
    assert scene.render.use_lock_interface


def check_undo_and_redo(baked):
    name = baked.name
    bpy.ops.ed.undo_push(message="start")
    baked.leaflight.isovalue = 40.0
    bpy.ops.ed.undo_push(message="forty")
    # In the user interface, the surface follows after the undo step is stored.
    baked.leaflight["isovalue"] = 90.0
    bpy.ops.ed.undo_push(message="ninety")
    baked.update_tag()
    bpy.context.view_layer.update()
    assert_shows(bpy.data.objects[name], 90.0)
    bpy.ops.ed.undo()
    assert bpy.data.objects[name].leaflight.isovalue == 40.0
    assert_shows(bpy.data.objects[name], 40.0)
    bpy.ops.ed.redo()
    assert bpy.data.objects[name].leaflight.isovalue == 90.0
    assert_shows(bpy.data.objects[name], 90.0)


def check_a_saved_scene_scrubs_on_from_the_bake_on_disk(uncut, baked, tmp_path, bump_file):
    path = tmp_path / "scene.blend"
    name = baked.name
    baked.leaflight.isovalue = 70.0
    before = mesh_arrays(baked)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bump_file.unlink()
    bpy.ops.wm.read_homefile(use_empty=True)
    assert not cache._bakes and not cache._volumes
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects[name]
    after = mesh_arrays(obj)
    assert obj.leaflight.isovalue == 70.0
    for a, b in zip(after, before):
        np.testing.assert_array_equal(a, b)
    obj.leaflight.isovalue = 50.0
    vertices, _, radiance = mesh_arrays(obj)
    surface = cache.bake_of(obj).surface(50.0)
    close(to_world(obj, vertices), surface.vertices, 1e-5)
    close(radiance, surface.radiance, 1e-3 * radiance.max())


def check_a_folder_with_scene_and_bake_can_be_moved(boxed, tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    open_saved(here / "scene.blend").leaflight.bake_folder = "//bakes"
    bpy.ops.leaflight.bake()
    bpy.ops.wm.save_mainfile()
    here.rename(there)
    obj = open_blend(there / "scene.blend")
    obj.leaflight.isovalue = 81.0
    assert_shows(obj, 81.0)
    image = next(i for i in bpy.data.images if i.source == "FILE")
    assert image.has_data or len(image.pixels) > 0


def check_the_saved_file_does_not_hold_the_volume(baked, tmp_path):
    path = tmp_path / "scene.blend"
    baked.leaflight.isovalue = 250.0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    assert path.stat().st_size < 2_000_000


@pytest.mark.skipif(
    sys.platform == "win32", reason="the next start of Blender would lack the package"
)
def check_disabling_the_addon_removes_its_handlers_and_enabling_brings_them_back(baked):
    def ours():
        events = (name for name, _ in handlers._HANDLERS)
        return [
            handler
            for event in events
            for handler in getattr(bpy.app.handlers, event)
            if handler.__module__.startswith(f"{ADDON}.")
        ]

    assert len(ours()) == len(handlers._HANDLERS)
    bpy.ops.preferences.addon_disable(module=ADDON)
    assert not ours() and not hasattr(bpy.types.Object, "leaflight")
    assert not hasattr(bpy.types, "LEAFLIGHT_OT_bake")
    bpy.ops.preferences.addon_enable(module=ADDON)
    assert hasattr(bpy.types.Object, "leaflight")
    bpy.data.objects[baked.name].leaflight.isovalue = 66.0
