# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares baked stills with Cycles' path tracing of the same scenes, including lit walls."""

import bpy
import numpy as np
import pytest
from boxes import build_cornell_box
from leaflight_addon import versions
from leaflight_addon.compare import stills
from tools import add_light, constant_material, error_of, noise_image


@pytest.fixture
def scene(boxed):
    _frame()
    settings = boxed.leaflight
    settings.light_walls = True
    settings.resolution, settings.error = 32, 1.5
    return boxed


def _frame():
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.render.resolution_percentage = 100


def assert_agrees(isosurface, isovalue, samples=256, baked_samples=16, most=2.5):
    """Checks the difference. most: RMS error of displayed colors in percent, without the noise of
    Cycles.
    """
    isosurface.leaflight.isovalue = isovalue
    result = stills.compare(bpy.context, isosurface, samples, baked_samples)
    noise = result["isosurface_noise_percent"]
    assert result["isosurface_pixels"] > 15 and 0 < noise < 6
    assert result["isosurface_rms_percent"] ** 2 - noise**2 < most**2
    assert result["image_rms_percent"] < most + noise
    cycles = result["cycles"].mean(axis=(0, 1))
    assert not stills.doubt(result)
    assert np.all(np.abs(result["baked"].mean(axis=(0, 1)) / cycles - 1.0) < 0.015)
    return result


def check_walls_at_three_isovalues(scene):
    bpy.ops.leaflight.bake()
    for isovalue in (30.0, 47.0, 100.0):
        assert_agrees(scene, isovalue, most=2.0)


def check_two_volumes(bumps, bump_file):
    _frame()
    bpy.ops.leaflight.import_volume(
        filepath=str(bump_file), dims=(24, 24, 24), value_type="float32", size=1.0
    )
    second = bpy.context.object
    second.location = (0.2, -0.9, 0.9)
    first = bpy.context.view_layer.objects.active = bumps
    first.leaflight.low, first.leaflight.high = 20.0, 100.0
    second.leaflight.low, second.leaflight.high = 20.0, 160.0
    bpy.context.view_layer.update()
    build_cornell_box()
    second.leaflight.isosurface_albedo = (0.2, 0.4, 0.8)
    settings = first.leaflight
    settings.light_walls = True
    settings.resolution, settings.error = 32, 1.5
    bpy.ops.leaflight.bake()
    for isosurface, isovalue in ((first, 40.0), (second, 55.0)):
        assert_agrees(isosurface, isovalue)


def check_isosurfaces_that_glow_in_a_ramp_of_colors_open_at_both_sides(scene):
    bpy.ops.leaflight.isosurface_preset(preset="TISSUE")
    scene.leaflight.isosurface_emission = (1.0, 0.6, 0.3)
    scene.leaflight.isosurface_emission_strength = 0.3
    scene.leaflight.both_sides = True
    bpy.ops.leaflight.bake()
    for isovalue in (10.0, 60.0):
        assert_agrees(scene, isovalue)


@pytest.mark.xfail(
    strict=True, reason="caps of a wide range are 1.6 % too bright, see validation.md"
)
def check_capped_walls_path_traced(scene):
    scene.leaflight.capped = True
    scene.leaflight.light_walls = False
    scene.leaflight.shading = "ATTRIBUTE"
    bpy.ops.leaflight.bake()
    assert_agrees(scene, 10.0, samples=1024, baked_samples=256)


def check_sky_and_point_light(scene):
    bpy.data.objects["lamp"].hide_render = True
    bpy.data.objects.remove(bpy.data.objects["ceiling"])
    add_light("POINT", (-0.6, -0.6, 1.7), energy=20).data.shadow_soft_size = 0.02
    tree = versions.give_nodes(bpy.context.scene.world)
    sky = tree.nodes.new("ShaderNodeTexEnvironment")
    sky.image = noise_image(16, 8)
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    background.inputs["Strength"].default_value = 0.5
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    assert_agrees(scene, 47.0, most=3.5)


def check_caustics_of_a_glass_isosurface_and_a_mirror_before_the_wall(scene):
    """Checks caustics of a wide lamp, which Cycles finds in reasonable time."""
    scene.leaflight.isosurface_scattering = "GLASS"
    scene.leaflight.capped = True
    bpy.data.objects["lamp"].scale = (1.3, 1.3, 1.0)
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(-0.6, -0.3, 0.3), rotation=(0.2, 0, 0.6))
    mirror = constant_material("ShaderNodeBsdfGlossy", Color=(0.9, 0.9, 0.9, 1), Roughness=0.0)
    bpy.context.object.data.materials.append(mirror)
    bpy.context.view_layer.objects.active = scene
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    # The baked still is noisy on glass and mirrors, too: 4 % with 16 samples (3.1 to 4.5 %).
    assert_agrees(scene, 47.0, samples=1024, baked_samples=256)


def check_a_glass_isosurface_without_lit_walls_has_nothing_to_compare(scene):
    bpy.ops.leaflight.bake()
    scene.leaflight.light_walls = False
    bpy.ops.leaflight.bake()
    scene.leaflight.isosurface_scattering = "GLASS"
    assert "light the walls" in error_of(bpy.ops.leaflight.render_comparison).lower()
