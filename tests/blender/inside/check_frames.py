# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks volumes that change over time: playback, and one bake for each frame."""

import bpy
import leaflight
import nibabel
import numpy as np
import pytest
from blends import open_blend, open_saved
from leaflight import blender
from leaflight.scene.volume_texture import color_map
from leaflight_addon.bake import load_bake
from leaflight_addon.importing import read_again
from leaflight_addon.show import data_faces, look, surface_material, surface_object
from leaflight_addon.store import bake_files, cache, frame_bakes, source_files
from mathutils import Matrix
from tools import (
    add_camera,
    assert_shows,
    change,
    close,
    colors_of,
    mesh_arrays,
    to_world,
    vertices_of,
)

FRAMES = 3


@pytest.fixture
def values(tmp_path):
    """Writes a shrinking ball, [frame, x, y, z], to series.nii."""
    x, y, z = np.mgrid[-1:1:12j, -1:1:12j, -1:1:12j]
    ball = 100 - 80 * np.sqrt(x**2 + y**2 + z**2)
    values = np.stack([ball - 12 * frame for frame in range(FRAMES)]).astype(np.float32)
    affine = np.diag([1.0, 1.0, 1.0, 1.0])
    nibabel.save(nibabel.Nifti1Image(np.moveaxis(values, 0, -1), affine), tmp_path / "series.nii")
    return values


@pytest.fixture
def played(values, tmp_path):
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "series.nii"), animate=True)
    obj = bpy.context.object
    settings = obj.leaflight
    settings.bake_folder = str(tmp_path / "bakes")
    settings.error, settings.resolution = 50.0, 8
    bpy.ops.leaflight.stage(preset="LIGHT_TENT")
    bpy.context.view_layer.objects.active = obj
    return obj


@pytest.fixture
def colored(played, tmp_path):
    """Returns a series whose isosurfaces another series colors: frame number + x along x."""
    return color(played, tmp_path, FRAMES)


def color(played, tmp_path, frames):
    x = np.broadcast_to(np.linspace(0.0, 1.0, 12, dtype=np.float32)[:, None, None], (12, 12, 12))
    values = np.stack([x + frame for frame in range(frames)], axis=-1)
    path = tmp_path / "colors.nii"
    nibabel.save(nibabel.Nifti1Image(values, np.eye(4)), path)
    other = blender.import_volume(path, partner=played.name, size_from="SAME", animate=True)
    bpy.context.view_layer.objects.active = played
    played.leaflight.texture_volume = other
    played.leaflight.texture_low, played.leaflight.texture_high = 0.0, float(FRAMES)
    return played


def assert_colors(obj, number):
    """Checks the colors of an isosurface: those of the series of colors at a frame."""
    low, high = np.asarray(cache.volume_of(obj).field().bounds)[:, 0]
    shares = (vertices_of(obj)[:, 0] - low) / (high - low)
    stops = color_map("VIRIDIS")
    positions = [FRAMES * share for share, _ in stops]
    channels = np.array([color for _, color in stops]).T
    expected = np.array([np.interp(number + shares, positions, c) for c in channels]).T
    close(colors_of(obj, "texture"), expected, 2e-3)


def check_a_series_of_colors_follows_the_frame(colored):
    for number in (0, 2, 1):
        show_frame(number)
        assert colored.leaflight.frame == number
        assert_colors(colored, number)


def check_a_series_of_colors_follows_in_renders(colored, tmp_path):
    found = []

    def note(scene, *_):
        found.append(colors_of(colored, "texture").mean(axis=0))
        assert_colors(colored, scene.frame_current - scene.frame_start)

    add_camera((0, -5, 0), (1.57, 0, 0))
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.frame_end = scene.frame_start + FRAMES - 1
    scene.render.filepath = str(tmp_path / "frame")
    bpy.app.handlers.render_post.append(note)
    try:
        bpy.ops.render.render(animation=True)
    finally:
        bpy.app.handlers.render_post.remove(note)
    assert len(found) == FRAMES and np.ptp(found, axis=0).max() > 0.1


def check_series_of_other_lengths_are_refused(played, tmp_path):
    color(played, tmp_path, FRAMES + 2)
    sentence = surface_object.problems[played.name_full]
    assert "the series has 5 frames, but this volume has 3" in sentence
    assert "texture" not in played.data.attributes
    other = played.leaflight.texture_volume
    other.animation_data_clear()
    other.leaflight.shown_frame = 1
    bpy.context.view_layer.update()
    assert_colors(played, 1)
    assert played.name_full not in surface_object.problems


def check_a_frame_is_baked_with_its_colors(colored):
    show_frame(1)
    bpy.ops.leaflight.bake()
    bake = cache.bake_of(colored)
    (channel,) = bake.scene.isosurfaces[0].texture.channels
    assert channel.values.min() == 1.0 and change(colored) == ""
    show_frame(2)
    assert not colored.leaflight.bake_id
    show_frame(1)
    assert_colors(colored, 1)
    assert colored.leaflight.bake_id == bake.id and change(colored) == ""


def show_frame(number):
    bpy.context.scene.frame_set(bpy.context.scene.frame_start + number)


def check_frames_play_from_the_scenes_first_on(played, values):
    for number in (0, 2, 1, 7):
        show_frame(number)
        number = min(number, FRAMES - 1)
        assert played.leaflight.frame == number
        close(cache.volume_of(played).values, values[number].T, 0)
        assert_shows(played, played.leaflight.isovalue)


def check_a_script_plays_them_from_a_frame_of_its_choice(values, tmp_path):
    obj = blender.import_volume(tmp_path / "series.nii", frame=0)
    scene = bpy.context.scene
    before = scene.frame_start, scene.frame_end, scene.frame_current
    blender.animate_frames(obj, first_frame=7)
    assert before == (scene.frame_start, scene.frame_end, scene.frame_current)
    for scene_frame, number in ((1, 0), (7, 0), (8, 1), (9, 2), (20, 2)):
        scene.frame_set(scene_frame)
        assert obj.leaflight.frame == number
        close(cache.volume_of(obj).values, values[number].T, 0)


def check_a_frame_is_lit_by_its_own_bake_and_by_no_other(played):
    show_frame(1)
    bpy.ops.leaflight.bake()
    first = played.leaflight.bake_id
    assert first and mesh_arrays(played)[2] is not None
    show_frame(0)
    assert not played.leaflight.bake_id and mesh_arrays(played)[2] is None
    assert frame_bakes.count_baked(played.leaflight) == 1
    # Without keyframes, the slider of the panel works.
    played.animation_data_clear()
    played.leaflight.shown_frame = 1
    assert played.leaflight.bake_id == first
    assert_shows(played, played.leaflight.isovalue)
    assert surface_material.shading_in_use(played.leaflight)[0] == "ATTRIBUTE"


def check_a_cut_applies_to_every_frame(played):
    clip = _box_over_half(played)
    bpy.ops.leaflight.cut_data(cut="capped")
    assert clip.name in played.leaflight.regions
    for number in range(FRAMES):
        show_frame(number)
        volume = cache.volume_of(played)
        assert volume.cuts is not None and volume.values.shape[2] < 12
        assert vertices_of(played)[:, 0].max() < 0.6
    blender.bake_frames(played, error=40.0)
    assert len(frame_bakes.bakes_of(played.leaflight)) == FRAMES
    show_frame(1)
    vertices, _, radiance = mesh_arrays(played)
    expected = cache.bake_of(played).radiance(to_world(played, vertices))
    # At an edge of the cut, rounding decides between the normals of both faces.
    assert np.quantile(abs(radiance - expected), 0.97) < 1e-4 * expected.max()


def _box_over_half(obj):
    """Adds a clip box over the half of a volume towards +x."""
    bpy.ops.leaflight.add_clip_box()
    box = obj.leaflight_look.box
    box.matrix_world = obj.matrix_world @ Matrix.Diagonal((20.0, 20.0, 20.0, 1.0))
    low, high = np.array(look.bounds_of(box))
    box.matrix_world.translation.x -= low[0] * box.matrix_world.to_scale().x
    bpy.context.view_layer.update()
    return box


def check_all_frames_are_baked_kept_and_found_again(played, tmp_path):
    played.leaflight.bake_folder = ""
    blender.bake_frames(played, error=40.0)
    assert played.leaflight.error == 40.0 and bpy.context.scene.frame_current == 1
    assert len(frame_bakes.bakes_of(played.leaflight)) == FRAMES
    # The files move from the session's folder beside the .blend.
    open_saved(tmp_path / "here" / "scene.blend")
    played = open_blend(tmp_path / "here" / "scene.blend")
    found = set()
    for number in range(FRAMES):
        show_frame(number)
        found.add(played.leaflight.bake_id)
        assert bake_files.locate(played).parent == tmp_path / "here" / "leaflight"
        assert_shows(played, played.leaflight.isovalue)
        assert mesh_arrays(played)[2] is not None
    assert found == frame_bakes.bakes_of(played.leaflight) and len(found) == FRAMES
    assert not load_bake.unused()


def check_a_frame_that_was_read_is_not_taken_for_another(played):
    """Checks Smooth while the frame changes."""
    job = read_again.ReadAgainJob(played, "Smooth", "smooth", 1.0, lambda obj: obj.name)
    job.run(leaflight.Progress())
    show_frame(2)
    job.apply()
    expected = source_files.read(played.leaflight).values
    np.testing.assert_array_equal(cache.volume_of(played).values, expected)


def check_a_slice_follows_the_frame(played):
    played.leaflight_look.slice_axes = (True, False, False)
    highest = []
    for number in range(FRAMES):
        show_frame(number)
        faces = data_faces.slices_of(played).data
        values = np.empty(len(faces.vertices), np.float32)
        faces.attributes[data_faces.VALUE].data.foreach_get("value", values)
        highest.append(values.max())
    close(np.diff(highest), -12.0, 1e-3)
