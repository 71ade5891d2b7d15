# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks animations, the scale bar, and letters and a cube for a patient's directions."""

import bpy
import nibabel
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from leaflight import blender
from blends import reopened
from leaflight_addon.edit import labels
from leaflight_addon.store import cache, frame_bakes
from leaflight_addon.stage import scene_export
from leaflight_addon.show import isosurface, surface_object
from mathutils import Vector
from tools import (
    add_camera,
    close,
    colors_of,
    error_of,
    mesh_arrays,
    to_world,
    vertices_of,
)


@pytest.fixture
def patient(tmp_path):
    z, y, x = np.mgrid[:16, :16, :16].astype(np.float32)
    ball = 9.0 - np.sqrt((x - 8) ** 2 + (y - 8) ** 2 + (z - 8) ** 2)
    image = nibabel.Nifti1Image(ball, np.diag([10.0, 10.0, 10.0, 1.0]))
    image.header.set_xyzt_units("mm")
    nibabel.save(image, str(tmp_path / "ball.nii"))
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "ball.nii"))
    obj = bpy.context.object
    add_camera((0.0, -6.0, 1.0), (np.pi / 2, 0.0, 0.0))
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    return obj


def check_a_sweep_shows_the_whole_range(patient, monkeypatch):
    made, make = [], isosurface.isosurface_of
    monkeypatch.setattr(isosurface, "isosurface_of", lambda *a: made.append(a) or make(*a))
    bpy.ops.leaflight.animate(kind="SWEEP", frames=11)
    # Invisible isosurfaces must not be extracted.
    assert len(made) < 3
    for frame, part in ((1, 0.0), (6, 0.5), (11, 1.0)):
        bpy.context.scene.frame_set(frame)
        settings = patient.leaflight
        expected = settings.low + part * (settings.high - settings.low)
        assert surface_object.shown_isovalue(patient) == pytest.approx(expected, rel=1e-4)
    assert bpy.context.scene.frame_end == 11


def check_a_lit_wipe_cuts_the_data_and_bakes_each_cut(boxed, tmp_path):
    obj, name, scene = boxed, boxed.name, bpy.context.scene
    bpy.ops.leaflight.bake()
    whole, unframed = vertices_of(obj), obj.leaflight.frame
    bpy.ops.leaflight.animate(kind="LIT_WIPE", frames=4)
    assert (scene.frame_start, scene.frame_end) == (1, 4) and obj.leaflight.frames == 4
    low, high = whole[:, 0].min(), whole[:, 0].max()

    def starts(obj, frame):
        bpy.context.scene.frame_set(frame)
        return (vertices_of(obj)[:, 0].min() - low) / (high - low)

    # The cut moves evenly from one end of the isosurface to eight tenths.
    found = [starts(obj, frame) for frame in (1, 2, 3, 4)]
    close(found, np.linspace(0.0, 0.8, 4), 0.05)
    # Until it is baked, a frame has an estimate by the bake of the whole.
    assert frame_bakes.count_baked(obj.leaflight) == 0 and not frame_bakes.is_baked(obj.leaflight)
    assert colors_of(obj).max() > 0
    blender.bake_frames(obj, error=20.0)
    assert frame_bakes.count_baked(obj.leaflight) == 4
    bakes = set()
    for is_saved in (False, True):
        obj = reopened(tmp_path / "scene.blend") if is_saved else obj
        obj.leaflight.shading = "ATTRIBUTE"
        for frame in (3, 1, 4, 2):
            close(starts(obj, frame), found[frame - 1], 1e-6)
            assert frame_bakes.is_baked(obj.leaflight)
            vertices, _, radiance = mesh_arrays(obj)
            expected = cache.bake_of(obj).radiance(to_world(obj, vertices))
            assert np.quantile(abs(radiance - expected), 0.97) < 1e-4 * expected.max()
            on_cut = vertices[:, 0] < vertices[:, 0].min() + 1e-3
            assert frame == 1 or radiance[on_cut].mean() > 0.02
            bakes.add((frame, obj.leaflight.bake_id))
    assert len(bakes) == 4
    bpy.context.scene.frame_set(1)
    bpy.ops.ed.undo_push(message="wiped")
    # Without its cut the volume is whole again.
    bpy.ops.leaflight.switch_region(index=0, action="REMOVE")
    bpy.ops.ed.undo_push(message="whole")
    settings = obj.leaflight
    assert (settings.frames, settings.frame, settings.regions) == (1, unframed, "")
    close(vertices_of(obj)[:, 0].min(), low, 1e-4)
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    assert obj.leaflight.frames == 4
    close(starts(obj, 3), found[2], 1e-6)


def check_a_frame_of_a_lit_wipe_is_chosen_without_its_surface(boxed, monkeypatch):
    """Checks that saving, which visits each frame, need not read its bake."""
    bpy.ops.leaflight.animate(kind="LIT_WIPE", frames=2)
    before, updated = boxed.leaflight.regions, []
    monkeypatch.setattr(surface_object, "update", lambda *given: updated.append(given))
    assert frame_bakes.switch(boxed, 1)
    assert boxed.leaflight.regions != before and not updated


def check_a_lit_wipe_needs_a_file_of_one_frame(boxed):
    boxed.leaflight.frames = 2
    assert "changes over time: use Wipe" in error_of(bpy.ops.leaflight.animate, kind="LIT_WIPE")
    boxed.leaflight.frames, boxed.leaflight.source = 1, ""
    assert "has no volume file to cut" in error_of(bpy.ops.leaflight.animate, kind="LIT_WIPE")


def check_a_turntable_looks_at_the_volume_from_all_sides(patient):
    camera = bpy.context.scene.camera
    before = camera.matrix_world.copy()
    bpy.ops.leaflight.animate(kind="TURNTABLE", frames=8)
    close(camera.matrix_world, before, 1e-5)
    bpy.context.scene.frame_set(3)
    turned = camera.matrix_world.translation
    close(np.hypot(*turned[:2]), np.hypot(*before.translation[:2]), 1e-4)
    assert abs(turned[0]) > 5.9
    # Animate again, from the current position of the camera.
    bpy.context.scene.frame_set(1)
    bpy.ops.leaflight.animate(kind="TURNTABLE", frames=8)
    assert [o.name for o in bpy.data.objects if o.type == "EMPTY"] == ["Turntable"]


def check_a_turntable_keeps_before_a_wall(patient):
    bpy.ops.mesh.primitive_plane_add(size=20, location=(0, 3, 0), rotation=(np.pi / 2, 0, 0))
    bpy.context.view_layer.objects.active = patient
    bpy.ops.leaflight.animate(kind="TURNTABLE", frames=40)
    for frame in range(1, 41):
        bpy.context.scene.frame_set(frame)
        assert bpy.context.scene.camera.matrix_world.translation[1] < 3


def check_a_wipe_goes_from_nothing_to_all(patient):
    bpy.ops.leaflight.animate(kind="WIPE", frames=5)
    box = patient.leaflight_look.box
    x = vertices_of(patient) @ np.array(patient.matrix_world)[:3, :3].T
    x = x[:, 0] + patient.matrix_world.translation[0]
    covered = []
    for frame in range(1, 6):
        bpy.context.scene.frame_set(frame)
        reach = box.empty_display_size * box.matrix_world.to_scale()[0]
        covered.append(np.mean(np.abs(x - box.matrix_world.translation[0]) < reach))
    assert covered[0] == 0 and covered[-1] == 1 and np.all(np.diff(covered) >= 0)


def check_a_scale_bar_is_as_long_as_it_says(patient):
    bpy.ops.leaflight.add_scale_bar()
    bpy.ops.leaflight.add_scale_bar()
    bar, text = sorted((o for o in patient.children), key=lambda o: o.type, reverse=True)
    assert text.data.body == "20 mm" and len(patient.children) == 2
    assert np.ptp(vertices_of(bar)[:, 0]) == pytest.approx(20.0, abs=1e-3)
    assert [labels.round_length(x) for x in (0.31, 45, 60, 1000)] == [0.2, 20, 50, 1000]
    # Bakes must ignore it.
    assert not scene_export.export_scene(bpy.context, patient)[0].meshes


def check_letters_stand_at_the_sides_of_a_patient(patient, bump_file):
    bpy.ops.leaflight.add_letters()
    bpy.context.view_layer.update()
    places = {o.data.body: o.location for o in patient.children}
    assert set(places) == set("RLAPSI")
    assert places["R"][0] > places["L"][0] and places["A"][1] > places["P"][1]
    assert places["S"][2] > places["I"][2]
    bpy.ops.leaflight.import_volume(filepath=str(bump_file), dims=(24,) * 3, value_type="float32")
    assert "no directions of a patient" in error_of(bpy.ops.leaflight.add_letters)
    assert "unit of length" in error_of(bpy.ops.leaflight.add_scale_bar)


def check_a_cube_in_the_picture_turns_as_the_volume_does(patient):
    scene = bpy.context.scene
    bpy.ops.leaflight.add_orientation_cube()
    bpy.ops.leaflight.add_orientation_cube()
    (cube,) = scene.camera.children
    assert {o.data.body for o in cube.children} == set("RLAPSI")
    patient.rotation_euler = (0.3, 0.2, 0.1)
    scene.render.resolution_x, scene.render.resolution_y = 400, 300
    bpy.context.view_layer.update()
    close(cube.matrix_world.to_euler(), patient.rotation_euler, 1e-5)
    # All of it must be in the lower left corner of the frame, with letters on its sides.
    for corner in cube.bound_box:
        x, y, depth = world_to_camera_view(scene, scene.camera, cube.matrix_world @ Vector(corner))
        assert 0 < x < 0.3 and 0 < y < 0.3 and depth > scene.camera.data.clip_start
    for letter in cube.children:
        side = "RLAPSI".index(letter.data.body)
        out = letter.matrix_local.col[2][:3]
        close(out, [(1 - 2 * (side % 2)) * (a == side // 2) for a in range(3)], 1e-6)
        close(letter.matrix_local.translation.normalized(), out, 1e-4)
    assert not scene_export.export_scene(bpy.context, patient)[0].meshes
    bpy.data.objects.remove(scene.camera)
    assert "no camera" in error_of(bpy.ops.leaflight.add_orientation_cube)


def check_the_cube_of_a_baked_patient_has_the_patients_sides(patient, tmp_path):
    blender.stage(patient)
    blender.bake(patient, isovalues=(2.0, 6.0), error=20.0, bake_folder=str(tmp_path))
    bpy.ops.leaflight.add_orientation_cube()
    (cube,) = bpy.context.scene.camera.children
    assert {o.data.body for o in cube.children} == set("RLAPSI")
