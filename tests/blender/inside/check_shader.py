# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the volume texture renders the texels of the bake, in both engines."""

import bpy
import numpy as np
import pytest
from leaflight_addon.store import cache
from tools import camera_rays_down, close, look_down, render_exr, texels_at

SIZE, WIDTH = 96, 2.4
SLOPE_X, SLOPE_Y, HEIGHT = 0.3, 0.2, 0.8


def _tilted_plane(isosurface):
    """Adds a plane through the volume, with the transform of the isosurface."""
    corners = [(-1.2, -1.2), (1.2, -1.2), (1.2, 1.2), (-1.2, 1.2)]
    world = np.array([(x, y, HEIGHT + SLOPE_X * x + SLOPE_Y * y) for x, y in corners])
    inverse = np.linalg.inv(np.array(isosurface.matrix_world, np.float64))
    local = world @ inverse[:3, :3].T + inverse[:3, 3]
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata(local.tolist(), [], [(0, 1, 2, 3)])
    mesh.materials.append(isosurface.data.materials[0])
    plane = bpy.data.objects.new("Plane", mesh)
    plane.matrix_world = isosurface.matrix_world
    bpy.context.scene.collection.objects.link(plane)


@pytest.mark.parametrize("resolution", [0, 37])
@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def check_rendered_emission_is_that_of_the_texels(boxed, tmp_path, engine, resolution):
    boxed.rotation_euler.z = 0.4
    if resolution:
        boxed.leaflight.resolution = resolution
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    bake = cache.bake_of(boxed)
    _tilted_plane(boxed)
    for obj in bpy.context.scene.objects:
        # Hide everything except the lamps, without which the baked light is dark.
        obj.hide_render = obj.name != "Plane" and obj.type != "LIGHT"
    look_down(5.0, WIDTH)
    pixels = render_exr(tmp_path / "plane.exr", engine, size=SIZE)[..., :3].reshape(-1, 3)

    x, y = camera_rays_down(WIDTH, SIZE)
    points = np.stack([x, y, HEIGHT + SLOPE_X * x + SLOPE_Y * y], axis=-1).reshape(-1, 3)
    compared, radiance = texels_at(bake, points)
    assert compared.sum() > 500
    expected = radiance[compared]
    assert expected.std() > 0.01
    close(pixels[compared], expected, 2e-3)


def check_the_atlas_keeps_its_digits(baked):
    (image,) = {
        node.image
        for node in baked.leaflight.baked_material.node_tree.nodes
        if node.type == "TEX_IMAGE"
    }
    assert image.is_float and not image.use_half_precision
    assert image.colorspace_settings.name == "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    atlas, columns, _ = cache.bake_of(baked).grid.atlas()
    np.testing.assert_array_equal(pixels.reshape(height, width, 4)[..., :3], atlas[..., :3])
    assert columns == baked.leaflight.atlas_columns


def check_a_second_bake_is_shown(baked):
    for obj in bpy.context.scene.objects:
        obj.hide_render = obj.type != "LIGHT"
    baked.hide_render = False
    bpy.data.objects["lamp"].data.energy *= 2.0
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    check_the_atlas_keeps_its_digits(baked)


def check_the_users_own_material_stays(baked):
    own = bpy.data.materials.new("Own")
    baked.data.materials[0] = own
    baked.leaflight.isovalue = 77.0
    baked.leaflight.shading = "ATTRIBUTE"
    assert baked.data.materials[0] == own
