# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks several isosurfaces of a volume at once: isovalue, light and opacity of each."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from blends import reopened, save
from leaflight import blender
from leaflight_addon.show import display, look, surface_material, surface_object
from leaflight_addon.store import cache
from leaflight_addon.show import distribution
from leaflight_addon.edit import add_isosurface
from tools import (
    camera_rays_down,
    close,
    duplicate,
    edit_as_the_slider_does,
    error_of,
    lit_mesh,
    look_down,
    mesh_arrays,
    render_exr,
    vertices_of,
)

SIZE = 32


def assert_lit_by_the_bake(obj, isovalue):
    """Checks that an added isosurface has the mesh and light of the bake at its isovalue."""
    volume = obj.parent
    field, grid = cache.volume_of(volume).field(), cache.grid_of(volume)
    vertices, triangles, radiance = mesh_arrays(obj)
    expected, faces = lit_mesh(volume, isovalue)
    np.testing.assert_array_equal(triangles, faces)
    close(vertices, expected, 1e-6)
    light = grid.lookup(field, vertices)
    close(radiance, light, 1e-4 * light.max())
    assert obj.name_full not in surface_object.problems


def check_each_has_its_isovalue_and_light(baked):
    own = baked.leaflight.isovalue
    obj = blender.add_isosurface(baked, 40.0)
    assert_lit_by_the_bake(obj, 40.0)
    for isovalue in (50.0, 60.0):
        edit_as_the_slider_does(obj, isovalue)
        assert_lit_by_the_bake(obj, isovalue)
    assert baked.leaflight.isovalue == own == surface_object.shown_isovalue(baked)
    baked.leaflight.isovalue = 70.0
    assert_lit_by_the_bake(obj, 60.0)
    blender.show(obj, 45.0)
    assert_lit_by_the_bake(obj, 45.0)
    blender.animate(obj, [41.0, 43.0])
    bpy.context.scene.frame_set(2)
    assert_lit_by_the_bake(obj, 43.0)
    assert baked.leaflight.isovalue == 70.0


def check_they_follow_their_volume(boxed, tmp_path):
    """Checks added isosurfaces after a new bake, in files and copies, and after deletion."""
    obj = blender.add_isosurface(boxed, 40.0)
    assert mesh_arrays(obj)[2] is None
    boxed.leaflight.bake_folder = ""
    save(tmp_path / "scene.blend")
    bpy.ops.leaflight.bake()
    assert_lit_by_the_bake(obj, 40.0)
    boxed.location.x += 0.5
    bpy.context.view_layer.update()
    assert obj.matrix_world == boxed.matrix_world
    boxed = reopened(tmp_path / "scene.blend")
    (obj,) = display.added_to(boxed)
    obj.leaflight.isovalue = 44.0
    assert_lit_by_the_bake(obj, 44.0)
    bpy.ops.scene.new(type="FULL_COPY")
    copy = next(o for o in bpy.context.scene.objects if o.leaflight.is_volume)
    (other,) = display.added_to(copy)
    assert other != obj
    other.leaflight.isovalue = 48.0
    assert_lit_by_the_bake(other, 48.0)
    assert_lit_by_the_bake(obj, 44.0)
    name = other.name
    bpy.data.objects.remove(copy)
    bpy.context.view_layer.update()
    assert name not in bpy.data.objects and obj.name in bpy.data.objects


def check_a_duplicate_has_isosurfaces_of_its_own(baked):
    obj = blender.add_isosurface(baked, 40.0, opacity=0.5, color=(0.2, 0.4, 0.6))
    blender.animate(obj, [40.0, 42.0])
    blender.add_isosurface(baked, 50.0)
    copy = duplicate(baked)
    copy.location.x += 0.5
    bpy.context.view_layer.update()
    own, other = display.added_to(copy)
    assert {own, other}.isdisjoint(display.added_to(baked)) and len(display.added_to(baked)) == 2
    assert own.matrix_world == copy.matrix_world and own.users_scene == copy.users_scene
    assert own.leaflight_look.opacity == 0.5 and tuple(own.leaflight_look.color) == tuple(
        obj.leaflight_look.color
    )
    assert_lit_by_the_bake(own, 40.0)
    assert_lit_by_the_bake(other, 50.0)
    # Each continues independently.
    other.leaflight.isovalue = 55.0
    own.leaflight_look.opacity = 0.9
    own.animation_data_clear()
    own.leaflight.isovalue = 61.0
    bpy.context.scene.frame_set(2)
    assert_lit_by_the_bake(own, 61.0)
    assert_lit_by_the_bake(obj, 42.0)
    assert_lit_by_the_bake(display.added_to(baked)[1], 50.0)
    opacities = [o.data.materials[0].node_tree.nodes["opacity"] for o in (obj, own)]
    assert [round(node.outputs[0].default_value, 4) for node in opacities] == [0.5, 0.9]
    # Removed isosurfaces must not come back. Deleting a volume removes only its own.
    for isosurface in (own, other):
        bpy.ops.leaflight.remove_isosurface(name=isosurface.name)
    bpy.context.view_layer.update()
    copy.leaflight.isovalue = 58.0
    bpy.context.view_layer.update()
    assert not display.added_to(copy) and len(display.added_to(baked)) == 2
    again = duplicate(baked)
    bpy.data.objects.remove(baked)
    bpy.context.view_layer.update()
    assert len(display.added_to(again)) == 2 == sum(map(display.is_added, bpy.data.objects))


def check_a_duplicate_of_a_duplicate_and_of_a_scene(baked):
    blender.add_isosurface(baked, 40.0)
    second = duplicate(baked)
    (own,) = display.added_to(second)
    own.leaflight.isovalue = 45.0
    (shown,) = display.added_to(duplicate(second))
    assert_lit_by_the_bake(shown, 45.0)
    bpy.ops.scene.new(type="FULL_COPY")
    first = next(o for o in bpy.context.scene.objects if o.leaflight.is_volume)
    display.added_to(first)[0].leaflight.isovalue = 48.0
    (shown,) = display.added_to(duplicate(first))
    assert_lit_by_the_bake(shown, 48.0)
    volumes = [o for o in bpy.data.objects if o.leaflight.is_volume]
    assert [len(display.added_to(volume)) for volume in volumes] == [1] * 7
    assert len({display.mark_of(volume) for volume in volumes}) == 7


def check_there_are_three_at_most(baked):
    isovalue = baked.leaflight.isovalue = 60.0
    bpy.ops.leaflight.add_isosurface()
    bpy.ops.leaflight.add_isosurface()
    surfaces = (baked, *display.added_to(baked))
    assert "remove one first" in error_of(bpy.ops.leaflight.add_isosurface)
    shown = [obj.leaflight.isovalue for obj in surfaces]
    assert isovalue == shown[0] < shown[1] < shown[2] < baked.leaflight.bake_high
    # Inner isosurfaces are opaque, outer ones translucent.
    opacities = [obj.leaflight_look.opacity for obj in surfaces]
    close(opacities, [0.3, 0.3, 1.0], 1e-6)
    bpy.ops.leaflight.remove_isosurface(name=display.added_to(baked)[0].name)
    assert len(display.added_to(baked)) == 1
    assert "choose one" in error_of(bpy.ops.leaflight.remove_isosurface, name=baked.name)


def check_where_nothing_is_inside_one_around_it_is_proposed(baked):
    own = baked.leaflight.isovalue = baked.leaflight.bake_high
    bpy.ops.leaflight.add_isosurface()
    (obj,) = display.added_to(baked)
    assert baked.leaflight.bake_low < obj.leaflight.isovalue < own
    close([obj.leaflight_look.opacity, baked.leaflight_look.opacity], [0.3, 1.0], 1e-6)


def check_tissues_have_names(bumps):
    assert not add_isosurface.is_hounsfield(bumps)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(distribution, "of", lambda _: SimpleNamespace(low=-1024.5, high=3071.5))
        assert add_isosurface.is_hounsfield(bumps)
    bpy.ops.leaflight.add_isosurface(tissue="MUSCLE")
    (obj,) = display.added_to(bumps)
    assert obj.leaflight.isovalue == 50.0


def _seen_from_above(obj, path, engine):
    """Returns pixels of some objects alone, from above in a black world."""
    bpy.context.scene.world = None
    for other in bpy.context.scene.objects:
        other.hide_render = other not in obj and other.type != "LIGHT"
    return render_exr(path, engine, size=SIZE)[..., :3]


@pytest.mark.parametrize(
    "engine, shading", [("CYCLES", "ATLAS"), ("CYCLES", "ATTRIBUTE"), ("EEVEE", "ATTRIBUTE")]
)
def check_the_outer_one_is_seen_through(baked, tmp_path, engine, shading):
    baked.leaflight.shading = shading
    baked.leaflight.isovalue = 60.0
    obj = blender.add_isosurface(baked, 40.0, opacity=0.25)
    look_down(5.0, 1.0)
    inner = _seen_from_above([baked], tmp_path / "inner.exr", engine)
    obj.leaflight_look.opacity = 1.0
    outer = _seen_from_above([obj], tmp_path / "outer.exr", engine)
    obj.leaflight_look.opacity = 0.25
    both = _seen_from_above([baked, obj], tmp_path / "both.exr", engine)
    assert np.abs(inner - outer).mean() > 0.01
    off = np.abs(both - (0.25 * outer + 0.75 * inner)).max(axis=-1)
    # Pixels may differ where an isosurface hides itself, or a part of another one.
    assert np.median(off) < 1e-3 and (off < 2e-3).mean() > 0.9, off


def check_opacity_is_animated(baked):
    obj = blender.add_isosurface(baked, 40.0)
    for frame, opacity in ((1, 1.0), (11, 0.2)):
        obj.leaflight_look.opacity = opacity
        obj.keyframe_insert("leaflight_look.opacity", frame=frame)
    for frame, opacity in ((1, 1.0), (6, 0.6), (11, 0.2)):
        bpy.context.scene.frame_set(frame)
        node = obj.data.materials[0].node_tree.nodes["opacity"]
        assert node.outputs[0].default_value == pytest.approx(opacity, abs=1e-4)


def check_nothing_is_compiled_anew_while_values_move(baked):
    obj = blender.add_isosurface(baked, 40.0)
    nodes = [node.as_pointer() for node in obj.data.materials[0].node_tree.nodes]
    obj.leaflight_look.opacity = 0.6
    obj.leaflight_look.color = (0.2, 0.3, 0.4)
    obj.leaflight.isovalue = 45.0
    bpy.context.view_layer.update()
    assert [node.as_pointer() for node in obj.data.materials[0].node_tree.nodes] == nodes


def check_a_new_color_changes_what_the_surface_reflects(boxed, tmp_path):
    """Checks that a new color changes reflected light, but not emitted light."""
    boxed.leaflight.isosurface_emission_strength = 0.1
    bpy.ops.leaflight.bake()
    assert not surface_material.is_recolored(boxed)
    albedo = np.array(boxed.leaflight.isosurface_albedo)
    look_down(5.0, 1.0)
    before = _seen_from_above([boxed], tmp_path / "before.exr", "CYCLES")
    boxed.leaflight.isosurface_albedo = new = (0.6, 0.3, 0.15)
    assert surface_material.is_recolored(boxed)
    after = _seen_from_above([boxed], tmp_path / "after.exr", "CYCLES")
    lit = before.min(axis=-1) > 0.11
    assert lit.sum() > 100
    expected = 0.1 + (before - 0.1) * new / albedo
    close(after[lit], expected[lit], 1e-3)
    boxed.leaflight.isosurface_albedo = albedo
    assert not surface_material.is_recolored(boxed)


@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def check_a_box_cuts_what_lies_in_it(baked, tmp_path, engine):
    baked.leaflight.shading = "ATTRIBUTE"
    box = bpy.data.objects.new("Box", None)
    bpy.context.scene.collection.objects.link(box)
    box.empty_display_type = "CUBE"
    baked.leaflight.isovalue = 40.0
    look_down(5.0, 2.0)
    whole = _seen_from_above([baked], tmp_path / "whole.exr", engine)
    x, _ = camera_rays_down(2.0, SIZE)
    seen = whole.max(axis=-1) > 0.0
    assert 200 < seen.sum() and 100 < seen[:, SIZE // 2 :].sum()
    blender.clip(baked, box)
    # Rotate by 90 degrees and scale the box, so that its x axis points along y.
    box.rotation_euler.z, box.scale = 0.5 * np.pi, (2.0, 0.5, 4.0)
    for middle in (0.5, 0.6):
        # Move it without any of our Python, like the mouse does.
        box.location.x = middle + 0.001
        bpy.context.view_layer.update()
        cut = _seen_from_above([baked], tmp_path / "cut.exr", engine)
        inside = x > middle - 0.5 + 0.02
        outside = x < middle - 0.5 - 0.02
        close(cut[outside], whole[outside], 1e-3)
        assert np.all(cut[inside & seen] == 0)
    blender.clip(baked, box, keep="INSIDE")
    kept = _seen_from_above([baked], tmp_path / "kept.exr", engine)
    close(kept[inside], whole[inside], 1e-3)
    assert np.all(kept[outside] == 0)
    baked.leaflight_look.is_cut = False
    again = _seen_from_above([baked], tmp_path / "again.exr", engine)
    close(again, whole, 1e-3)


def check_the_box_of_a_mesh_follows_its_shape_and_ends_with_it(baked):
    bpy.ops.mesh.primitive_cube_add(size=0.5)
    cube = bpy.context.object
    baked.leaflight_look.box = cube
    assert look.view_of(baked).cut.high == (0.25,) * 3
    assert surface_material.shows_its_view(baked)
    for vertex in cube.data.vertices:
        vertex.co.x *= 2.0
    cube.data.update()
    bpy.context.view_layer.update()
    bpy.context.view_layer.update()
    assert look.view_of(baked).cut.high == (0.5, 0.25, 0.25)
    assert surface_material.shows_its_view(baked)
    assert "BSDF_TRANSPARENT" in {n.type for n in baked.data.materials[0].node_tree.nodes}
    bpy.ops.object.delete()
    bpy.context.view_layer.update()
    assert look.view_of(baked).cut is None
    assert surface_material.shows_its_view(baked)


def check_a_clip_box_is_added_where_the_camera_looks(baked):
    bpy.context.view_layer.objects.active = baked
    bpy.ops.leaflight.add_clip_box()
    box = baked.leaflight_look.box
    camera = np.array(bpy.context.scene.camera.matrix_world.translation)
    middle = vertices_of(baked).mean(axis=0) @ np.array(baked.matrix_world)[:3, :3].T
    middle += np.array(baked.matrix_world.translation)
    assert (np.array(box.location) - middle) @ (camera - middle) > 0
