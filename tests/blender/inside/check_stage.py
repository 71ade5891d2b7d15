# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: what it puts around volumes, sets aside and brings back, and a camera that sees it."""

import math

import bpy
import nibabel
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from leaflight_addon.stage import aside, presets, scene_export, stage, world
from leaflight_addon.store import cache
from tools import add_light, close, error_of, mesh_arrays, one_coloured_world, to_world

BUILT = [name for name in presets.PRESETS if name != presets.MY_SCENE]


def _stage(preset, **options):
    assert bpy.ops.leaflight.stage(preset=preset, **options) == {"FINISHED"}
    bpy.context.view_layer.update()


def _staged():
    return {obj.name for obj in bpy.context.scene.objects if stage.is_staged(obj)}


def _corners(obj):
    low, high = np.asarray(cache.volume_of(obj).field().bounds, np.float64)
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    matrix = np.array(obj.matrix_world, np.float64)
    return (low + np.array(corners) * (high - low)) @ matrix[:3, :3].T + matrix[:3, 3]


def _find(items, name):
    return next(item for item in items if item.name == name)


@pytest.fixture
def head(tmp_path):
    """A NIfTI file whose values rise towards the patient's front, as the face of a head does."""
    values = np.fromfunction(lambda x, y, z: 10.0 * y + x, (12, 16, 10)).astype(np.float32)
    path = tmp_path / "head.nii"
    nibabel.save(nibabel.Nifti1Image(values, np.diag([1.0, 1.0, 1.0, 1.0])), path)
    bpy.ops.leaflight.import_volume(filepath=str(path))
    bpy.context.view_layer.update()
    return bpy.context.object


def check_what_has_margins_stands_on_the_floor(tmp_path):
    """A ball within a volume that is empty around it, as brains without skulls are."""
    x, y, z = np.mgrid[:40, :40, :40]
    ball = np.clip(100.0 - 10.0 * np.sqrt((x - 20) ** 2 + (y - 20) ** 2 + (z - 22) ** 2), 0, 100)
    path = tmp_path / "ball.nii"
    nibabel.save(nibabel.Nifti1Image(ball.astype(np.float32), np.eye(4)), path)
    bpy.ops.leaflight.import_volume(filepath=str(path))
    obj = bpy.context.object
    obj.leaflight.isovalue = obj.leaflight.low = 20.0
    _stage("CORNELL")
    lowest = to_world(obj, mesh_arrays(obj)[0])[:, 2].min()
    size = np.ptp(_corners(obj)[:, 2])
    floor = min(
        to_world(one, mesh_arrays(one)[0])[:, 2].min()
        for one in bpy.context.scene.objects
        if one.type == "MESH" and stage.is_staged(one)
    )
    assert 0 < lowest - floor < 0.06 * size


@pytest.mark.parametrize("preset", BUILT)
def check_a_stage_comes_back_as_it_was_described(bumps, preset):
    wanted = presets.fitted(preset, [cache.world_volume(bumps)], [bumps.leaflight.low])
    _stage(preset)
    found, _, warnings = scene_export.export_scene(bpy.context, bumps)
    assert warnings == []
    assert len(found.meshes) == len(wanted.meshes) and len(found.lights) == len(wanted.lights)
    close(found.leaves[0].albedo, wanted.leaves[0].albedo, 1e-6)
    assert found.exposure == pytest.approx(wanted.exposure)
    for mesh in wanted.meshes:
        same = _find(found.meshes, mesh.name)
        close(same.vertices, mesh.vertices, 1e-5)
        close(same.albedo, mesh.albedo, 1e-6)
    for light in wanted.lights:
        same = _find(found.lights, light.name)
        for name in ("corner", "edge_u", "edge_v", "radiance", "position", "intensity"):
            if hasattr(light, name):
                close(getattr(same, name), getattr(light, name), 2e-5)
    if wanted.environment is None:
        assert found.environment is None and world.is_dark(bpy.context.scene.world)
    else:
        close(found.environment.radiance, wanted.environment.radiance, 1e-6)


@pytest.mark.parametrize("preset", BUILT)
@pytest.mark.parametrize("size", [(100, 100), (1920, 1080), (1080, 1920)])
def check_the_camera_sees_the_volume_whole(bumps, preset, size):
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    _stage(preset)
    places = [world_to_camera_view(scene, scene.camera, p) for p in _vectors(_corners(bumps))]
    x, y, depth = np.array(places).T
    assert 0 < x.min() and x.max() < 1 and 0 < y.min() and y.max() < 1
    assert scene.camera.data.clip_start < depth.min() and depth.max() < scene.camera.data.clip_end
    # And not from afar.
    assert max(np.ptp(x), np.ptp(y)) > 0.4


def _vectors(points):
    from mathutils import Vector

    return [Vector(point) for point in points]


@pytest.mark.parametrize("preset", BUILT)
def check_the_volume_stands_on_the_floor_and_within_the_walls(bumps, preset):
    _stage(preset)
    floor = bpy.data.objects["floor"]
    corners = np.array([floor.matrix_world @ v.co for v in floor.data.vertices])
    volume = _corners(bumps)
    height = volume[:, 2].min() - corners[:, 2].max()
    assert 0 < height < 0.05
    assert np.all(corners.min(axis=0)[:2] < volume.min(axis=0)[:2])
    assert np.all(corners.max(axis=0)[:2] > volume.max(axis=0)[:2])


@pytest.mark.parametrize("degrees", [0, 30, 90, 180])
def check_the_camera_stands_before_the_face(head, degrees):
    head.rotation_euler.z = math.radians(degrees)
    bpy.context.view_layer.update()
    before = head.matrix_world.copy()
    _stage("CORNELL")
    assert head.matrix_world == before
    front = np.array(head.matrix_world, np.float64)[:3, :3] @ (0, 1, 0)
    camera = np.array(bpy.context.scene.camera.matrix_world.translation)
    towards = camera - _corners(head).mean(axis=0)
    cosine = front @ towards / np.linalg.norm(front) / np.linalg.norm(towards)
    # The stage turns by quarters, the camera looks down a little.
    assert cosine > math.cos(math.radians(46 if degrees == 30 else 10))
    # Its lamp lights the face, and its back wall is behind the head.
    lamp, wall = (bpy.data.objects[name].matrix_world.translation for name in ("lamp", "back wall"))
    middle = _corners(head).mean(axis=0)
    assert (np.array(lamp) - middle) @ towards > 0 > (np.array(wall) - middle) @ towards


def check_the_camera_stands_before_the_face_in_a_file_that_counts_towards_the_back(tmp_path):
    """MetaImage, as DICOM, counts towards left, posterior, superior."""
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
    towards = np.array(bpy.context.scene.camera.location) - _corners(head).mean(axis=0)
    assert face @ towards / np.linalg.norm(towards) > math.cos(math.radians(10))


def check_others_are_set_aside_and_brought_back(bumps):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    sun = add_light("SUN")
    unseen = add_light("POINT")
    unseen.hide_render = True
    bpy.context.view_layer.objects.active = bumps
    _stage("CORNELL")
    names = {obj.name for obj, _ in _rendered()}
    assert cube.name not in names and sun.name not in names and "floor" in names
    assert cube.hide_get() and set(aside.all_aside(bpy.context.scene)) == {cube, sun}
    assert bpy.ops.leaflight.bring_back() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert {cube.name, sun.name} <= {obj.name for obj, _ in _rendered()}
    assert not cube.hide_get() and unseen.hide_render
    with pytest.raises(RuntimeError, match="No object is set aside"):
        bpy.ops.leaflight.bring_back()


def _rendered():
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return scene_export.rendered_objects(bpy.context.view_layer, depsgraph)


def check_others_may_stay(bumps):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    bpy.context.view_layer.objects.active = bumps
    _stage("CORNELL")
    _stage("CORNELL", set_aside=False)
    assert not cube.hide_render and not cube.hide_get()


@pytest.mark.parametrize("preset", BUILT)
def check_another_stage_replaces_its_own_objects_and_no_other(bumps, preset):
    mine = one_coloured_world((0.2, 0.3, 0.4), name="Mine")
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
        _staged() - {"floor", "lamp", "Stage Camera", "key light", "fill light"}
    ) or (preset == "OPEN_FLOOR")
    assert {"floor copy", "my backdrop"} <= {obj.name for obj in bpy.context.scene.objects}
    assert len([c for c in bpy.data.collections if stage.is_staged(c)]) == 1
    names = {obj.name for obj in bpy.context.scene.objects}
    assert "floor" in names and "floor.001" not in names
    assert "Mine" in bpy.data.worlds and bpy.context.scene.world != mine


def check_my_scene_is_left_as_it_is(bumps):
    assert "choose one" in error_of(bpy.ops.leaflight.stage, preset="MY_SCENE")
    mine = one_coloured_world((0.2, 0.3, 0.4), name="Mine")
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
