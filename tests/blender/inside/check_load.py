# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks Load Bake and Relocate Bake, and files with other contents than an object expects."""

import os
import shutil
from pathlib import Path

import bpy
import leaflight
import numpy as np
import pytest
from blends import assert_lit, brighten, open_blend, save, volume_object
from leaflight_addon.show import surface_object
from leaflight_addon.stage import staleness
from leaflight_addon.store import atlases, bake_files, cache, reading
from tools import error_of


def _command_line_bake(path, volume, **settings):
    scene = leaflight.cornell_box()
    bake = leaflight.bake(volume, scene, error=5.0, resolution=20, **settings)
    bake.save(path)
    return bake


def check_another_bake_under_the_right_name_is_not_taken_for_it(saved):
    blend, first = bpy.data.filepath, bake_files.locate(saved)
    brighten()
    bpy.ops.leaflight.bake()
    shutil.copyfile(bake_files.locate(saved), first)
    obj = open_blend(blend)
    obj.leaflight.isovalue = 71.0
    sentence = surface_object.problems[obj.name_full]
    assert first.name in sentence and "not the bake of" in sentence and "\n" not in sentence
    assert staleness.change_since_bake(bpy.context, obj) == sentence
    assert "radiance" not in obj.data.attributes
    assert obj.data.materials[0] == obj.leaflight.isosurface_material


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
    obj = open_blend(blend)
    bpy.context.view_layer.update()
    assert_lit(obj)


def check_a_moved_bake_is_found_nearby_or_relocated(saved, tmp_path):
    blend, path = Path(bpy.data.filepath), bake_files.locate(saved)
    path.rename(blend.with_name("other name.vdb"))
    obj = open_blend(blend)
    assert bake_files.locate(obj) == blend.with_name("other name.vdb")
    assert_lit(obj)

    away = tmp_path / "away"
    away.mkdir()
    bake_files.locate(obj).rename(away / "x.vdb")
    obj = open_blend(blend)
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
    obj = open_blend(blend)
    obj.leaflight.isovalue = 68.0
    assert "radiance" not in obj.data.attributes
    save(Path(blend))
    path.with_suffix(".away").rename(path)
    obj = open_blend(blend)
    bpy.context.view_layer.update()
    assert_lit(obj, 68.0)


def check_a_damaged_bake_is_read_but_once(saved, monkeypatch):
    blend, path = bpy.data.filepath, bake_files.locate(saved)
    path.write_bytes(path.read_bytes()[:3000])
    obj = open_blend(blend)
    reads = []
    open_bake = reading.open_bake

    def counted(path, progress):
        reads.append(path)
        return open_bake(path, progress)

    monkeypatch.setattr(reading, "open_bake", counted)
    for _ in range(3):
        obj.leaflight.isovalue = 68.0
        bpy.context.view_layer.update()
    assert path.name in surface_object.problems[obj.name_full]
    assert "radiance" not in obj.data.attributes and len(reads) == 1


def check_relocating_to_another_bake_is_refused(saved):
    first = bake_files.locate(saved)
    brighten()
    bpy.ops.leaflight.bake()
    identifier = saved.leaflight.bake_id
    sentence = error_of(bpy.ops.leaflight.relocate_bake, filepath=str(first))
    assert "not the bake of" in sentence and first.name in sentence and "\n" not in sentence
    assert saved.leaflight.bake_id == identifier
    assert_lit(saved)


def check_a_bake_of_the_command_line_comes_with_its_scene(tmp_path):
    bake = _command_line_bake(tmp_path / "cli.vdb", leaflight.bump_box(20))
    bpy.ops.leaflight.load_bake(filepath=str(tmp_path / "cli.vdb"))
    obj = volume_object()
    assert obj.leaflight.bake_id == bake.id
    assert {mesh.name for mesh in bake.scene.meshes} <= set(bpy.data.objects.keys())
    assert_lit(obj)
    assert staleness.change_since_bake(bpy.context, obj) == ""
    obj.leaflight.isovalue = 80.0
    assert_lit(obj, 80.0)
    # Baking the loaded scene must give the light of the command line.
    obj.leaflight.error, obj.leaflight.resolution = 5.0, 20
    obj.leaflight.seed = 1
    obj.leaflight.bake_folder = str(tmp_path)
    bpy.ops.leaflight.bake()
    again = cache.bake_of(obj)
    assert again.id != bake.id
    points, _, _ = leaflight._core.contour(bake.volume.field(), 80.0)
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
    obj = volume_object()
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
    # The volume has another position than in the bake, and no walls.
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
    sentence = error_of(bpy.ops.leaflight.load_bake, filepath=str(tmp_path / "x.vdb"))
    assert "x.vdb" in sentence and "\n" not in sentence
    assert bumps.leaflight.bake_id == ""
    assert "Bake this volume first" in error_of(
        bpy.ops.leaflight.relocate_bake, filepath=str(tmp_path / "x.vdb")
    )


def check_a_bake_of_an_earlier_version_says_so(saved):
    """Checks the message for a file without an id, while the object stores an id."""
    blend, path = bpy.data.filepath, bake_files.locate(saved)
    bake = cache.bake_of(saved)
    metadata = {"statistics": "{}"}
    fields = [volume.field() for volume in bake.volumes]
    leaflight._core.write_bake(str(path), fields, bake.grids, None, metadata)
    obj = open_blend(blend)
    obj.leaflight.isovalue = 61.0
    sentence = surface_object.problems[obj.name_full]
    assert "earlier version" in sentence and "\n" not in sentence
    assert "radiance" not in obj.data.attributes


def check_a_changed_volume_file_is_reported_and_baked_anew(saved, bump_file):
    values = np.fromfile(bump_file, "<f4")
    os.utime(bump_file, ns=(1, 1))
    obj = open_blend(bpy.data.filepath)
    # A touched file is unchanged.
    assert staleness.change_since_bake(bpy.context, obj) == ""
    values[values.size // 2] += 1.0
    values.tofile(bump_file)
    staleness.forget()
    sentence = staleness.change_since_bake(bpy.context, obj)
    assert "bumps.raw have changed" in sentence and "\n" not in sentence
    # Until the new bake, the baked isovalue range is shown.
    obj.leaflight.isovalue = 72.0
    assert_lit(obj, 72.0)
    bpy.ops.leaflight.bake()
    assert staleness.change_since_bake(bpy.context, obj) == ""
    np.testing.assert_array_equal(cache.bake_of(obj).volume.values.ravel(), values)
    assert_lit(obj)
