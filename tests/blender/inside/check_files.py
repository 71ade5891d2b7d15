# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that bakes are found after undo, in older files, and when a .blend is saved elsewhere."""

import errno
import os
import shutil
from pathlib import Path

import bpy
import leaflight
import pytest
from blends import (
    assert_lit,
    brighten,
    images_of,
    mean_radiance,
    open_blend,
    open_saved,
    save,
    volume_object,
)
from leaflight_addon.bake import load_bake
from leaflight_addon.show import surface_object
from leaflight_addon.stage import staleness
from leaflight_addon.store import atlases, bake_files
from tools import close, error_of


def check_every_bake_is_a_file_of_its_own_with_its_id(saved):
    first = bake_files.locate(saved)
    before = first.read_bytes()
    brighten()
    bpy.ops.leaflight.bake()
    second = bake_files.locate(saved)
    assert first.parent == second.parent == Path(bpy.data.filepath).parent / "leaflight"
    assert first != second and first.read_bytes() == before
    for path in (first, second):
        assert path.name.startswith("bumps_") and bake_files.id_in(path)[:12] in path.name
    # The same bake must have the same file.
    bpy.ops.leaflight.bake()
    assert bake_files.locate(saved) == second
    # Test a volume that comes from the file of the bake, too.
    save(Path(bpy.data.filepath))
    obj = open_blend(bpy.data.filepath)
    bpy.ops.leaflight.bake()
    assert bake_files.locate(obj) == second
    assert len(bake_files.bakes_in(second.parent)) == 2


def check_a_bake_is_a_volume_of_blender(saved):
    """Checks that Blender reads the file in spite of the seal at its end."""
    path = bake_files.locate(saved)
    assert leaflight._core.has_seal(path)
    bpy.ops.object.volume_import(filepath=str(path))
    volume = bpy.context.object.data
    assert volume.grids.load() and not volume.grids.error_message
    grids = {grid.name: grid for grid in volume.grids}
    assert grids["radiance"].data_type == "VECTOR_FLOAT" and grids["radiance"].channels == 3


def check_undo_after_a_second_bake_shows_the_first(saved):
    name = saved.name
    bpy.ops.ed.undo_push(message="first")
    dim = mean_radiance(saved)
    brighten()
    bpy.ops.leaflight.bake()
    bpy.ops.ed.undo_push(message="second")
    assert mean_radiance(saved) > 1.8 * dim
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    close(mean_radiance(obj), dim, 1e-6)
    assert_lit(obj)
    obj.leaflight.isovalue = 90.0
    assert_lit(obj, 90.0)
    bpy.ops.ed.redo()


def check_an_older_blend_shows_its_own_bake(saved, tmp_path):
    older = Path(bpy.data.filepath)
    dim = mean_radiance(saved)
    brighten()
    bpy.ops.leaflight.bake()
    save(older.with_name("newer.blend"))
    obj = open_blend(older)
    close(mean_radiance(obj), dim, 1e-6)
    assert_lit(obj)
    assert staleness.change_since_bake(bpy.context, obj) == ""
    obj.leaflight.isovalue = 90.0
    assert_lit(obj, 90.0)
    assert_lit(open_blend(older.with_name("newer.blend")))


def check_the_first_save_takes_the_bake_along(unsaved, tmp_path):
    old = bake_files.locate(unsaved)
    assert old.parent == bake_files.session_folder() and os.path.isabs(unsaved.leaflight.bake_path)
    here, there = tmp_path / "here", tmp_path / "there"
    obj = open_saved(here / "scene.blend")
    assert not old.exists() and not atlases.beside(old) and not old.parent.exists()
    assert obj.leaflight.bake_path == f"//leaflight/{old.name}"
    assert_lit(obj)
    # The .blend was saved correctly at once, so its folder can be moved.
    here.rename(there)
    obj = open_blend(there / "scene.blend")
    assert obj.leaflight.bake_path == f"//leaflight/{old.name}"
    # Blender writes the path separators of its system, and reads both.
    assert {image.filepath.replace(os.sep, "/") for image in images_of(obj)} == {
        f"//leaflight/{path.name}" for path in atlases.beside(there / "leaflight" / old.name)
    }
    assert_lit(obj)


def check_undo_after_the_first_save_finds_what_has_moved(unsaved, tmp_path):
    name = unsaved.name
    unsaved.leaflight.isovalue = 60.0
    bpy.ops.ed.undo_push(message="sixty")
    unsaved.leaflight.isovalue = 80.0
    bpy.ops.ed.undo_push(message="eighty")
    save(tmp_path / "scene.blend")
    bpy.ops.ed.undo()
    assert_lit(bpy.data.objects[name], 60.0)


def check_what_cannot_be_moved_stays_and_is_reported(unsaved, tmp_path):
    old = bake_files.locate(unsaved)
    (tmp_path / "leaflight").write_text("A file where the folder would be.")
    obj = open_saved(tmp_path / "scene.blend")
    sentence = surface_object.problems[obj.name_full]
    assert str(old) in sentence and "stays here" in sentence and "\n" not in sentence
    assert bake_files.locate(obj) == old
    obj = open_blend(tmp_path / "scene.blend")
    assert_lit(obj)


def can_link(path, folder):
    try:
        os.link(path, folder / path.name)
    except OSError:
        return False
    (folder / path.name).unlink()
    return True


@pytest.mark.parametrize("linkable", [True, False])
def check_a_disk_that_fills_up_while_moving_loses_nothing(unsaved, tmp_path, monkeypatch, linkable):
    """Checks hard links, and copies if the file system has no links; the second file finds no
    space.
    """
    old = bake_files.locate(unsaved)
    files = {path: path.read_bytes() for path in (old, *atlases.beside(old))}
    if linkable and not can_link(old, tmp_path):
        pytest.skip("the two folders are on two disks")
    made = []

    def no_space(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    def full(call):
        def fails_later(*arguments):
            made.append(arguments)
            return no_space() if len(made) > 1 else call(*arguments)

        return fails_later

    def no_links(*_):
        raise OSError(errno.EXDEV, "Invalid cross-device link")

    copy = no_space if linkable else full(shutil.copyfile)
    monkeypatch.setattr(bake_files.os, "link", full(os.link) if linkable else no_links)
    monkeypatch.setattr(bake_files.shutil, "copyfile", copy)
    obj = open_saved(tmp_path / "scene.blend")
    monkeypatch.undo()
    assert len(made) > 1
    assert "No space left" in surface_object.problems[obj.name_full]
    assert {path: path.read_bytes() for path in files} == files
    assert not list((tmp_path / "leaflight").iterdir())
    assert_lit(open_blend(tmp_path / "scene.blend"))
    # With space again, the file moves to its place.
    save(tmp_path / "scene.blend")
    obj = volume_object()
    assert bake_files.locate(obj).parent == tmp_path / "leaflight" and not old.exists()
    assert_lit(obj)


def check_a_copy_saved_elsewhere_finds_the_bake(saved, tmp_path):
    path = bake_files.locate(saved)
    there = tmp_path / "there" / "deep"
    there.mkdir(parents=True)
    save(there / "copy.blend", copy=True)
    save(there / "other.blend")
    for name in ("other.blend", "copy.blend"):
        obj = open_blend(there / name)
        assert bake_files.locate(obj) == path
        assert_lit(obj)
    obj = open_blend(there / "other.blend")
    assert bpy.path.abspath(obj.leaflight.bake_path) != obj.leaflight.bake_path
    assert obj.leaflight.bake_path == "//../../here/leaflight/" + path.name


def check_a_bake_that_cannot_be_written_leaves_the_old_one(saved, monkeypatch):
    before, folder = saved.leaflight.bake_id, bake_files.locate(saved).parent
    files = sorted(folder.iterdir())
    brighten()

    def full(*_):
        raise leaflight.LeaflightError("the disk is full.")

    # Simulate a disk that fills up between the bake and its atlas.
    monkeypatch.setattr(atlases, "_write", full)
    assert "full" in error_of(bpy.ops.leaflight.bake)
    assert sorted(folder.iterdir()) == files and saved.leaflight.bake_id == before
    assert_lit(saved)


def check_unused_bakes_go_when_asked(saved):
    first = bake_files.locate(saved)
    assert "Each bake" in error_of(bpy.ops.leaflight.remove_unused_bakes)
    brighten()
    bpy.ops.leaflight.bake()
    second = bake_files.locate(saved)
    foreign = first.parent / "volume.vdb"
    foreign.write_text("Not a bake.")
    bpy.ops.leaflight.remove_unused_bakes()
    assert not first.exists() and not atlases.beside(first)
    assert second.exists() and atlases.beside(second) and foreign.exists()


def check_bakes_of_unsaved_files_stay_visible(unsaved, tmp_path):
    first = bake_files.locate(unsaved)
    brighten()
    bpy.ops.leaflight.bake()
    second = bake_files.locate(unsaved)
    given_up, recent = (bake_files.user_folder() / f"unsaved_{name}" for name in ("old", "new"))
    for folder in (given_up, recent):
        folder.mkdir()
        shutil.copy(first, folder)
    os.utime(given_up, (1, 1))
    assert set(load_bake.unused()) == {given_up / first.name, first}
    save(tmp_path / "scene.blend")
    moved = tmp_path / "leaflight" / second.name
    assert set(load_bake.bakes_of_this_file()) == {moved, first, given_up / first.name}
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
