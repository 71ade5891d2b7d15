# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks several volumes in one scene: baked together, and with linked isovalues."""

import bpy
import numpy as np
import pytest
from boxes import build_cornell_box
from leaflight_addon import session, versions
from leaflight_addon.show import isovalues, properties
from leaflight_addon.stage import scene_export, staleness
from leaflight_addon.store import cache
from mathutils import Matrix
from tools import assert_shows, close, duplicate, mesh_arrays

# Place along x and radius of two balls, in voxels.
BALLS = ((8.0, 8.0), (19.5, 3.5))


@pytest.fixture
def pair(bumps, bump_file):
    """Returns two volumes of different ranges in one box; the second is smaller."""
    bpy.ops.leaflight.import_volume(
        filepath=str(bump_file),
        dims=(24, 24, 24),
        value_type="float32",
        size=1.0,
        size_from="FIT",
    )
    second = bpy.context.object
    second.name = "second"
    second.location.x += 1.8
    second.leaflight.bake_folder = bumps.leaflight.bake_folder
    second.leaflight.shading = bumps.leaflight.shading
    bumps.leaflight.low, bumps.leaflight.high = 20.0, 100.0
    second.leaflight.low, second.leaflight.high = 100.0, 160.0
    _activate(bumps)
    bumps.leaflight.isovalue = 50.0
    build_cornell_box()
    return bumps, second


def _activate(obj):
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()


def check_the_box_surrounds_both(pair):
    floor = bpy.data.objects["floor"]
    corners = np.array([floor.matrix_world @ v.co for v in floor.data.vertices])
    for obj in pair:
        box = np.array([obj.matrix_world @ v.co for v in obj.data.vertices])
        assert np.all(corners.min(axis=0)[:2] <= box.min(axis=0)[:2] + 1e-4)
        assert np.all(corners.max(axis=0)[:2] >= box.max(axis=0)[:2] - 1e-4)


@pytest.mark.parametrize("active", [0, 1])
def check_one_bake_holds_both(pair, active, tmp_path):
    _activate(pair[active])
    bpy.ops.leaflight.bake()
    page = str(tmp_path / "both.html")
    assert bpy.ops.leaflight.export_page(filepath=page) == {"FINISHED"}
    (path,) = {obj.leaflight.bake_path for obj in pair}
    assert [obj.leaflight.bake_index for obj in pair] == [0, 1]
    assert len({obj.leaflight.bake_id for obj in pair}) == 1
    bake = cache.bake_of(pair[0])
    assert bake is cache.bake_of(pair[1]) and len(bake.grids) == 2
    assert [one.isovalues for one in bake.scene.isosurfaces] == [(20.0, 100.0), (100.0, 160.0)]
    assert [one.name for one in bake.scene.isosurfaces] == [obj.name for obj in pair]
    for index, obj in enumerate(pair):
        vertices, _, radiance = mesh_arrays(obj)
        matrix = np.array(obj.matrix_world, np.float64)
        world = vertices @ matrix[:3, :3].T + matrix[:3, 3]
        expected = bake.grids[index].lookup(bake.volumes[index].field(), world)
        assert radiance.max() > 0.01
        close(radiance, expected, 1e-4 * expected.max())
        assert staleness.change_since_bake(bpy.context, obj) == ""
    paths = {
        node.image.filepath
        for obj in pair
        for node in obj.data.materials[0].node_tree.nodes
        if node.type == "TEX_IMAGE"
    }
    assert len(paths) == 2


def _common_isovalues(pair):
    return [isovalues.common_isovalue(o.leaflight, o.leaflight.isovalue) for o in pair]


def check_moving_one_moves_the_other(pair):
    for first, second, obj, isovalue in (
        (40.0, 115.0, 0, 40.0),
        (80.0, 145.0, 1, 145.0),
        (100.0, 160.0, 0, 100.0),
    ):
        pair[obj].leaflight.isovalue = isovalue
        close([o.leaflight.isovalue for o in pair], [first, second], 1e-5)
    pair[1].leaflight["isovalue"] = 130.0
    pair[1].update_tag()
    bpy.context.view_layer.update()
    close([o.leaflight.isovalue for o in pair], [60.0, 130.0], 1e-5)
    bpy.context.view_layer.update()
    close([o.leaflight.isovalue for o in pair], [60.0, 130.0], 1e-5)
    for obj in pair:
        assert_shows(obj, obj.leaflight.isovalue)
    close(_common_isovalues(pair), 0.5, 1e-6)


def check_unlinked_and_hidden_volumes_stay(pair):
    first, second = pair
    before = second.leaflight.isovalue
    second.leaflight.linked = False
    first.leaflight.isovalue = 50.0
    assert second.leaflight.isovalue == before
    second.leaflight.linked = True
    second.hide_render = True
    first.leaflight.isovalue = 60.0
    assert second.leaflight.isovalue == before
    second.hide_render = False
    first.leaflight.isovalue = 70.0
    close(second.leaflight.isovalue, 137.5, 1e-5)


def check_keyframes_of_one_lead_the_other(pair):
    first, second = pair
    for frame, isovalue in ((1, 40.0), (11, 80.0)):
        first.leaflight.isovalue = isovalue
        first.keyframe_insert(properties.ISOVALUE_PATH, frame=frame)
    for key in versions.fcurves(first)[0].keyframe_points:
        key.interpolation = "LINEAR"
    for frame, a, b in ((1, 40.0, 115.0), (6, 60.0, 130.0), (11, 80.0, 145.0)):
        bpy.context.scene.frame_set(frame)
        assert_shows(first, a)
        assert_shows(second, second.leaflight.isovalue)
        close(second.leaflight.isovalue, b, 1e-5)
    # The animated volume leads and never follows.
    second.leaflight.isovalue = 100.0
    bpy.context.view_layer.update()
    assert_shows(first, 80.0)


def check_the_window_of_the_bake_counts_from_then_on(pair):
    first, second = pair
    bpy.ops.leaflight.bake()
    first.leaflight.low = -500.0
    first.leaflight.isovalue = 60.0
    close(second.leaflight.isovalue, 130.0, 1e-5)


def check_a_hidden_one_is_not_baked_and_its_file_not_overwritten(pair):
    first, second = pair
    bpy.ops.leaflight.bake()
    second.hide_render = True
    bpy.context.view_layer.update()
    description, volumes, _ = scene_export.export_scene(bpy.context, first)
    assert volumes == [first] and description.isosurfaces[0].isovalues is None
    bpy.ops.leaflight.bake()
    session.clear()
    assert len(cache.bake_of(first).grids) == 1 and len(cache.bake_of(second).grids) == 2


def check_undo_brings_both_back(pair):
    names = [obj.name for obj in pair]
    pair[0].leaflight.isovalue = 40.0
    bpy.ops.ed.undo_push(message="forty")
    pair[0].leaflight.isovalue = 80.0
    bpy.ops.ed.undo_push(message="eighty")
    bpy.ops.ed.undo()
    pair = [bpy.data.objects[name] for name in names]
    close([o.leaflight.isovalue for o in pair], [40.0, 115.0], 1e-5)
    for obj in pair:
        assert_shows(obj, obj.leaflight.isovalue)


@pytest.fixture
def nested(tmp_path, bumps):
    """Returns three copies of a ball in one place, at isovalues from the outside to the inside.

    The first two have clip boxes of their own, and all isovalues have the common isovalue one half.
    """
    bpy.data.objects.remove(bumps)
    z, y, x = np.mgrid[-1:1:24j, -1:1:24j, -1:1:24j]
    np.save(tmp_path / "ball.npy", np.float32(100 - 80 * np.sqrt(x**2 + y**2 + z**2)))
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "ball.npy"))
    skin = bpy.context.object
    skin.leaflight.bake_folder, skin.leaflight.error = str(tmp_path / "bakes"), 20.0
    skin.leaflight.resolution, skin.leaflight.shading = 24, "ATTRIBUTE"
    build_cornell_box()
    found = (skin, duplicate(skin), duplicate(skin))
    for obj, isovalue in zip(found, (30.0, 50.0, 70.0)):
        obj.leaflight.low, obj.leaflight.high = isovalue - 5.0, isovalue + 5.0
        obj.leaflight.isovalue = isovalue
    size = np.array(skin.dimensions)
    for obj, start in zip(found[:2], (0.0, 0.15)):
        _activate(obj)
        bpy.ops.leaflight.add_clip_box()
        # From a share of the size on, towards the camera.
        box = obj.leaflight_look.box
        box.matrix_world = obj.matrix_world.normalized() @ Matrix.Diagonal((*size, 1.0))
        box.location = obj.location
        box.location.x += size[0] + start * size[0]
        bpy.context.view_layer.update()
    return found


def check_each_volume_has_its_cut_in_one_bake(nested, tmp_path):
    whole = [np.ptp(mesh_arrays(obj)[0], axis=0)[0] for obj in nested]
    for obj in nested[:2]:
        _activate(obj)
        bpy.ops.leaflight.cut_data(cut="capped")
    bpy.ops.leaflight.bake()
    assert len({obj.leaflight.bake_id for obj in nested}) == 1
    names = [obj.name for obj in nested]
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    nested = [bpy.data.objects[name] for name in names]
    lights = []
    for obj, size in zip(nested, whole):
        assert staleness.change_since_bake(bpy.context, obj) == ""
        vertices, _, radiance = mesh_arrays(obj)
        on_cut = vertices[:, 0] > vertices[:, 0].max() - 1e-3
        lights.append(radiance[on_cut].mean())
        is_cut = obj != nested[2]
        assert (np.ptp(vertices[:, 0]) < 0.9 * size) == is_cut
        assert (on_cut.sum() > 20) == is_cut
    assert min(lights) > 0.02
    # The second stands out of the cut of the first, and is dark deep within it.
    reach = [mesh_arrays(obj)[0][:, 0].max() for obj in nested]
    assert reach[0] < reach[1] and reach[0] < reach[2]
    vertices, _, radiance = mesh_arrays(nested[1])
    is_out, is_deep = vertices[:, 0] > reach[0] + 0.5, vertices[:, 0] < reach[0] - 5.0
    assert radiance[is_out].mean() > 0.3 and radiance[is_deep].mean() < 0.03
    # One box moves its own cut alone.
    nested[0].leaflight_look.box.location.x -= 0.1
    bpy.context.view_layer.update()
    moved = [mesh_arrays(obj)[0][:, 0].max() for obj in nested]
    assert moved[0] < reach[0] - 0.3 and moved[1:] == reach[1:]


def check_parts_are_removed_from_one_copy_alone(tmp_path, bumps):
    bpy.data.objects.remove(bumps)
    z, y, x = np.mgrid[:24, :24, :24]
    away = [np.sqrt((x - a) ** 2 + (y - 11.5) ** 2 + (z - 11.5) ** 2) / r for a, r in BALLS]
    np.save(tmp_path / "balls.npy", np.float32(100 - 60 * np.minimum(*away)))
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "balls.npy"))
    whole = bpy.context.object
    whole.leaflight.bake_folder, whole.leaflight.error = str(tmp_path / "bakes"), 20.0
    whole.leaflight.resolution, whole.leaflight.shading = 24, "ATTRIBUTE"
    whole.leaflight.low, whole.leaflight.high = 35.0, 45.0
    whole.leaflight.isovalue = 40.0
    build_cornell_box()
    copy = duplicate(whole)
    bpy.ops.leaflight.clean_data(kind="largest_part")
    bpy.ops.leaflight.bake()
    assert whole.leaflight.bake_id == copy.leaflight.bake_id
    for obj, (low, high) in ((whole, (-10.0, 10.0)), (copy, (-10.0, 4.0))):
        vertices, _, radiance = mesh_arrays(obj)
        assert vertices[:, 0].min() < low and high - 3.0 < vertices[:, 0].max() < high + 2.0
        assert radiance.max() > 0.02
