# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks Up and Front: from files, by menus, and by rotations of 90 degrees, before and after
a bake.
"""

from types import SimpleNamespace

import bpy
import nibabel
import numpy as np
import pytest
from blends import open_saved
from leaflight_addon.show import isosurfaces
from leaflight_addon.stage import orientation, stage
from leaflight_addon.store import source_files
from tools import close, to_world, vertices_of


@pytest.fixture
def scan(bumps):
    """Writes a .raw file, which has no orientation, longer along x and y than along z."""
    bpy.context.view_layer.update()
    return bumps


def _axes(obj):
    """Returns the names of the volume's axes that point right, back and up."""
    matrix = np.array(obj.matrix_world.to_3x3().normalized())
    names = list(orientation.AXES)
    vectors = np.array(list(orientation.AXES.values()))
    return tuple(names[int(np.argmax(vectors @ matrix[row]))] for row in range(3))


def check_a_file_without_orientation_is_said_once(scan):
    assert scan.leaflight_orientation.is_unknown
    assert (scan.leaflight_orientation.up, scan.leaflight_orientation.front) == ("POS_Z", "NEG_Y")
    scan.leaflight_orientation.up = "POS_Z"
    assert not scan.leaflight_orientation.is_unknown and _axes(scan) == ("POS_X", "POS_Y", "POS_Z")


@pytest.mark.parametrize("up", orientation.AXES)
@pytest.mark.parametrize("front", orientation.AXES)
def check_the_menus_give_the_axes_that_they_name(scan, up, front):
    chosen = scan.leaflight_orientation
    chosen.up, chosen.front = up, front
    assert chosen.front == front
    if {up[-1], front[-1]} == {up[-1]}:
        return
    assert chosen.up == up
    assert _axes(scan)[2] == up and orientation.AXES[_axes(scan)[1]] == tuple(
        -x for x in orientation.AXES[front]
    )
    assert np.linalg.det(np.array(scan.matrix_world)[:3, :3]) > 0
    assert abs(isosurfaces.world_box(scan)[0, 2]) < 1e-5


@pytest.mark.parametrize(
    "way, axes",
    [
        ("TIP", ("POS_X", "NEG_Z", "POS_Y")),
        ("ROLL", ("POS_Z", "POS_Y", "NEG_X")),
        ("TURN", ("NEG_Y", "POS_X", "POS_Z")),
    ],
)
def check_four_turns_are_none(scan, way, axes):
    before = scan.matrix_world.copy()
    bpy.ops.leaflight.turn_volume(way=way)
    assert _axes(scan) == axes
    for _ in range(3):
        bpy.ops.leaflight.turn_volume(way=way)
    close(scan.matrix_world, before, 1e-5)


def check_each_turn_has_its_tooltip():
    description = orientation.LEAFLIGHT_OT_turn_volume.description
    texts = {description(None, SimpleNamespace(way=way)) for way in ("TIP", "ROLL", "TURN")}
    assert len(texts) == 3 and all(texts)


def check_a_stage_follows_without_being_staged_again(scan):
    cube = bpy.data.objects.new("cube", bpy.data.meshes.new("cube"))
    bpy.context.scene.collection.objects.link(cube)
    bpy.ops.leaflight.stage(preset="STUDIO")
    scan.leaflight_orientation.up = "POS_X"
    bpy.context.view_layer.update()
    lowest = to_world(scan, vertices_of(scan))[:, 2].min()
    backdrop = bpy.data.objects["backdrop"]
    assert stage.is_staged(backdrop) and cube.hide_render
    assert 0 < lowest - to_world(backdrop, vertices_of(backdrop))[:, 2].min() < 0.05


def check_after_a_bake_the_light_goes_and_it_is_said(scan):
    bpy.ops.leaflight.stage(preset="STUDIO")
    scan.leaflight.resolution, scan.leaflight.error = 8, 20.0
    bpy.ops.leaflight.bake()
    bpy.ops.leaflight.turn_volume(way="TIP")
    assert not scan.leaflight.bake_id and "backdrop Lit" not in bpy.data.objects
    assert "radiance" not in scan.data.attributes
    assert not bpy.data.objects["backdrop"].hide_render


def check_undo_brings_back_the_light_with_the_orientation(scan):
    bpy.ops.leaflight.stage(preset="CORNELL")
    bpy.ops.leaflight.bake()
    bpy.ops.ed.undo_push(message="Bake")
    name, baked = scan.name, scan.leaflight.bake_id
    bpy.ops.leaflight.turn_volume(way="TIP")
    bpy.ops.ed.undo_push(message="Turn 90 Degrees")
    assert not bpy.data.objects[name].leaflight.bake_id
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    assert obj.leaflight.bake_id == baked and "radiance" in obj.data.attributes
    assert "floor Lit" in bpy.data.objects
    assert _axes(obj) == ("POS_X", "POS_Y", "POS_Z")
    bpy.ops.ed.redo()
    obj = bpy.data.objects[name]
    assert not obj.leaflight.bake_id and obj.leaflight_orientation.up == "POS_Y"


def check_a_choice_survives_saving(scan, tmp_path):
    scan.leaflight_orientation.front = "POS_X"
    matrix = scan.matrix_world.copy()
    obj = open_saved(tmp_path / "scene.blend")
    assert obj.leaflight_orientation.front == "POS_X" and not obj.leaflight_orientation.is_unknown
    close(obj.matrix_world, matrix, 1e-6)


def check_what_is_registered_turns_together(tmp_path):
    values = np.random.default_rng(0).normal(size=(12, 14, 16)).astype(np.float32)
    for name in "ab":
        affine = np.diag([1.0, 1.0, 1.0 if name == "a" else 1.5, 1.0])
        nibabel.save(nibabel.Nifti1Image(values, affine), tmp_path / f"{name}.nii")
        bpy.ops.leaflight.import_volume(filepath=str(tmp_path / f"{name}.nii"))
    first, second = bpy.data.objects["a"], bpy.data.objects["b"]
    close(source_files.place_of_file(first), source_files.place_of_file(second), 1e-6)
    assert first.leaflight_orientation.front == "POS_Y" == second.leaflight_orientation.front
    second.leaflight_orientation.up = "NEG_Z"
    bpy.context.view_layer.update()
    close(source_files.place_of_file(first), source_files.place_of_file(second), 1e-6)
    assert _axes(first)[2] == "NEG_Z" == _axes(second)[2]


def check_the_import_takes_them(bump_file):
    bpy.ops.leaflight.import_volume(
        filepath=str(bump_file), dims=(24, 24, 24), value_type="float32", up="NEG_Z", front="POS_X"
    )
    obj = bpy.context.object
    bpy.context.view_layer.update()
    assert _axes(obj)[1:] == ("NEG_X", "NEG_Z") and not obj.leaflight_orientation.is_unknown
    close(isosurfaces.world_box(obj)[0, 2], 0, 1e-5)
