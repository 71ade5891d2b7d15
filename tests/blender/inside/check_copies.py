# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that volumes keep their bakes if they are appended, linked, overridden, duplicated
or renamed.
"""

from pathlib import Path

import bpy
import numpy as np
import pytest
from blends import assert_lit, brighten, mean_radiance, open_blend, reopened, save
from boxes import build_cornell_box
from leaflight_addon.show import display, properties, surface_object
from leaflight_addon.stage import staleness
from leaflight_addon.store import bake_files, cache
from tools import duplicate, error_of, mesh_arrays


def _link(blend, name, **how):
    """Links or appends a volume of another .blend."""
    with bpy.data.libraries.load(str(blend), **how) as (_, wanted):
        wanted.objects = [name]
    (obj,) = (o for o in bpy.data.objects if o.leaflight.is_volume)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return obj


@pytest.fixture
def linked(saved, tmp_path):
    """Returns a volume linked into another .blend, in another folder."""
    blend, name = bpy.data.filepath, saved.name
    bpy.ops.wm.read_homefile(use_empty=True)
    (tmp_path / "main").mkdir()
    save(tmp_path / "main" / "main.blend")
    return _link(blend, name, link=True)


def _displays(scene):
    return [obj for obj in scene.objects if display.is_display(obj, "wall")]


def check_an_appended_volume_finds_its_bake(saved, tmp_path):
    blend, name, path = bpy.data.filepath, saved.name, bake_files.locate(saved)
    bpy.ops.wm.read_homefile(use_empty=True)
    save(tmp_path / "main.blend")
    obj = _link(blend, name, link=False)
    obj.leaflight.isovalue = 77.0
    assert bake_files.locate(obj) == path
    assert_lit(obj, 77.0)
    assert_lit(reopened(tmp_path / "main.blend"), 77.0)


def check_a_linked_volume_resolves_its_path_by_its_library(linked, tmp_path):
    assert linked.leaflight.bake_path.startswith("//leaflight/")
    assert bake_files.locate(linked).parent == tmp_path / "here" / "leaflight"
    assert_lit(linked)
    assert cache.bake_of(linked).id == linked.leaflight.bake_id
    bpy.context.view_layer.objects.active = linked
    assert "library override" in error_of(bpy.ops.leaflight.bake)


def check_a_linked_volume_that_is_animated_stays_as_it_was_saved(saved, tmp_path):
    for frame, isovalue in ((1, 40.0), (11, 120.0)):
        saved.leaflight.isovalue = isovalue
        saved.keyframe_insert(properties.ISOVALUE_PATH, frame=frame)
    bpy.context.scene.frame_set(1)
    blend, name = Path(bpy.data.filepath), saved.name
    save(blend)
    bpy.ops.wm.read_homefile(use_empty=True)
    obj = _link(blend, name, link=True)
    bpy.context.scene.frame_set(1)
    shown = mesh_arrays(obj)
    bpy.context.scene.frame_set(7)
    assert "library override" in surface_object.problems[obj.name_full]
    for before, after in zip(shown, mesh_arrays(obj)):
        np.testing.assert_array_equal(before, after)
    assert len(shown[0]) > 100


def check_a_library_override_has_an_isovalue_of_its_own(linked, tmp_path):
    before = linked.leaflight.isovalue
    own = linked.override_create()
    bpy.context.scene.collection.objects.link(own)
    own.leaflight.isovalue = 99.0
    assert own.data.library is None and own.data != linked.data
    assert_lit(own, 99.0)
    assert_lit(linked, before)
    save(Path(bpy.data.filepath))
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    own = next(o for o in bpy.data.objects if o.override_library is not None)
    assert own.leaflight.isovalue == 99.0
    assert_lit(own, 99.0)
    bpy.context.scene.frame_set(3)
    assert_lit(own, 99.0)


def check_an_override_keeps_a_bake_of_its_own(linked):
    library = linked.leaflight.bake_id
    own = linked.override_create(remap_local_usages=True)
    bpy.context.view_layer.objects.active = own
    build_cornell_box()
    own.leaflight.seed = 3
    bpy.ops.leaflight.bake()
    identifier = own.leaflight.bake_id
    assert identifier != library == linked.leaflight.bake_id
    save(Path(bpy.data.filepath))
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    own = next(o for o in bpy.data.objects if o.override_library is not None)
    assert own.leaflight.bake_id == identifier
    assert bake_files.locate(own).parent == Path(bpy.data.filepath).parent / "leaflight"
    assert_lit(own)


def check_two_blends_in_one_folder_leave_each_other_alone(saved):
    first = Path(bpy.data.filepath)
    second = first.with_name("second.blend")
    save(second)
    brighten()
    bpy.ops.leaflight.bake()
    bright = mean_radiance(saved)
    save(second)
    obj = open_blend(first)
    assert mean_radiance(obj) < 0.6 * bright
    assert_lit(obj)
    assert_lit(open_blend(second))


def check_objects_of_one_name_leave_each_other_alone(saved):
    """Checks a renamed volume and a new one with its former name: their bake files must differ."""
    first, second = saved, duplicate(saved)
    first.hide_render, first.name, second.name = True, "old", "bumps"
    brighten()
    bpy.ops.leaflight.bake()
    for obj in (first, second):
        assert bake_files.locate(obj).name.startswith("bumps_")
        obj.leaflight.isovalue = 66.0
        assert_lit(obj, 66.0)
    assert mean_radiance(second) > 1.8 * mean_radiance(first)


@pytest.mark.parametrize("linked", [False, True])
def check_duplicates_show_each_their_isovalue(saved, linked):
    copy = duplicate(saved, linked)
    assert (copy.data == saved.data) == linked
    for obj in (saved, copy):
        obj.leaflight.linked = False
    for first, second in ((40.0, 90.0), (70.0, 90.0), (70.0, 33.0)):
        saved.leaflight.isovalue, copy.leaflight.isovalue = first, second
        for _ in range(2):
            bpy.context.view_layer.update()
            assert_lit(saved, first)
            assert_lit(copy, second)
    assert copy.data != saved.data
    bpy.data.objects.remove(saved)
    copy.leaflight.isovalue = 55.0
    assert_lit(copy, 55.0)


def check_a_linked_duplicate_shares_the_mesh_for_as_long_as_it_shows_the_same(saved):
    copy = duplicate(saved, True)
    meshes = len(bpy.data.meshes)
    for _ in range(3):
        bpy.context.view_layer.update()
        bpy.context.scene.frame_set(bpy.context.scene.frame_current + 1)
    assert copy.data == saved.data and len(bpy.data.meshes) == meshes
    # Objects that were moved together follow each other by default.
    saved.leaflight.isovalue = 44.0
    for _ in range(2):
        bpy.context.view_layer.update()
    assert_lit(saved, 44.0)
    assert_lit(copy, 44.0)
    assert len(bpy.data.meshes) == meshes + 1


def check_a_linked_duplicate_may_look_otherwise(saved):
    copy = duplicate(saved, True)
    copy.leaflight.capped = True
    assert copy.data.materials[0] == copy.leaflight.isosurface_material
    assert saved.data.materials[0] == saved.leaflight.baked_material
    assert_lit(saved)


def check_both_duplicates_baked_together_have_each_their_light(saved):
    copy = duplicate(saved, True)
    copy.location.x += 0.4
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    assert {saved.leaflight.bake_index, copy.leaflight.bake_index} == {0, 1}
    assert_lit(saved)
    assert_lit(copy)


def check_a_copy_of_the_whole_scene_goes_on_alone(saved):
    name = saved.name
    bpy.ops.scene.new(type="FULL_COPY")
    copy = next(o for o in bpy.context.scene.objects if o.leaflight.is_volume)
    assert copy.name != name
    copy.leaflight.isovalue = 91.0
    saved = bpy.data.objects[name]
    assert saved.leaflight.isovalue != 91.0
    assert_lit(copy, 91.0)
    assert_lit(saved)
    bpy.context.view_layer.objects.active = copy
    assert staleness.change_since_bake(bpy.context, copy) == ""


def check_walls_are_known_after_a_rename_and_in_a_copy_of_the_scene(saved):
    saved.leaflight.light_walls = True
    bpy.ops.leaflight.bake()
    scene = bpy.context.scene
    count = len(_displays(scene))
    bpy.data.objects["floor"].name = "ground"
    impostor = bpy.data.objects.new("floor", bpy.data.meshes.new("floor"))
    scene.collection.objects.link(impostor)
    scene.leaflight.show_walls = False
    assert not _displays(scene) and not bpy.data.objects["ground"].hide_render
    scene.leaflight.show_walls = True
    assert len(_displays(scene)) == count and bpy.data.objects["ground"].hide_render
    assert not impostor.hide_render
    bpy.ops.scene.new(type="FULL_COPY")
    copy = bpy.context.scene
    for shown in (False, True):
        copy.leaflight.show_walls = shown
        assert len(_displays(copy)) == (count if shown else 0)
        assert len(_displays(scene)) == count
    # A new bake must use the object that now has the name.
    bpy.context.window.scene = scene
    bpy.data.objects["ground"].hide_render = False
    impostor.data = bpy.data.objects["ground"].data
    impostor.matrix_world = bpy.data.objects["ground"].matrix_world
    bpy.data.objects.remove(bpy.data.objects["ground"])
    bpy.context.view_layer.objects.active = saved
    bpy.ops.leaflight.bake()
    assert len(_displays(scene)) == count and impostor.hide_render


def check_a_renamed_volume_keeps_its_bake(saved):
    saved.name = "renamed"
    saved.leaflight.isovalue = 58.0
    save(Path(bpy.data.filepath))
    assert_lit(open_blend(bpy.data.filepath), 58.0)
