# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks slices of a volume's data: colors, positions and visibility."""

import bpy
import numpy as np
import pytest
from blends import reopened
from leaflight_addon import versions
from leaflight_addon.show import data_faces, surface_object
from leaflight_addon.stage import scene_export, staleness
from leaflight_addon.store import cache, source_files
from tools import camera_rays_down, close, displayed_gray, look_down, render_exr, vertices_of

SIZE = 48


def _seen_alone(obj, path):
    for other in bpy.context.scene.objects:
        other.hide_render = other != obj and other.type != "LIGHT"
    return render_exr(path, samples=1, size=SIZE)[..., :3]


def _values_from_above(volume, height):
    """Returns the data at a height in file coordinates, for each pixel of the camera."""
    x, y = camera_rays_down(1.6, SIZE)
    matrix = np.array(volume.matrix_world)
    z = (source_files.place_of_file(volume) @ [0.0, 0.0, height, 1.0])[2]
    points = np.stack([x, y, np.full_like(x, z)], axis=-1).reshape(-1, 3)
    to_local = np.linalg.inv(matrix)
    values = cache.volume_of(volume).field().sample(points @ to_local[:3, :3].T + to_local[:3, 3])
    return values.reshape(SIZE, SIZE)


@pytest.mark.parametrize("place", [0.25, 0.5])
def check_a_slice_has_the_colors_of_the_data(baked, tmp_path, place):
    look = baked.leaflight_look
    look.slice_axes, look.slice_places[2] = (False, False, True), place
    look_down(5.0, 1.6)
    bpy.context.scene.world = None
    faces = data_faces.slices_of(baked)
    seen = _seen_alone(faces, tmp_path / "all.exr")
    values = _values_from_above(baked, data_faces.slice_position(baked, 2))
    low, high = baked.leaflight.low, baked.leaflight.high
    expected = displayed_gray((values - low) / (high - low))
    known = values > low + 2.0
    assert known.sum() > 400
    close(seen[known], np.repeat(expected[known][:, None], 3, axis=1), 0.06)
    assert np.all(seen[values < low - 2.0] == 0)
    # Show data only within the isosurface, which then changes.
    look.slices_inside = True
    for isovalue in (40.0, 60.0):
        baked.leaflight.isovalue = isovalue
        bpy.context.view_layer.update()
        seen = _seen_alone(faces, tmp_path / f"{isovalue}.exr")
        assert np.all(seen[values < isovalue - 5.0] == 0)
        inside = values > isovalue + 5.0
        close(seen[inside], np.repeat(expected[inside][:, None], 3, axis=1), 0.06)


def check_slices_move_with_their_places_and_their_animation(baked, tmp_path):
    look = baked.leaflight_look
    look.slice_axes = (True, True, True)
    faces = data_faces.slices_of(baked)
    low, high = np.asarray(cache.volume_of(baked).field().bounds)
    for axis in range(3):
        look.slice_axes = [other == axis for other in range(3)]
        look.slice_places[axis] = 0.75
        close(vertices_of(faces)[:, axis], low[axis] + 0.75 * (high - low)[axis], 1e-5)
    for frame, place in ((1, 0.0), (11, 1.0)):
        look.slice_places[2] = place
        baked.keyframe_insert("leaflight_look.slice_places", index=2, frame=frame)
    for curve in versions.fcurves(baked):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    bpy.context.scene.frame_set(4)
    close(vertices_of(faces)[:, 2], low[2] + 0.3 * (high - low)[2], 1e-5)
    baked = reopened(tmp_path / "scene.blend")
    assert len(data_faces.slices_of(baked).data.vertices) > 0
    baked.leaflight_look.slice_axes = (False, False, False)
    assert len(data_faces.slices_of(baked).data.vertices) == 0


def check_no_bake_sees_slices_and_they_go_with_their_volume(baked):
    before = staleness.change_since_bake(bpy.context, baked)
    baked.leaflight_look.slice_axes = (True, False, False)
    name = data_faces.slices_of(baked).name
    bpy.context.view_layer.update()
    assert staleness.change_since_bake(bpy.context, baked) == before
    scene = scene_export.export_scene(bpy.context, baked)
    assert name not in str(scene)
    bpy.ops.ed.undo_push(message="with a slice")
    bpy.data.objects.remove(baked)
    bpy.context.view_layer.update()
    assert name not in bpy.data.objects


def _values_of(faces):
    values = np.empty(len(faces.data.vertices), np.float32)
    faces.data.attributes[data_faces.VALUE].data.foreach_get("value", values)
    return values


def check_slices_and_cut_faces_follow_the_data(baked):
    baked.leaflight_look.slice_axes = (True, False, False)
    bpy.ops.leaflight.add_clip_box()
    bpy.context.view_layer.update()
    faces = data_faces.slices_of(baked), data_faces.cut_faces_of(baked)
    before = [_values_of(each) for each in faces]
    bpy.ops.leaflight.smooth(amount="2")
    bpy.context.view_layer.update()
    for each, values in zip(faces, before):
        assert len(values) and np.abs(_values_of(each) - values).max() > 1.0


def check_faces_have_the_isovalue_of_the_surface(baked, monkeypatch):
    """Checks an isovalue that the original object does not have, as in a render."""
    baked.leaflight_look.slice_axes, baked.leaflight_look.slices_inside = (True, False, False), True
    bpy.ops.leaflight.add_clip_box()
    shaded = []
    monkeypatch.setattr(data_faces, "shade", lambda *of_face: shaded.append(of_face[-1]))
    surface_object.update(baked, baked.leaflight.isovalue + 5.0)
    data_faces.update_slices(baked)
    data_faces.update_cut(baked)
    assert shaded == [baked.leaflight.isovalue + 5.0] * 2
