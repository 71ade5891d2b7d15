# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that walls show the light of the shown isosurface."""

import bpy
import numpy as np
import pytest
from blends import reopened
from leaflight_addon.show import display, preview, properties, surface_object, walls
from leaflight_addon.stage import scene_export, staleness
from leaflight_addon.store import cache
from tools import close, colors_of, render_exr


@pytest.fixture
def lit(boxed):
    boxed.leaflight.light_walls = True
    bpy.ops.leaflight.bake()
    return boxed


def displays():
    return [obj for obj in bpy.context.scene.objects if display.is_display(obj, "wall")]


def assert_walls_show(lit, c, tolerance=1e-5):
    bake = cache.bake_of(lit)
    assert len(displays()) == len(bake.scene.meshes) > 3
    for obj in displays():
        vertices, triangles = bake.walls.mesh(obj["leaflight_wall"])
        assert len(obj.data.polygons) == len(triangles)
        found = np.array([vertex.co for vertex in obj.data.vertices])
        close(found, vertices, 1e-5)
        for name, back in (("radiance", False), ("radiance_back", True)):
            expected = bake.walls.radiance(obj["leaflight_wall"], c, back=back)
            close(colors_of(obj, name), expected, tolerance)


def check_displays_stand_in_for_the_walls(lit):
    assert_walls_show(lit, lit.leaflight.isovalue)
    for obj in displays():
        original = bpy.data.objects[obj.name.removesuffix(" Lit")]
        assert original.hide_render and original.hide_get()
        assert not obj.hide_render and not obj.hide_get()
    assert not bpy.data.objects["lamp"].hide_render


def check_they_follow_slider_script_keyframes_and_drivers(lit):
    lit.leaflight["isovalue"] = 33.0
    lit.update_tag()
    bpy.context.view_layer.update()
    assert_walls_show(lit, 33.0)
    lit.leaflight.isovalue = 66.0
    assert_walls_show(lit, 66.0)
    for frame, isovalue in ((1, 40.0), (11, 90.0)):
        lit.leaflight.isovalue = isovalue
        lit.keyframe_insert(properties.ISOVALUE_PATH, frame=frame)
    bpy.context.scene.frame_set(1)
    assert_walls_show(lit, 40.0)
    bpy.context.scene.frame_set(11)
    assert_walls_show(lit, 90.0)
    lit.animation_data_clear()
    lit.driver_add(properties.ISOVALUE_PATH).driver.expression = "30 + 10 * frame"
    bpy.context.scene.frame_set(5)
    assert_walls_show(lit, 80.0)


def check_beyond_the_window_they_show_its_end(lit):
    low, high = cache.bake_of(lit).isovalues
    lit.leaflight.isovalue = 0.5 * (high + 255.0)
    assert_walls_show(lit, high)


@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def check_frames_of_an_animation_show_each_its_own_light(lit, tmp_path, engine):
    """Checks vertex colors of the left wall alone, seen from inside, frame by frame."""
    for obj in bpy.context.scene.objects:
        # Keep lamps, without which it would be dark.
        if obj.type != "LIGHT":
            obj.hide_render = obj.hide_render or obj.name != "left wall Lit"
    lit.hide_render = False
    scene = bpy.context.scene
    scene.frame_set(1)
    stills = {}
    for frame, isovalue in ((1, 40.0), (4, 90.0)):
        lit.leaflight.isovalue = isovalue
        stills[frame] = render_exr(tmp_path / "still.exr", engine, size=16)[..., :3]
    for frame, isovalue in ((1, 40.0), (4, 90.0)):
        lit.leaflight.isovalue = isovalue
        lit.keyframe_insert(properties.ISOVALUE_PATH, frame=frame)
    assert np.abs(stills[1] - stills[4]).max() > 1e-3
    scene.frame_set(2)
    scene.frame_start, scene.frame_end, scene.frame_step = 1, 4, 3
    scene.render.filepath = str(tmp_path / "frame####")
    bpy.ops.render.render(animation=True)
    from leaflight import _core

    for frame, still in stills.items():
        pixels = _core.read_exr(str(tmp_path / f"frame{frame:04}.exr"))[..., :3]
        close(pixels, still, 1e-4)


def check_the_next_bake_sees_the_walls_and_not_their_displays(lit):
    names = {mesh.name for mesh in cache.bake_of(lit).scene.meshes}
    description, _, warnings = scene_export.export_scene(bpy.context, lit)
    assert {mesh.name for mesh in description.meshes} == names and warnings == []
    assert staleness.change_since_bake(bpy.context, lit) == ""
    bpy.data.objects["floor"].location.z -= 0.1
    bpy.context.view_layer.update()
    assert "bake again" in staleness.change_since_bake(bpy.context, lit)
    bpy.ops.leaflight.bake()
    assert_walls_show(lit, lit.leaflight.isovalue)
    (floor,) = (obj for obj in displays() if obj.name.startswith("floor"))
    close(floor.data.vertices[0].co.z, bpy.data.objects["floor"].location.z, 1e-5)


def check_switched_off_and_on(lit):
    before = {obj.name: (obj.hide_render, obj.hide_get()) for obj in bpy.data.objects}
    meshes = len(bpy.data.meshes)
    bpy.context.scene.leaflight.show_walls = False
    assert not displays() and not any(walls.is_hidden(obj) for obj in bpy.data.objects)
    assert not any(obj.hide_render or obj.hide_get() for obj in bpy.data.objects)
    assert not [c for c in bpy.data.collections if c.name.startswith(walls.COLLECTION)]
    lit.leaflight.isovalue = 44.0
    bpy.context.scene.leaflight.show_walls = True
    assert_walls_show(lit, 44.0)
    assert {o.name: (o.hide_render, o.hide_get()) for o in bpy.data.objects} == before
    assert len(bpy.data.meshes) == meshes


def check_a_bake_without_walls_shows_the_walls_themselves(lit):
    lit.leaflight.light_walls = False
    bpy.ops.leaflight.bake()
    assert not displays() and not bpy.data.objects["floor"].hide_render


def check_undo(lit):
    name = lit.name
    lit.leaflight.isovalue = 40.0
    bpy.ops.ed.undo_push(message="forty")
    bpy.context.scene.leaflight.show_walls = False
    bpy.ops.ed.undo_push(message="off")
    bpy.ops.ed.undo()
    assert_walls_show(bpy.data.objects[name], 40.0)
    bpy.ops.ed.redo()
    assert not displays() and not bpy.data.objects["floor"].hide_render


def check_the_isosurface_that_is_seen_lights_them_in_a_saved_file_too(lit, tmp_path):
    lit.leaflight.isovalue = 40.0
    lit = reopened(tmp_path / "scene.blend")
    # The file of the bake stores half precision.
    assert_walls_show(lit, 40.0, 2e-3)
    lit.leaflight.isovalue = 70.0
    assert_walls_show(lit, 70.0)


def check_walls_are_of_the_same_pass_as_the_isosurface(lit):
    """Checks passes with and without light of the walls."""
    scene, other = bpy.context.scene, cache.bake_of(lit)
    lit.leaflight.seed += 1
    bpy.ops.leaflight.bake()
    c = lit.leaflight.isovalue
    assert_walls_show(lit, c)
    preview.put(lit, other, 0, [x for row in lit.matrix_world for x in row])
    walls.show_pass(scene)
    index = displays()[0]["leaflight_wall"]
    close(colors_of(displays()[0]), other.walls.radiance(index, c, back=False), 1e-5)
    surface_object.forget_passes()
    walls.refresh(scene)
    assert_walls_show(lit, c)
