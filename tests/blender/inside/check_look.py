# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the appearance of isosurfaces: without dust, glossy, closed at cuts."""

import bpy
import numpy as np
import pytest
from blends import reopened
from leaflight import blender
from leaflight_addon.compare import stills
from leaflight_addon.show import data_faces, surface_material
from leaflight_addon.store import cache
from tools import (
    camera_rays_down,
    close,
    displayed_gray,
    look_down,
    mesh_arrays,
    render_exr,
    vertices_of,
)

SIZE = 48


@pytest.fixture
def dusty(tmp_path):
    """Returns a large ball and a speck of two voxels beside it."""
    z, y, x = np.mgrid[:24, :24, :24].astype(np.float32)
    ball = 9.0 - np.sqrt((x - 11) ** 2 + (y - 11) ** 2 + (z - 11) ** 2)
    speck = 1.5 - np.sqrt((x - 21) ** 2 + (y - 21) ** 2 + (z - 21) ** 2)
    np.save(tmp_path / "dusty.npy", 10.0 + np.maximum(ball, speck))
    bpy.ops.leaflight.import_volume(filepath=str(tmp_path / "dusty.npy"))
    obj = bpy.context.object
    obj.leaflight.isovalue = 10.2
    return obj


def _farthest(obj):
    return (vertices_of(obj) + obj.leaflight.origin).max()


def check_dust_is_hidden_without_a_bake(dusty, tmp_path):
    whole = len(dusty.data.vertices)
    assert _farthest(dusty) > 21
    dusty.leaflight_look.dust = 4.0
    assert _farthest(dusty) < 20.5 and 0 < len(dusty.data.vertices) < whole
    dusty.leaflight.isovalue = 10.4
    assert _farthest(dusty) < 20.5
    # Test undo, which restores mesh and setting, and a saved file.
    dusty = reopened(tmp_path / "scene.blend")
    dusty.leaflight.isovalue = 10.2
    assert _farthest(dusty) < 20.5
    dusty.leaflight_look.dust = 0.0
    assert len(dusty.data.vertices) == whole
    dusty.leaflight_look.dust = 1e3
    assert len(dusty.data.vertices) == 0


def check_of_a_lit_isosurface_what_stays_keeps_its_light(baked):
    before, _, light = mesh_arrays(baked)
    baked.leaflight_look.dust = 0.5
    vertices, _, radiance = mesh_arrays(baked)
    np.testing.assert_array_equal(vertices, before)
    np.testing.assert_array_equal(radiance, light)


def _from_above(obj, path, samples=16):
    for other in bpy.context.scene.objects:
        other.hide_render = other != obj and other.type != "LIGHT"
    return render_exr(path, samples=samples, size=SIZE)[..., :3]


def check_gloss_shines_in_the_lamps_and_not_in_comparisons(baked, tmp_path):
    baked.leaflight.shading = "ATTRIBUTE"
    bpy.context.scene.world = None
    look_down(5.0, 1.6)
    before = _from_above(baked, tmp_path / "before.exr")
    baked.leaflight_look.gloss, baked.leaflight_look.roughness = 1.0, 0.1
    after = _from_above(baked, tmp_path / "after.exr")
    seen = before.max(axis=-1) > 0.05
    # The coat takes 8 % of the light from the surface, and more at grazing angles.
    assert np.median((after / np.maximum(before, 1e-6))[seen]) > 0.9
    assert (after - before).max() > 0.02
    with stills._volumes_alone(bpy.context.scene):
        close(_from_above(baked, tmp_path / "still.exr"), before, 1e-5)
    nodes = [node.as_pointer() for node in baked.data.materials[0].node_tree.nodes]
    baked.leaflight_look.gloss, baked.leaflight_look.roughness = 0.5, 0.2
    assert [node.as_pointer() for node in baked.data.materials[0].node_tree.nodes] == nodes
    coat = baked.data.materials[0].node_tree.nodes["coat"]
    assert coat.inputs["Roughness"].default_value == pytest.approx(0.2)
    # A new color must not change the coat.
    baked.leaflight.isosurface_albedo = (0.5, 0.1, 0.1)
    assert tuple(coat.inputs[0].default_value) == (1.0, 1.0, 1.0, 1.0)


def check_a_look_is_color_and_gloss_and_stays(bumps, tmp_path):
    bpy.ops.leaflight.isosurface_preset(preset="IVORY")
    obj = reopened(tmp_path / "scene.blend")
    assert obj.leaflight_look.gloss == 1.0 and surface_material.shows_its_view(obj)
    bpy.ops.leaflight.isosurface_preset(preset="VIRIDIS")
    assert len(obj.leaflight.isosurface_stops) == 9 and obj.leaflight_look.gloss == 0.0
    close(obj.leaflight.isosurface_stops[8].color, (0.984, 0.799, 0.019), 2e-3)


@pytest.mark.parametrize("kept", ["OUTSIDE", "INSIDE"])
def check_a_cut_is_closed_with_the_slice(baked, tmp_path, kept):
    """Checks a cut seen from above: half of the volume is cut away from above, or from below."""
    baked.leaflight.isovalue = 40.0
    low, high = np.asarray(cache.volume_of(baked).field().bounds)
    middle = np.array(baked.matrix_world) @ [*(0.5 * (low + high)), 1.0]
    box = bpy.data.objects.new("Box", None)
    bpy.context.scene.collection.objects.link(box)
    box.location = middle[:3] + (0.0, 0.0, 5.0 if kept == "OUTSIDE" else -5.0)
    box.scale = (5.0, 5.0, 5.0)
    bpy.context.view_layer.update()
    blender.clip(baked, box, keep=kept)
    faces = data_faces.cut_faces_of(baked)
    look_down(5.0, 1.6)
    bpy.context.scene.world = None
    seen = _from_above(faces, tmp_path / "faces.exr", samples=1)
    x, y = camera_rays_down(1.6, SIZE)
    points = np.stack([x, y, np.full_like(x, middle[2])], axis=-1).reshape(-1, 3)
    to_local = np.linalg.inv(np.array(baked.matrix_world))
    values = cache.volume_of(baked).field().sample(points @ to_local[:3, :3].T + to_local[:3, 3])
    values = values.reshape(SIZE, SIZE)
    isovalue_range = baked.leaflight.low, baked.leaflight.high
    low, high = isovalue_range
    expected = displayed_gray((values - low) / (high - low))
    inside, outside = values > 45.0, values < 35.0
    assert inside.sum() > 50 and outside.sum() > 20
    close(seen[inside], np.repeat(expected[inside][:, None], 3, axis=1), 0.06)
    assert np.all(seen[outside] == 0)
    # The faces must follow the isovalue without a new mesh, and follow the box.
    vertices = vertices_of(faces)
    baked.leaflight.isovalue = 60.0
    bpy.context.view_layer.update()
    np.testing.assert_array_equal(vertices_of(faces), vertices)
    again = _from_above(faces, tmp_path / "again.exr", samples=1)
    assert np.all(again[values < 55.0] == 0) and again[values > 65.0].max() > 0
    box.location.z += 0.1
    bpy.context.view_layer.update()
    assert len(vertices) == 0 or not np.array_equal(vertices_of(faces), vertices)


def check_a_cut_is_open_where_that_is_chosen_and_goes_with_its_volume(baked, tmp_path):
    bpy.ops.leaflight.add_clip_box()
    faces = data_faces.cut_faces_of(baked)
    assert len(faces.data.vertices) > 0
    baked.leaflight_look.cut_colors = "MAGMA"
    assert len(faces.data.materials[0].node_tree.nodes) > 0
    baked = reopened(tmp_path / "scene.blend")
    faces = data_faces.cut_faces_of(baked)
    assert len(faces.data.vertices) > 0
    baked.leaflight_look.cut_colors = "NONE"
    assert len(faces.data.vertices) == 0
    name = faces.name
    bpy.data.objects.remove(baked)
    bpy.context.view_layer.update()
    assert name not in bpy.data.objects


def check_undo_brings_back_what_was_shown(baked):
    baked.leaflight.shading = "ATTRIBUTE"
    bpy.ops.leaflight.add_clip_box()
    name, whole = baked.name, len(baked.data.vertices)
    faces = len(data_faces.cut_faces_of(baked).data.vertices)
    bpy.ops.ed.undo_push(message="before")
    look = baked.leaflight_look
    look.dust, look.gloss, look.roughness, look.cut_colors = 1e3, 0.7, 0.2, "NONE"
    assert len(baked.data.vertices) == 0 == len(data_faces.cut_faces_of(baked).data.vertices)
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    assert (obj.leaflight_look.dust, obj.leaflight_look.gloss) == (0.0, 0.0)
    assert len(obj.data.vertices) == whole
    assert len(data_faces.cut_faces_of(obj).data.vertices) == faces
    assert "coat" not in obj.data.materials[0].node_tree.nodes
    bpy.ops.ed.redo()
    obj = bpy.data.objects[name]
    assert obj.leaflight_look.cut_colors == "NONE" and len(obj.data.vertices) == 0
    assert "coat" in obj.data.materials[0].node_tree.nodes
