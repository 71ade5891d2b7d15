# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the Cornell box made of Blender objects, and the conversion of its walls and lights
back.
"""

import bpy
import leaflight
import numpy as np
import pytest
from leaflight_addon import versions
from leaflight_addon.stage import scene_export, staleness
from leaflight_addon.store import cache
from tools import close, error_of, one_colored_world, plain_material


def _export(isosurface):
    bpy.context.view_layer.update()
    description, _, warnings = scene_export.export_scene(bpy.context, isosurface)
    return description, warnings


def _find(items, name):
    return next(item for item in items if item.name == name)


def check_the_box_comes_back_as_it_was_described(boxed):
    wanted = leaflight.fit_scene(leaflight.cornell_box(), cache.world_volume(boxed))
    found, warnings = _export(boxed)
    assert warnings == []
    assert len(found.meshes) == len(wanted.meshes) and len(found.lights) == len(wanted.lights)
    close(found.isosurfaces[0].albedo, wanted.isosurfaces[0].albedo, 1e-6)
    assert found.exposure == pytest.approx(wanted.exposure)
    for mesh in wanted.meshes:
        same = _find(found.meshes, mesh.name)
        close(same.vertices, mesh.vertices, 1e-5)
        np.testing.assert_array_equal(same.triangles, mesh.triangles)
        close(same.albedo, mesh.albedo, 1e-6)
    for light in wanted.lights:
        same = _find(found.lights, light.name)
        close(same.corner, light.corner, 1e-5)
        close(same.edge_u, light.edge_u, 1e-5)
        close(same.edge_v, light.edge_v, 1e-5)
        close(same.radiance, light.radiance, 1e-5)


def check_moved_recolored_scaled_and_deleted_walls(boxed):
    before, _ = _export(boxed)
    floor, left = bpy.data.objects["floor"], bpy.data.objects["left wall"]
    floor.location.z -= 0.25
    floor.scale.x = 2.0
    bsdf = next(n for n in left.data.materials[0].node_tree.nodes if n.type == "BSDF_DIFFUSE")
    bsdf.inputs[0].default_value = (0.1, 0.2, 0.3, 1.0)
    bpy.data.objects.remove(bpy.data.objects["ceiling"])
    after, _ = _export(boxed)
    old, new = _find(before.meshes, "floor").vertices, _find(after.meshes, "floor").vertices
    middle = old.mean(axis=0)
    close(new, middle + (old - middle) * [2, 1, 1] - [0, 0, 0.25], 1e-5)
    close(_find(after.meshes, "left wall").albedo, (0.1, 0.2, 0.3), 1e-6)
    assert {m.name for m in after.meshes} == {m.name for m in before.meshes} - {"ceiling"}


def check_an_added_mesh_comes_with_its_modifiers_and_its_materials(boxed):
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0.9, 0, 0.3), scale=(1, 2, 1))
    cube = bpy.context.object
    cube.modifiers.new("Array", "ARRAY").count = 3
    principled = bpy.data.materials.new("Glossy")
    bsdf = next(n for n in versions.give_nodes(principled).nodes if n.type == "BSDF_PRINCIPLED")
    bsdf.inputs["Base Color"].default_value = (0.2, 0.4, 0.6, 1.0)
    plain = plain_material("Plain", (0.3, 0.3, 0.1))
    cube.data.materials.append(principled)
    cube.data.materials.append(plain)
    cube.data.polygons[0].material_index = 1
    found, warnings = _export(boxed)
    parts = [mesh for mesh in found.meshes if mesh.name == "Cube"]
    assert sorted(len(part.triangles) for part in parts) == [3 * 2, 3 * 10]
    albedo = {len(part.triangles): part.albedo for part in parts}
    close(albedo[6], (0.3, 0.3, 0.1), 1e-6)
    close(albedo[30], (0.2, 0.4, 0.6), 1e-6)
    points = np.concatenate([part.vertices for part in parts])
    close(points.min(axis=0), [0.65, -0.5, 0.05], 1e-5)
    close(points.max(axis=0), [0.65 + 3 * 0.5, 0.5, 0.55], 1e-5)
    assert len(warnings) == 1 and '"Glossy"' in warnings[0] and "Specular" in warnings[0]


def check_instances_of_a_collection(boxed):
    before, _ = _export(boxed)
    bpy.ops.mesh.primitive_plane_add(size=1.0)
    plane = bpy.context.object
    collection = bpy.data.collections.new("Parts")
    for users in plane.users_collection:
        users.objects.unlink(plane)
    collection.objects.link(plane)
    empty = bpy.data.objects.new("Copies", None)
    empty.instance_type = "COLLECTION"
    empty.instance_collection = collection
    empty.location = (0, 0, 0.5)
    bpy.context.scene.collection.objects.link(empty)
    after, _ = _export(boxed)
    assert len(after.meshes) == len(before.meshes) + 1
    close(_find(after.meshes, plane.name).vertices[:, 2], 0.5, 1e-6)


def check_what_does_not_render_is_left_out_and_what_only_the_eye_hides_is_not(boxed):
    bpy.data.objects["ceiling"].hide_render = True
    bpy.data.objects["floor"].hide_set(True)
    found, _ = _export(boxed)
    names = {mesh.name for mesh in found.meshes}
    assert "ceiling" not in names and "floor" in names


def check_a_scaled_and_turned_light_has_the_radiance_of_its_true_area(boxed):
    lamp = bpy.data.objects["lamp"]
    lamp.rotation_euler = (0.3, 0.2, 0.1)
    lamp.scale = (2.0, 0.5, -3.0)
    lamp.data.shape = "SQUARE"
    lamp.data.size = 0.4
    lamp.data.energy = 10.0
    lamp.data.color = (1.0, 0.5, 0.25)
    found, _ = _export(boxed)
    (light,) = found.lights
    width, height = np.linalg.norm(light.edge_u), np.linalg.norm(light.edge_v)
    close(sorted([width, height]), [0.2, 0.8], 1e-6)
    factor = versions.light_units().area
    close(light.radiance, np.array([1, 0.5, 0.25]) * 10.0 * factor / 0.16, 1e-4)
    middle = np.array(light.corner) + 0.5 * (np.array(light.edge_u) + np.array(light.edge_v))
    close(middle, lamp.matrix_world.translation, 1e-5)
    direction = np.cross(light.edge_u, light.edge_v)
    assert direction @ np.array(lamp.matrix_world.col[2][:3]) < 0


def check_the_fingerprint_follows_what_lights_the_volume(boxed):
    def fingerprint():
        bpy.context.view_layer.update()
        description, volumes, _ = scene_export.export_scene(bpy.context, boxed)
        return scene_export.fingerprint(volumes, description)

    seen = {fingerprint()}
    assert fingerprint() in seen
    bpy.data.objects["floor"].location.z -= 0.1
    seen.add(fingerprint())
    bpy.data.objects["lamp"].data.energy *= 1.1
    seen.add(fingerprint())
    boxed.rotation_euler.z = 0.2
    seen.add(fingerprint())
    boxed.leaflight.high -= 1.0
    seen.add(fingerprint())
    boxed.leaflight.isosurface_emission_strength = 0.5
    seen.add(fingerprint())
    boxed.leaflight.capped = True
    seen.add(fingerprint())
    bpy.context.scene.world = one_colored_world((0.1, 0.1, 0.1))
    seen.add(fingerprint())
    bpy.data.objects["floor"].data.materials[0] = None
    seen.add(fingerprint())
    assert len(seen) == 9


def check_the_panel_says_when_the_bake_is_stale(baked):
    assert staleness.change_since_bake(bpy.context, baked) == ""
    baked.leaflight.isovalue = 60.0
    bpy.context.view_layer.update()
    assert staleness.change_since_bake(bpy.context, baked) == ""
    bpy.data.objects["floor"].location.z -= 0.1
    bpy.context.view_layer.update()
    assert "bake again" in staleness.change_since_bake(bpy.context, baked)
    bpy.data.objects["floor"].location.z += 0.1
    bpy.context.view_layer.update()
    assert staleness.change_since_bake(bpy.context, baked) == ""


def check_an_instanced_volume_is_refused(boxed):
    collection = bpy.data.collections.new("Parts")
    copy = boxed.copy()
    copy.data = boxed.data.copy()
    collection.objects.link(copy)
    empty = bpy.data.objects.new("Copies", None)
    empty.instance_type = "COLLECTION"
    empty.instance_collection = collection
    bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    assert f'"{copy.name}"' in error_of(bpy.ops.leaflight.bake)
