# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes that stay found: by undo, older files, Save As, append, links, overrides and duplicates."""

import errno
import os
import shutil
from pathlib import Path

import bpy
import leaflight
import numpy as np
import pytest
from leaflight_addon.bake import unused_bakes
from leaflight_addon.show import display, properties, surface_object
from leaflight_addon.stage import staleness
from leaflight_addon.store import atlases, bake_files, cache, moving
from tools import close, colours_of, error_of, mesh_arrays


@pytest.fixture
def unsaved(boxed):
    """The boxed bumps in a .blend that was never saved, baked into the user's folder."""
    boxed.leaflight.bake_folder = ""
    bpy.ops.leaflight.bake()
    yield boxed
    shutil.rmtree(bake_files.session_folder(), ignore_errors=True)


@pytest.fixture
def saved(boxed, tmp_path):
    """The boxed bumps, baked in a .blend in a folder of its own."""
    boxed.leaflight.bake_folder = ""
    return _open_saved(tmp_path / "here" / "scene.blend", bake=True)


def _open_saved(blend, bake=False):
    blend.parent.mkdir(parents=True, exist_ok=True)
    _save(blend)
    if bake:
        bpy.ops.leaflight.bake()
        _save(blend)
    return _volume()


def _save(blend, **options):
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), **options)


def _open(blend):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    return _volume()


def _volume():
    (obj,) = [o for o in bpy.data.objects if o.leaflight.is_volume]
    bpy.context.view_layer.objects.active = obj
    return obj


def _brighten(factor=2.0):
    bpy.data.objects["lamp"].data.energy *= factor
    bpy.context.view_layer.update()


def _images(obj):
    nodes = obj.data.materials[0].node_tree.nodes
    return {node.image for node in nodes if node.type == "TEX_IMAGE"}


def _pixels(image):
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, 4)[..., :3]


def assert_lit(obj, isovalue=None, tolerance=1e-4):
    """Mesh and image show the object's own bake as its file holds it, and no problem is told."""
    assert obj.name_full not in surface_object.problems
    bake = leaflight.load_bake(bake_files.locate(obj))
    assert bake.id == obj.leaflight.bake_id
    grid = bake.grids[obj.leaflight.bake_index]
    vertices, _, radiance = mesh_arrays(obj)
    assert len(vertices) > 100
    expected = grid.lookup(cache.volume_of(obj).field(), vertices)
    # The file holds halves.
    close(radiance, expected, 2e-3 * expected.max())
    (image,) = _images(obj)
    atlas = grid.atlas()[0][..., :3]
    close(_pixels(image), atlas, 2e-3 * atlas.max())
    if isovalue is not None:
        assert obj.leaflight.isovalue == isovalue


def _mean(obj):
    return float(colours_of(obj).mean())


def check_every_bake_is_a_file_of_its_own_that_tells_its_id(saved):
    first = bake_files.locate(saved)
    before = first.read_bytes()
    _brighten()
    bpy.ops.leaflight.bake()
    second = bake_files.locate(saved)
    assert first.parent == second.parent == Path(bpy.data.filepath).parent / "leaflight"
    assert first != second and first.read_bytes() == before
    for path in (first, second):
        assert path.name.startswith("bumps_") and bake_files.id_in(path)[:12] in path.name
    # The same bake once more is the same file.
    bpy.ops.leaflight.bake()
    assert bake_files.locate(saved) == second
    # Also when the volume comes from the file of the bake.
    _save(Path(bpy.data.filepath))
    obj = _open(bpy.data.filepath)
    bpy.ops.leaflight.bake()
    assert bake_files.locate(obj) == second
    assert len(bake_files.bakes_in(second.parent)) == 2


def check_undo_after_a_second_bake_shows_the_first(saved):
    name = saved.name
    bpy.ops.ed.undo_push(message="first")
    dim = _mean(saved)
    _brighten()
    bpy.ops.leaflight.bake()
    bpy.ops.ed.undo_push(message="second")
    assert _mean(saved) > 1.8 * dim
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    close(_mean(obj), dim, 1e-6)
    assert_lit(obj)
    obj.leaflight.isovalue = 90.0
    assert_lit(obj, 90.0)
    bpy.ops.ed.redo()


def check_an_older_blend_shows_its_own_bake(saved, tmp_path):
    older = Path(bpy.data.filepath)
    dim = _mean(saved)
    _brighten()
    bpy.ops.leaflight.bake()
    _save(older.with_name("newer.blend"))
    obj = _open(older)
    close(_mean(obj), dim, 1e-6)
    assert_lit(obj)
    assert staleness.change_since_bake(bpy.context, obj) == ""
    obj.leaflight.isovalue = 90.0
    assert_lit(obj, 90.0)
    assert_lit(_open(older.with_name("newer.blend")))


def check_the_first_save_takes_the_bake_along(unsaved, tmp_path):
    old = bake_files.locate(unsaved)
    assert old.parent == bake_files.session_folder() and os.path.isabs(unsaved.leaflight.bake_path)
    here, there = tmp_path / "here", tmp_path / "there"
    obj = _open_saved(here / "scene.blend")
    assert not old.exists() and not atlases.beside(old) and not old.parent.exists()
    assert obj.leaflight.bake_path == f"//leaflight/{old.name}"
    assert_lit(obj)
    # What was written is right at once: the folder moves as a whole.
    here.rename(there)
    obj = _open(there / "scene.blend")
    assert obj.leaflight.bake_path == f"//leaflight/{old.name}"
    assert {image.filepath for image in _images(obj)} == {
        f"//leaflight/{path.name}" for path in atlases.beside(there / "leaflight" / old.name)
    }
    assert_lit(obj)


def check_undo_after_the_first_save_finds_what_has_moved(unsaved, tmp_path):
    name = unsaved.name
    unsaved.leaflight.isovalue = 60.0
    bpy.ops.ed.undo_push(message="sixty")
    unsaved.leaflight.isovalue = 80.0
    bpy.ops.ed.undo_push(message="eighty")
    _save(tmp_path / "scene.blend")
    bpy.ops.ed.undo()
    assert_lit(bpy.data.objects[name], 60.0)


def check_what_cannot_be_moved_stays_and_is_told(unsaved, tmp_path):
    old = bake_files.locate(unsaved)
    (tmp_path / "leaflight").write_text("A file where the folder would be.")
    obj = _open_saved(tmp_path / "scene.blend")
    sentence = surface_object.problems[obj.name_full]
    assert str(old) in sentence and "stays there" in sentence and "\n" not in sentence
    assert bake_files.locate(obj) == old
    obj = _open(tmp_path / "scene.blend")
    assert_lit(obj)


@pytest.mark.parametrize("linkable", [True, False])
def check_a_disk_that_fills_up_while_moving_loses_nothing(unsaved, tmp_path, monkeypatch, linkable):
    """Hard links where the file system has them, else copies, of which the second fails."""
    old = bake_files.locate(unsaved)
    files = {path: path.read_bytes() for path in (old, *atlases.beside(old))}
    made = []

    def full(call):
        def fails_later(*arguments):
            made.append(arguments)
            if len(made) > 1:
                raise OSError(errno.ENOSPC, "No space left on device")
            return call(*arguments)

        return fails_later

    def no_links(*_):
        raise OSError(errno.EXDEV, "Invalid cross-device link")

    name = "replace" if linkable else "copyfile"
    monkeypatch.setattr(moving.os, "link", os.link if linkable else no_links)
    owner = moving.os if linkable else moving.shutil
    monkeypatch.setattr(owner, name, full(getattr(owner, name)))
    obj = _open_saved(tmp_path / "scene.blend")
    monkeypatch.undo()
    assert len(made) > 1
    assert "No space left" in surface_object.problems[obj.name_full]
    assert {path: path.read_bytes() for path in files} == files
    assert not list((tmp_path / "leaflight").iterdir())
    assert_lit(_open(tmp_path / "scene.blend"))
    # With space again it goes where it belongs.
    _save(tmp_path / "scene.blend")
    obj = _volume()
    assert bake_files.locate(obj).parent == tmp_path / "leaflight" and not old.exists()
    assert_lit(obj)


def check_a_copy_saved_elsewhere_finds_the_bake(saved, tmp_path):
    path = bake_files.locate(saved)
    there = tmp_path / "there" / "deep"
    there.mkdir(parents=True)
    _save(there / "copy.blend", copy=True)
    _save(there / "other.blend")
    for name in ("other.blend", "copy.blend"):
        obj = _open(there / name)
        assert bake_files.locate(obj) == path
        assert_lit(obj)
    obj = _open(there / "other.blend")
    assert bpy.path.abspath(obj.leaflight.bake_path) != obj.leaflight.bake_path
    assert obj.leaflight.bake_path == "//../../here/leaflight/" + path.name


def check_an_appended_volume_finds_its_bake(saved, tmp_path):
    blend, name, path = bpy.data.filepath, saved.name, bake_files.locate(saved)
    bpy.ops.wm.read_homefile(use_empty=True)
    _save(tmp_path / "main.blend")
    with bpy.data.libraries.load(blend, link=False) as (_, wanted):
        wanted.objects = [name]
    obj = bpy.data.objects[name]
    bpy.context.scene.collection.objects.link(obj)
    obj.leaflight.isovalue = 77.0
    assert bake_files.locate(obj) == path
    assert_lit(obj, 77.0)
    _save(tmp_path / "main.blend")
    assert_lit(_open(tmp_path / "main.blend"), 77.0)


@pytest.fixture
def linked(saved, tmp_path):
    """A volume linked into another .blend, in another folder."""
    blend, name = bpy.data.filepath, saved.name
    bpy.ops.wm.read_homefile(use_empty=True)
    (tmp_path / "main").mkdir()
    _save(tmp_path / "main" / "main.blend")
    with bpy.data.libraries.load(blend, link=True) as (_, wanted):
        wanted.objects = [name]
    obj = next(o for o in bpy.data.objects if o.library is not None)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return obj


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
    _save(blend)
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(str(blend), link=True) as (_, wanted):
        wanted.objects = [name]
    (obj,) = (o for o in bpy.data.objects if o.leaflight.is_volume)
    bpy.context.scene.collection.objects.link(obj)
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
    _save(Path(bpy.data.filepath))
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
    bpy.ops.leaflight.build_cornell_box()
    own.leaflight.samples = 3
    bpy.ops.leaflight.bake()
    identifier = own.leaflight.bake_id
    assert identifier != library == linked.leaflight.bake_id
    _save(Path(bpy.data.filepath))
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    own = next(o for o in bpy.data.objects if o.override_library is not None)
    assert own.leaflight.bake_id == identifier
    assert bake_files.locate(own).parent == Path(bpy.data.filepath).parent / "leaflight"
    assert_lit(own)


def check_two_blends_in_one_folder_leave_each_other_alone(saved):
    first = Path(bpy.data.filepath)
    second = first.with_name("second.blend")
    _save(second)
    _brighten()
    bpy.ops.leaflight.bake()
    bright = _mean(saved)
    _save(second)
    obj = _open(first)
    assert _mean(obj) < 0.6 * bright
    assert_lit(obj)
    assert_lit(_open(second))


def check_objects_of_one_name_leave_each_other_alone(saved):
    """Renamed between two bakes: both files begin alike."""
    first = saved
    bpy.ops.object.select_all(action="DESELECT")
    first.select_set(True)
    bpy.ops.object.duplicate()
    second = bpy.context.object
    first.hide_render, first.name, second.name = True, "old", "bumps"
    _brighten()
    bpy.ops.leaflight.bake()
    for obj in (first, second):
        assert bake_files.locate(obj).name.startswith("bumps_")
        obj.leaflight.isovalue = 66.0
        assert_lit(obj, 66.0)
    assert _mean(second) > 1.8 * _mean(first)


def _duplicate(obj, linked):
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.duplicate(linked=linked)
    return bpy.context.object


@pytest.mark.parametrize("linked", [False, True])
def check_duplicates_show_each_their_isovalue(saved, linked):
    copy = _duplicate(saved, linked)
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
    copy = _duplicate(saved, True)
    meshes = len(bpy.data.meshes)
    for _ in range(3):
        bpy.context.view_layer.update()
        bpy.context.scene.frame_set(bpy.context.scene.frame_current + 1)
    assert copy.data == saved.data and len(bpy.data.meshes) == meshes
    # Moved together by default, they follow each other and settle.
    saved.leaflight.isovalue = 44.0
    for _ in range(2):
        bpy.context.view_layer.update()
    assert_lit(saved, 44.0)
    assert_lit(copy, 44.0)
    assert len(bpy.data.meshes) == meshes + 1


def check_a_linked_duplicate_may_look_otherwise(saved):
    copy = _duplicate(saved, True)
    copy.leaflight.capped = True
    assert copy.data.materials[0] == copy.leaflight.leaf_material
    assert saved.data.materials[0] == saved.leaflight.baked_material
    assert_lit(saved)


def check_both_duplicates_baked_together_have_each_their_light(saved):
    copy = _duplicate(saved, True)
    copy.location.x += 0.4
    saved.leaflight.samples = 2
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


def _displays(scene):
    return [obj for obj in scene.objects if display.is_display(obj, "wall")]


def check_walls_are_known_after_a_rename_and_in_a_copy_of_the_scene(saved):
    saved.leaflight.light_surroundings = True
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
    # Baked anew the object that now has the name is the one that counts.
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
    _save(Path(bpy.data.filepath))
    assert_lit(_open(bpy.data.filepath), 58.0)


def check_another_bake_under_the_right_name_is_not_taken_for_it(saved):
    blend, first = bpy.data.filepath, bake_files.locate(saved)
    _brighten()
    bpy.ops.leaflight.bake()
    shutil.copyfile(bake_files.locate(saved), first)
    obj = _open(blend)
    obj.leaflight.isovalue = 71.0
    sentence = surface_object.problems[obj.name_full]
    assert first.name in sentence and "another bake" in sentence and "\n" not in sentence
    assert staleness.change_since_bake(bpy.context, obj) == sentence
    assert "radiance" not in obj.data.attributes
    assert obj.data.materials[0] == obj.leaflight.leaf_material


@pytest.mark.parametrize("damage", ["gone", "another", "text"])
def check_an_atlas_that_is_not_of_the_bake_is_written_again(saved, damage):
    blend, path = bpy.data.filepath, bake_files.locate(saved)
    (atlas,) = atlases.beside(path)
    if damage == "gone":
        atlas.unlink()
    elif damage == "text":
        atlas.write_text("This is no image.")
    else:
        grid = cache.grid_of(saved)
        leaflight._core.write_exr(str(atlas), 9.0 * grid.atlas()[0], atlases.label("0", 0, False))
    obj = _open(blend)
    bpy.context.view_layer.update()
    assert_lit(obj)


def check_a_moved_bake_is_found_nearby_or_relocated(saved, tmp_path):
    blend, path = Path(bpy.data.filepath), bake_files.locate(saved)
    path.rename(blend.with_name("other name.vdb"))
    obj = _open(blend)
    assert bake_files.locate(obj) == blend.with_name("other name.vdb")
    assert_lit(obj)

    away = tmp_path / "away"
    away.mkdir()
    bake_files.locate(obj).rename(away / "x.vdb")
    obj = _open(blend)
    obj.leaflight.isovalue = 68.0
    assert "relocate" in surface_object.problems[obj.name_full]
    assert "relocate" in staleness.change_since_bake(bpy.context, obj)
    assert "radiance" not in obj.data.attributes
    bpy.ops.leaflight.relocate_bake(filepath=str(away / "x.vdb"))
    assert_lit(obj, 68.0)
    obj.leaflight.isovalue = 67.0
    assert_lit(obj, 67.0)
    assert staleness.change_since_bake(bpy.context, obj) == ""
    assert obj.leaflight.bake_path == "//../away/x.vdb"


def check_a_bake_that_comes_back_lights_the_surface_that_was_saved_without_it(saved):
    blend, path = bpy.data.filepath, bake_files.locate(saved)
    path.rename(path.with_suffix(".away"))
    obj = _open(blend)
    obj.leaflight.isovalue = 68.0
    assert "radiance" not in obj.data.attributes
    _save(Path(blend))
    path.with_suffix(".away").rename(path)
    obj = _open(blend)
    bpy.context.view_layer.update()
    assert_lit(obj, 68.0)


def check_a_damaged_bake_is_read_but_once(saved, monkeypatch):
    blend, path = bpy.data.filepath, bake_files.locate(saved)
    path.write_bytes(path.read_bytes()[:3000])
    obj = _open(blend)
    reads = []
    load = leaflight.load_bake

    def counted(path):
        reads.append(path)
        return load(path)

    monkeypatch.setattr(leaflight, "load_bake", counted)
    for _ in range(3):
        obj.leaflight.isovalue = 68.0
        bpy.context.view_layer.update()
    assert path.name in surface_object.problems[obj.name_full]
    assert "radiance" not in obj.data.attributes and len(reads) == 1


def check_relocating_to_another_bake_is_refused(saved):
    first = bake_files.locate(saved)
    _brighten()
    bpy.ops.leaflight.bake()
    identifier = saved.leaflight.bake_id
    sentence = error_of(bpy.ops.leaflight.relocate_bake, filepath=str(first))
    assert "another bake" in sentence and first.name in sentence and "\n" not in sentence
    assert saved.leaflight.bake_id == identifier
    assert_lit(saved)


def _command_line_bake(path, volume, **settings):
    scene = leaflight.cornell_box()
    bake = leaflight.bake(volume, scene, samples=4, photons=20_000, **settings)
    bake.save(path)
    return bake


def check_a_bake_of_the_command_line_comes_with_its_scene(tmp_path):
    bake = _command_line_bake(tmp_path / "cli.vdb", leaflight.bump_box(20))
    bpy.ops.leaflight.load_bake(filepath=str(tmp_path / "cli.vdb"))
    obj = _volume()
    assert obj.leaflight.bake_id == bake.id
    assert {mesh.name for mesh in bake.scene.meshes} <= set(bpy.data.objects.keys())
    assert_lit(obj)
    assert staleness.change_since_bake(bpy.context, obj) == ""
    obj.leaflight.isovalue = 80.0
    assert_lit(obj, 80.0)
    # What Blender bakes of what came in is what the command line baked.
    obj.leaflight.samples, obj.leaflight.photons = 4, 20_000
    obj.leaflight.bake_folder = str(tmp_path)
    bpy.ops.leaflight.bake()
    again = cache.bake_of(obj)
    assert again.id != bake.id
    points = bake.surface(80.0).vertices
    ours, theirs = again.radiance(points), bake.radiance(points)
    assert abs(ours.mean() / theirs.mean() - 1) < 0.02


def check_all_kinds_of_lights_come_with_a_bake(boxed, tmp_path):
    lights = bpy.data.lights
    for kind in ("POINT", "SPOT", "SUN"):
        obj = bpy.data.objects.new(kind, lights.new(kind, kind))
        obj.location, obj.rotation_euler = (0.3, 0.1, 1.7), (0.3, 0.2, 0.1)
        obj.data.energy, obj.data.color = 3.0, (1.0, 0.5, 0.25)
        obj.data.shadow_soft_size = 0.02
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = boxed
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    path = bake_files.locate(boxed)
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.leaflight.load_bake(filepath=str(path))
    obj = _volume()
    assert {"POINT", "SPOT", "SUN", "AREA"} == {light.type for light in bpy.data.lights}
    assert staleness.change_since_bake(bpy.context, obj) == ""
    assert_lit(obj)


def check_a_bake_lights_the_volume_that_was_imported(bump_file, bumps, tmp_path):
    volume = leaflight.read_volume(
        bump_file, dims=(24, 24, 24), type="float32", spacing=(1.0, 1.0, 0.8)
    )
    bake = _command_line_bake(tmp_path / "cli.vdb", volume)
    objects = len(bpy.data.objects)
    bpy.ops.leaflight.load_bake(filepath=str(tmp_path / "cli.vdb"))
    assert len(bpy.data.objects) == objects and bumps.leaflight.bake_id == bake.id
    assert_lit(bumps)
    # It does not stand where it was baked, nor has it walls about it.
    assert "another scene" in staleness.change_since_bake(bpy.context, bumps)


def check_a_bake_of_another_volume_leaves_the_selected_one_alone(bumps, tmp_path):
    _command_line_bake(tmp_path / "cli.vdb", leaflight.bump_box(20))
    bpy.ops.leaflight.load_bake(filepath=str(tmp_path / "cli.vdb"))
    assert bumps.leaflight.bake_id == ""
    other = bpy.context.object
    assert other != bumps
    assert_lit(other)


def check_a_bake_of_several_volumes_comes_whole(tmp_path):
    volumes = [leaflight.bump_box(16), leaflight.bump_box(12)]
    volumes[1].index_to_world[:3, 3] = (1.2, 0.0, 0.0)
    volumes = [leaflight.Volume(v.values, v.index_to_world, f"v{i}") for i, v in enumerate(volumes)]
    bake = _command_line_bake(tmp_path / "cli.vdb", volumes)
    bpy.ops.leaflight.load_bake(filepath=str(tmp_path / "cli.vdb"))
    found = [o for o in bpy.data.objects if o.leaflight.is_volume]
    assert sorted(o.leaflight.bake_index for o in found) == [0, 1]
    for obj in found:
        assert obj.leaflight.bake_id == bake.id
        assert_lit(obj)
        assert staleness.change_since_bake(bpy.context, obj) == ""


def check_what_is_no_bake_is_refused(bumps, tmp_path):
    (tmp_path / "x.vdb").write_text("This is no bake.")
    for operator in (bpy.ops.leaflight.load_bake,):
        sentence = error_of(operator, filepath=str(tmp_path / "x.vdb"))
        assert "x.vdb" in sentence and "\n" not in sentence
    assert bumps.leaflight.bake_id == ""
    with pytest.raises(RuntimeError, match="Bake the flattened illumination first"):
        bpy.ops.leaflight.relocate_bake(filepath=str(tmp_path / "x.vdb"))


def check_a_bake_of_an_earlier_version_says_so(saved):
    """Its file has no id, and the object has one that no file knows."""
    blend, path = bpy.data.filepath, bake_files.locate(saved)
    bake = cache.bake_of(saved)
    metadata = dict(bake.metadata, statistics="{}")
    fields = [volume.field() for volume in bake.volumes]
    leaflight._core.write_bake(str(path), fields, bake.grids, None, metadata)
    obj = _open(blend)
    obj.leaflight.isovalue = 61.0
    sentence = surface_object.problems[obj.name_full]
    assert "earlier Leaflight; bake the volume again" in sentence and "\n" not in sentence
    assert "radiance" not in obj.data.attributes


def check_a_changed_volume_file_is_told_and_baked_anew(saved, bump_file):
    values = np.fromfile(bump_file, "<f4")
    os.utime(bump_file, ns=(1, 1))
    obj = _open(bpy.data.filepath)
    # Touched is not changed.
    assert staleness.change_since_bake(bpy.context, obj) == ""
    values[values.size // 2] += 1.0
    values.tofile(bump_file)
    staleness.forget()
    sentence = staleness.change_since_bake(bpy.context, obj)
    assert "bumps.raw has changed since the bake" in sentence and "\n" not in sentence
    # Until then it shows what was baked.
    obj.leaflight.isovalue = 72.0
    assert_lit(obj, 72.0)
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    np.testing.assert_array_equal(cache.bake_of(obj).volume.values.ravel(), values)
    assert_lit(obj)


def check_a_bake_that_cannot_be_written_leaves_the_old_one(saved, monkeypatch):
    before, folder = saved.leaflight.bake_id, bake_files.locate(saved).parent
    files = sorted(folder.iterdir())
    _brighten()

    def full(*_):
        raise leaflight.LeaflightError("the disk is full.")

    # A disk that fills up between the bake and its atlas.
    monkeypatch.setattr(atlases, "_write", full)
    assert "full" in error_of(bpy.ops.leaflight.bake)
    assert sorted(folder.iterdir()) == files and saved.leaflight.bake_id == before
    assert_lit(saved)


def check_unused_bakes_go_when_asked(saved):
    first = bake_files.locate(saved)
    with pytest.raises(RuntimeError, match="Every bake"):
        bpy.ops.leaflight.remove_unused_bakes()
    _brighten()
    bpy.ops.leaflight.bake()
    second = bake_files.locate(saved)
    foreign = first.parent / "volume.vdb"
    foreign.write_text("Not a bake.")
    bpy.ops.leaflight.remove_unused_bakes()
    assert not first.exists() and not atlases.beside(first)
    assert second.exists() and atlases.beside(second) and foreign.exists()


def check_bakes_of_unsaved_files_stay_visible(unsaved, tmp_path):
    first = bake_files.locate(unsaved)
    _brighten()
    bpy.ops.leaflight.bake()
    second = bake_files.locate(unsaved)
    given_up, recent = (bake_files.user_folder() / f"unsaved_{name}" for name in ("old", "new"))
    for folder in (given_up, recent):
        folder.mkdir()
        shutil.copy(first, folder)
    os.utime(given_up, (1, 1))
    assert set(unused_bakes.unused()) == {given_up / first.name, first}
    _save(tmp_path / "scene.blend")
    moved = tmp_path / "leaflight" / second.name
    assert set(unused_bakes.of_this_file()) == {moved, first, given_up / first.name}
    bpy.ops.leaflight.remove_unused_bakes()
    assert moved.exists() and (recent / first.name).exists()
    assert not first.exists() and not given_up.exists()
    shutil.rmtree(recent)


def check_messages_speak_of_settings_and_not_of_flags(tmp_path):
    path = tmp_path / "x.raw"
    path.write_bytes(bytes(100))
    for arguments in ({}, {"dims": (3, 3, 3), "value_type": "uint8"}, {"frame": 1}):
        sentence = error_of(bpy.ops.leaflight.import_volume, filepath=str(path), **arguments)
        assert "x.raw" in sentence and "--" not in sentence and "\n" not in sentence
