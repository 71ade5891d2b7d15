# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks exploded views: places, light, animation, undo, renders, picks and exports."""

import bpy
import numpy as np
import pytest
from blends import reopened
from boxes import build_cornell_box
from leaflight_addon import versions
from leaflight_addon.compare import stills
from leaflight_addon.importing import regions
from leaflight_addon.show import surface_material, surface_object
from leaflight_addon.store import cache
from leaflight_addon.ui import look_panel
from mathutils import Vector
from passes import drawn
from tools import close, colors_of, imported_gltf, look_down, render_exr, rest, vertices_of

N = 24


@pytest.fixture
def balls(tmp_path):
    """Returns an object with two balls beside each other along x, in a Cornell box."""
    z, y, x = np.mgrid[:N, :N, :N]
    away = [np.sqrt((x - a) ** 2 + (y - 11.5) ** 2 + (z - 11.5) ** 2) for a in (6.0, 17.0)]
    np.save(tmp_path / "balls.npy", np.float32(100 - 10 * np.minimum(*away)))
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "balls.npy"))
    obj = bpy.context.object
    obj.leaflight.bake_folder = str(tmp_path / "bakes")
    obj.leaflight.error, obj.leaflight.resolution = 20.0, N
    obj.leaflight.low, obj.leaflight.high = 55.0, 70.0
    obj.leaflight.isovalue = 60.0
    build_cornell_box()
    bpy.ops.leaflight.bake()
    return obj


def _explode(obj, distance):
    obj.leaflight_look.explode_axis = "X"
    obj.leaflight_look.explode_distance = distance
    bpy.context.view_layer.update()


def _is_apart(obj, closed, distance):
    moved = vertices_of(obj) - closed
    close(moved[:, 0], np.sign(closed[:, 0]) * 0.5 * distance, 1e-4)
    return not moved[:, 1:].any()


def _ends(obj):
    """Returns the ends of an isosurface along x. Its light decides which edges are split."""
    return np.array([end(vertices_of(obj)[:, 0]) for end in (np.min, np.max)])


def check_parts_move_in_the_data(balls):
    closed = _ends(balls)
    _explode(balls, 8.0)
    assert bpy.ops.leaflight.move_parts() == {"FINISHED"}
    assert balls.leaflight_look.explode_axis == "NONE"
    close(_ends(balls), closed + [-4.0, 4.0], 1e-3)
    assert cache.volume_of(balls).values.shape == (N, N, N + 8)
    assert bpy.ops.leaflight.bake() == {"FINISHED"}
    close(_ends(balls), closed + [-4.0, 4.0], 1e-3)
    bpy.ops.leaflight.switch_region(index=0, action="SWITCH")
    close(_ends(balls), closed, 1e-3)


def check_parts_move_and_keep_their_light(balls, tmp_path):
    closed, light = vertices_of(balls), colors_of(balls)
    assert "explode_distance" not in drawn(look_panel.LEAFLIGHT_PT_isosurfaces)
    balls.leaflight_look.explode_axis = "X"
    assert "explode_distance" in drawn(look_panel.LEAFLIGHT_PT_isosurfaces)
    # At first the parts are a length of the volume apart.
    assert balls.leaflight_look.explode_distance == pytest.approx(N - 1)
    assert _is_apart(balls, closed, N - 1)
    close(colors_of(balls), light, 0)
    assert surface_material.shading_in_use(balls.leaflight)[0] == "ATTRIBUTE"
    balls.leaflight_look.explode_distance = 10.0
    assert _is_apart(balls, closed, 10.0)
    # Lamps relight the moved parts as the closed ones.
    (lamp,) = [obj for obj in bpy.data.objects if obj.type == "LIGHT"]
    lamp.data.energy *= 2
    bpy.context.view_layer.update()
    assert _is_apart(balls, closed, 10.0)
    close(colors_of(balls), 2 * light, 1e-5)
    lamp.data.energy /= 2
    balls.leaflight.isovalue = 65.0
    bpy.context.view_layer.update()
    other = vertices_of(balls)
    assert np.abs(other[:, 0]).min() > 5.0 and len(other) != len(closed)
    balls = reopened(tmp_path / "scene.blend")
    close(vertices_of(balls), other, 0)
    balls.leaflight_look.explode_axis = "NONE"
    balls.leaflight.isovalue = 60.0
    bpy.context.view_layer.update()
    close(vertices_of(balls), closed, 0)
    close(colors_of(balls), light, 1e-6)


def check_undo_and_a_copy(balls):
    closed, name = vertices_of(balls), balls.name
    bpy.ops.ed.undo_push(message="closed")
    _explode(balls, 8.0)
    bpy.ops.ed.undo_push(message="apart")
    bpy.ops.ed.undo()
    close(vertices_of(bpy.data.objects[name]), closed, 0)
    bpy.ops.ed.redo()
    balls = bpy.data.objects[name]
    assert _is_apart(balls, closed, 8.0)
    copy = balls.copy()
    bpy.context.collection.objects.link(copy)
    copy.leaflight_look.explode_distance = 4.0
    assert _is_apart(copy, closed, 4.0) and _is_apart(balls, closed, 8.0)


def check_keyframes_move_parts_in_both_renders(balls, tmp_path):
    closed = vertices_of(balls)
    _explode(balls, 0.0)
    look, path = balls.leaflight_look, "leaflight_look.explode_distance"
    for frame, distance in ((1, 0.0), (11, 10.0)):
        look.explode_distance = distance
        balls.keyframe_insert(path, frame=frame)
    for curve in versions.fcurves(balls):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    bpy.context.scene.frame_set(7)
    assert _is_apart(balls, closed, 6.0)
    for other in bpy.context.scene.objects:
        other.hide_render = other != balls and other.type != "LIGHT"
    bpy.context.scene.world = None
    look_down(5.0, 3.0)
    scale = balls.matrix_world.median_scale
    for engine in ("CYCLES", "EEVEE"):
        for frame in (1, 11):
            bpy.context.scene.frame_set(frame)
            seen = render_exr(tmp_path / f"{engine}{frame}.exr", engine)[..., :3].max(axis=-1)
            columns = np.flatnonzero(seen.max(axis=0) > 0.005)
            width = 3.0 / seen.shape[1] * np.ptp(columns)
            expected = scale * (np.ptp(closed[:, 0]) + frame - 1)
            assert abs(width - expected) < 0.15, engine


def check_a_pick_hits_the_part_where_it_was(balls):
    closed = vertices_of(balls)
    _explode(balls, 40.0)
    right = balls.matrix_world @ balls.data.vertices[int(np.argmax(closed[:, 0]))].co
    step = Vector((1.0, 0.0, 0.0))
    point = regions.surface_point(balls, right + step, -step)
    assert (
        np.linalg.norm(closed - balls.matrix_world.inverted() @ Vector(point), axis=1).min() < 0.5
    )
    bpy.ops.leaflight.remove_part(point=point)
    assert cache.volume_of(balls).values[:, :, 18:].max() < 60
    assert regions.surface_point(balls, right + step, step) is None


def check_a_coarse_surface_moves_too(balls, interactive, monkeypatch):
    monkeypatch.setattr(surface_object, "MOVING_TRIANGLES", 200)
    _explode(balls, 10.0)
    balls.leaflight["isovalue"] = 64.0
    balls.update_tag()
    bpy.context.view_layer.update()
    assert surface_object.is_coarse(balls.data)
    assert np.abs(vertices_of(balls)[:, 0]).min() > 5.0
    rest()
    assert not surface_object.is_coarse(balls.data)
    assert np.abs(vertices_of(balls)[:, 0]).min() > 5.0


def check_exports_are_exploded(balls, tmp_path, monkeypatch):
    _explode(balls, 12.0)
    path = tmp_path / "apart.glb"
    bpy.ops.leaflight.export(filepath=str(path))
    shown = np.array([balls.matrix_world @ v.co for v in balls.data.vertices])
    obj, *_ = imported_gltf(path, monkeypatch)
    written = np.array([obj.matrix_world @ v.co for v in obj.data.vertices])
    close(np.ptp(written, axis=0), np.ptp(shown, axis=0), 1e-4)
    bpy.ops.leaflight.export(filepath=str(tmp_path / "all.vti"), file_type=".vti")


def check_a_comparison_shows_the_closed_arrangement(balls):
    closed = vertices_of(balls)
    _explode(balls, 8.0)
    with stills._volumes_alone(bpy.context.scene):
        close(vertices_of(balls), closed, 0)
    assert _is_apart(balls, closed, 8.0)


def check_a_crop_keeps_the_closed_parts(balls):
    closed = _ends(balls)
    _explode(balls, 40.0)
    assert bpy.ops.leaflight.crop_to_shown(margin=1) == {"FINISHED"}
    balls.leaflight_look.explode_axis = "NONE"
    close(_ends(balls), closed, 1e-3)
    assert cache.volume_of(balls).values.shape[2] < N
