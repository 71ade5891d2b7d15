# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks Stage: objects around volumes, hidden objects, and a camera that sees the volume."""

import math

import bpy
import nibabel
import numpy as np
import pytest
from leaflight_addon.show import look
from leaflight_addon.stage import camera, facing, hidden, presets, scene_export, stage, world
from leaflight_addon.store import cache, frame_bakes, source_files
from mathutils import Matrix
from tools import (
    add_light,
    close,
    error_of,
    in_frame,
    one_colored_world,
    to_world,
    vertices_of,
)

BUILT = [name for name in presets.PRESETS if name != presets.MY_SCENE]


def _stage(preset, **options):
    assert bpy.ops.leaflight.stage(preset=preset, **options) == {"FINISHED"}
    bpy.context.view_layer.update()


def _staged():
    return {obj.name for obj in bpy.context.scene.objects if stage.is_staged(obj)}


def _lowest_of_stage():
    return min(
        to_world(obj, vertices_of(obj))[:, 2].min()
        for obj in bpy.context.scene.objects
        if obj.type == "MESH" and stage.is_staged(obj)
    )


def _find(items, name):
    return next(item for item in items if item.name == name)


@pytest.fixture
def head(tmp_path):
    """Imports a NIfTI file whose values increase towards the patient's front, as at a face."""
    values = np.fromfunction(lambda x, y, z: 10.0 * y + x, (12, 16, 10)).astype(np.float32)
    path = tmp_path / "head.nii"
    nibabel.save(nibabel.Nifti1Image(values, np.diag([1.0, 1.0, 1.0, 1.0])), path)
    bpy.ops.leaflight.import_volume(filepath=str(path))
    bpy.context.view_layer.update()
    return bpy.context.object


@pytest.fixture
def ball(tmp_path):
    """Imports a ball in an empty volume, with a speck of dust in a corner."""
    x, y, z = np.mgrid[:40, :40, :40]
    values = np.clip(100.0 - 10.0 * np.sqrt((x - 20) ** 2 + (y - 20) ** 2 + (z - 22) ** 2), 0, 100)
    values[1:3, 1:3, 1:3] = 100.0
    path = tmp_path / "ball.nii"
    nibabel.save(nibabel.Nifti1Image(values.astype(np.float32), np.eye(4)), path)
    bpy.ops.leaflight.import_volume(filepath=str(path))
    bpy.context.object.leaflight.isovalue = 20.0
    return bpy.context.object


def check_what_has_margins_stands_on_the_floor(ball):
    _stage("CORNELL")
    vertices = to_world(ball, vertices_of(ball))
    vertices = vertices[np.linalg.norm(vertices - vertices.mean(axis=0), axis=1) < 0.6]
    assert 0 < vertices[:, 2].min() - _lowest_of_stage() < 0.03 * np.ptp(vertices[:, 2])


def check_dust_does_not_count(ball):
    points = camera.shown_points([ball])
    assert len(points) < len(vertices_of(ball))
    middle = (source_files.place_of_file(ball) @ (20, 20, 22, 1))[:3]
    close(0.5 * (points.min(axis=0) + points.max(axis=0)), middle, 0.02)


def check_parts_of_a_mesh_are_distinguished():
    """Checks strips of ten and of two triangles, with randomly numbered vertices."""
    strips = np.array([(i, i + 1, i + 2) for i in (*range(10), 12, 13)])
    numbers = np.random.default_rng(0).permutation(16)
    for share, kept in ((0.1, 16), (0.5, 12)):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(camera, "_SHARE", share)
            large = camera.in_large_parts(16, numbers[strips])
        assert set(numbers[:kept]) == set(np.flatnonzero(large))


def check_a_stage_follows_the_isovalue_and_the_camera_alone_after_a_bake(ball):
    _stage("STUDIO")
    before, place = _lowest_of_stage(), bpy.context.scene.camera.matrix_world.copy()
    ball.leaflight.isovalue = 50.0
    assert bpy.ops.leaflight.frame_isosurface() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert _lowest_of_stage() > before and bpy.context.scene.camera.matrix_world != place
    ball.leaflight.resolution, ball.leaflight.use_resolution = 8, True
    ball.leaflight.error = 20.0
    bpy.ops.leaflight.bake()
    lowest, identifier = _lowest_of_stage(), ball.leaflight.bake_id
    ball.leaflight.isovalue = 30.0
    assert bpy.ops.leaflight.frame_isosurface() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert _lowest_of_stage() == lowest and ball.leaflight.bake_id == identifier != ""
    assert _heightin_frame(ball) > 0.5


def _gap(obj):
    return to_world(obj, vertices_of(obj))[:, 2].min() - _lowest_of_stage()


def check_a_cut_volume_stands_again_and_floats_on_request(ball):
    bpy.ops.leaflight.clean_data(kind="largest_part")
    _stage("CORNELL")
    standing = _gap(ball)
    ball.leaflight.resolution, ball.leaflight.use_resolution = 8, True
    ball.leaflight.error = 20.0
    bpy.ops.leaflight.bake()
    # Remove the lower half.
    bpy.ops.leaflight.add_clip_box()
    box = ball.leaflight_look.box
    box.matrix_world = Matrix.Diagonal((9.0, 9.0, 9.0, 1.0))
    box.matrix_world.translation = ball.matrix_world.translation
    box.matrix_world.translation.z -= np.ptp(np.array(look.bounds_of(box))[:, 2]) * 9.0 / 2
    bpy.context.view_layer.update()
    bpy.ops.leaflight.cut_data(cut="capped")
    assert _gap(ball) > 2 * standing
    assert bpy.ops.leaflight.frame_isosurface() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert 0 < _gap(ball) < 1.01 * standing
    bpy.context.scene.leaflight_stage.height = 0.5
    bpy.ops.leaflight.frame_isosurface()
    bpy.context.view_layer.update()
    assert _gap(ball) == pytest.approx(standing + 0.5, abs=0.02)


def _heightin_frame(obj):
    return np.ptp(in_frame(obj)[:, 1])


@pytest.mark.parametrize("preset", BUILT)
def check_a_stage_comes_back_as_it_was_described(bumps, preset):
    turn = np.array(Matrix.Rotation(facing.direction(bumps), 3, "Z"))
    wanted = presets.fitted(preset, camera.shown_points([bumps]) @ turn)
    _stage(preset)
    found, _, warnings = scene_export.export_scene(bpy.context, bumps)
    assert warnings == []
    assert len(found.meshes) == len(wanted.meshes) and len(found.lights) == len(wanted.lights)
    close(found.isosurfaces[0].albedo, wanted.isosurfaces[0].albedo, 1e-6)
    assert found.exposure == pytest.approx(wanted.exposure)
    for mesh in wanted.meshes:
        same = _find(found.meshes, mesh.name)
        close(same.vertices @ turn, mesh.vertices, 2e-5)
        close(same.albedo, mesh.albedo, 1e-6)
    for light in wanted.lights:
        same = _find(found.lights, light.name)
        for name in ("corner", "edge_u", "edge_v", "position"):
            if hasattr(light, name):
                close(getattr(same, name) @ turn, getattr(light, name), 3e-5)
        for name in ("radiance", "intensity"):
            if hasattr(light, name):
                close(getattr(same, name), getattr(light, name), 5e-5)
    if wanted.environment is None:
        assert found.environment is None and world.is_dark(bpy.context.scene.world)
    else:
        close(found.environment.radiance, wanted.environment.radiance, 1e-6)


@pytest.mark.parametrize("preset", BUILT)
@pytest.mark.parametrize("size", [(100, 100), (1920, 1080), (1080, 1920)])
def check_the_isosurface_fills_the_frame(bumps, preset, size):
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    _stage(preset)
    x, y, depth = in_frame(bumps).T
    assert 0 < x.min() and x.max() < 1 and 0 < y.min() and y.max() < 1
    assert scene.camera.data.clip_start < depth.min() and depth.max() < scene.camera.data.clip_end
    assert np.ptp(x) == pytest.approx(camera.WIDTH, 0.02) or np.ptp(y) == pytest.approx(
        camera.HEIGHT, 0.02
    )
    assert np.ptp(x) < camera.WIDTH + 0.02 and np.ptp(y) < camera.HEIGHT + 0.02
    close([x.min() + x.max(), y.min() + y.max()], [1, 1], 0.02)


def _vectors(points):
    from mathutils import Vector

    return [Vector(point) for point in points]


@pytest.mark.parametrize("preset", BUILT)
def check_the_isosurface_stands_on_the_floor_and_within_the_walls(bumps, preset):
    _stage(preset)
    turn = np.array(Matrix.Rotation(facing.direction(bumps), 3, "Z"))
    walls = np.concatenate(
        [
            to_world(obj, vertices_of(obj)) @ turn
            for obj in bpy.context.scene.objects
            if obj.type == "MESH" and stage.is_staged(obj)
        ]
    )
    shown = camera.shown_points([bumps]) @ turn
    assert 0 < shown[:, 2].min() - walls[:, 2].min() < 0.05
    assert np.all(walls.min(axis=0)[:2] < shown.min(axis=0)[:2])
    assert np.all(walls.max(axis=0)[:2] > shown.max(axis=0)[:2])


@pytest.mark.parametrize("degrees", [0, 30, 90, 180])
def check_the_camera_stands_before_the_face(head, degrees):
    head.rotation_euler.z = math.radians(degrees)
    bpy.context.view_layer.update()
    before = head.matrix_world.copy()
    _stage("CORNELL")
    assert head.matrix_world == before
    front = np.array(head.matrix_world, np.float64)[:3, :3] @ (0, 1, 0)
    towards = np.array(bpy.context.scene.camera.matrix_world.translation) - _middle(head)
    cosine = front @ towards / np.linalg.norm(front) / np.linalg.norm(towards)
    # The view is from three quarters. The stage turns by 90 degrees, and the camera looks down
    # slightly.
    assert cosine > math.cos(math.radians(68 if degrees == 30 else 38))
    assert math.degrees(math.asin(towards[2] / np.linalg.norm(towards))) == pytest.approx(10, abs=3)
    # The lamp must light the face, and the back wall must be behind the head.
    lamp, wall = (bpy.data.objects[name].matrix_world.translation for name in ("lamp", "back wall"))
    middle = _middle(head)
    assert (np.array(lamp) - middle) @ towards > 0 > (np.array(wall) - middle) @ towards


def _middle(obj):
    points = camera.shown_points([obj])
    return 0.5 * (points.min(axis=0) + points.max(axis=0))


def check_the_camera_stands_before_the_face_in_a_file_that_counts_towards_the_back(tmp_path):
    """Checks MetaImage, whose axes are left, posterior, superior, as in DICOM."""
    values = np.fromfunction(lambda z, y, x: 150.0 - 10.0 * y + x, (10, 16, 12))
    header = "NDims = 3\nDimSize = 12 16 10\nAnatomicalOrientation = RAI\n"
    header += "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n"
    path = tmp_path / "head.mha"
    path.write_bytes(header.encode() + values.astype("<f4").tobytes())
    bpy.ops.leaflight.import_volume(filepath=str(path))
    bpy.context.view_layer.update()
    head = bpy.context.object
    _stage("CORNELL")
    matrix = np.array(head.matrix_world, np.float64) @ cache.volume_of(head).index_to_world
    face = -matrix[:3, 1] / np.linalg.norm(matrix[:3, 1])
    towards = np.array(bpy.context.scene.camera.location) - _middle(head)
    assert face @ towards / np.linalg.norm(towards) > math.cos(math.radians(38))


def check_a_color_that_was_chosen_stays(bumps):
    _stage("STUDIO")
    first = tuple(bumps.leaflight.isosurface_albedo)
    _stage("CORNELL")
    assert tuple(bumps.leaflight.isosurface_albedo) != first
    bumps.leaflight.isosurface_albedo = (0.1, 0.2, 0.3)
    _stage("STUDIO")
    close(bumps.leaflight.isosurface_albedo, (0.1, 0.2, 0.3), 1e-6)


def check_renders_take_few_samples_and_overlays_are_off(bumps):
    scene = bpy.context.scene
    scene.cycles.samples = 4096
    _stage("STUDIO")
    assert scene.cycles.samples <= 64 and scene.eevee.taa_render_samples <= 64
    areas = [area for window in bpy.context.window_manager.windows for area in window.screen.areas]
    views = [area.spaces.active for area in areas if area.type == "VIEW_3D"]
    assert not views or not all(view.overlay.show_overlays for view in views)


def check_others_are_hidden_and_shown_again(bumps):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    sun = add_light("SUN")
    unseen = add_light("POINT")
    unseen.hide_render = True
    bpy.context.view_layer.objects.active = bumps
    _stage("CORNELL")
    names = {obj.name for obj, _ in _rendered()}
    assert cube.name not in names and sun.name not in names and "floor" in names
    assert cube.hide_get() and set(hidden.all_hidden(bpy.context.scene)) == {cube, sun}
    assert bpy.ops.leaflight.show_hidden() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert {cube.name, sun.name} <= {obj.name for obj, _ in _rendered()}
    assert not cube.hide_get() and unseen.hide_render
    assert "not hidden any object" in error_of(bpy.ops.leaflight.show_hidden)


def _rendered():
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return scene_export.rendered_objects(bpy.context.view_layer, depsgraph)


def check_others_may_stay(bumps):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    bpy.context.view_layer.objects.active = bumps
    _stage("CORNELL")
    _stage("CORNELL", hide_others=False)
    assert not cube.hide_render and not cube.hide_get()


@pytest.mark.parametrize("preset", BUILT)
def check_another_stage_replaces_its_own_objects_and_no_other(bumps, preset):
    mine = one_colored_world((0.2, 0.3, 0.4), name="Mine")
    bpy.context.scene.world = mine
    _stage("OPEN_FLOOR")
    first = _staged()
    copy = bpy.data.objects["floor"].copy()
    copy.name = "floor copy"
    bpy.data.collections["Open floor"].objects.link(copy)
    bpy.data.objects["backdrop"].name = "my backdrop"
    _stage(preset)
    _stage(preset)
    assert not first & (
        _staged()
        - {"floor", "backdrop", "lamp", "Stage Camera", "key light", "fill light", "rim light"}
    ) or (preset == "OPEN_FLOOR")
    assert {"floor copy", "my backdrop"} <= {obj.name for obj in bpy.context.scene.objects}
    assert len([c for c in bpy.data.collections if stage.is_staged(c)]) == 1
    names = {obj.name for obj in bpy.context.scene.objects}
    assert "floor.001" not in names and "backdrop.001" not in names
    assert "Mine" in bpy.data.worlds and bpy.context.scene.world != mine


def check_my_scene_is_left_as_it_is(bumps):
    assert "choose one" in error_of(bpy.ops.leaflight.stage, preset="MY_SCENE")
    mine = one_colored_world((0.2, 0.3, 0.4), name="Mine")
    scene = bpy.context.scene
    scene.world = mine
    own = bpy.data.collections.new("Own")
    scene.collection.children.link(own)
    lamp = add_light("POINT", location=(0, -3, 3))
    scene.collection.objects.unlink(lamp)
    own.objects.link(lamp)
    other = add_light("SUN")
    _stage("CORNELL")
    assert lamp.hide_render and scene.world != mine
    _stage("MY_SCENE", collection="Own")
    assert not lamp.hide_render and other.hide_render and scene.world == mine
    assert _staged() == {"Stage Camera"} and scene.camera.name == "Stage Camera"
    assert {obj.name for obj, _ in _rendered()} >= {lamp.name, bumps.name}
    camera = bpy.data.objects.new("Own Camera", bpy.data.cameras.new("Own"))
    own.objects.link(camera)
    _stage("MY_SCENE", collection="Own")
    assert scene.camera == camera and not _staged()


def check_a_built_stage_counts_not_the_chosen_one(bumps):
    _stage("CORNELL")
    chosen, walls = bpy.context.scene.leaflight_stage, _staged()
    for preset in ("STUDIO", presets.MY_SCENE):
        chosen.preset = preset
        assert bpy.ops.leaflight.frame_isosurface() == {"FINISHED"}
        assert bpy.ops.leaflight.turn_volume(way="TURN") == {"FINISHED"}
        assert _staged() == walls and chosen.preset == preset


def check_no_collection_is_remembered_by_a_button():
    properties = bpy.ops.leaflight.stage.get_rna_type().properties
    assert properties["collection"].is_skip_save


def check_a_frame_without_a_bake_keeps_those_of_others(ball):
    _stage("STUDIO")
    ball.leaflight.resolution, ball.leaflight.error = 8, 20.0
    bpy.ops.leaflight.bake()
    bpy.ops.leaflight.animate(kind="LIT_WIPE", frames=3)
    bpy.context.scene.frame_set(2)
    bakes = frame_bakes.bakes_of(ball.leaflight)
    assert bakes and not frame_bakes.is_baked(ball.leaflight)
    assert bpy.ops.leaflight.frame_isosurface() == {"FINISHED"}
    assert frame_bakes.bakes_of(ball.leaflight) == bakes
