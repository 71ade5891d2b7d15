# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares lights and worlds: the radiance of a small square, by Cycles and by the core."""

import math

import bpy
import numpy as np
import pytest
from leaflight import LeaflightError
from leaflight.measure import blender_versions
from leaflight_addon import versions
from leaflight_addon.show import isosurfaces
from leaflight_addon.stage import scene_export, world
from tools import (
    add_light,
    build_probe,
    close,
    constant_material,
    noise_image,
    one_colored_world,
    rendered_probe,
    smooth_image,
    traced_probe,
)


@pytest.fixture
def probe():
    return build_probe((0.8, 0.5, 0.3))


@pytest.fixture
def assert_probe_agrees(probe, tmp_path, record_property):
    """Compares the radiance of the probe by Cycles and by the core.

    most: allowed difference, including noise. Returns the scene description.
    """

    def compare(samples=256, most=0.005):
        description, warnings = export()
        assert warnings == []
        expected, error = traced_probe(description)
        assert expected.min() > 1e-3
        halves = [rendered_probe(tmp_path / "probe.exr", samples // 2, seed) for seed in (1, 2)]
        ratio = np.mean(halves, axis=0) / expected
        noise = np.hypot(error / expected, 0.5 * (halves[0] - halves[1]) / expected)
        record_property("cycles_over_bake", [float(x) for x in ratio])
        assert np.all(noise < most / 5)
        close(ratio, 1.0, most)
        return description

    return compare


def export():
    bpy.context.view_layer.update()
    isosurface = bpy.data.objects.new("Isosurface", None)
    description, _, warnings = scene_export.export_scene(bpy.context, isosurface)
    return description, warnings


@pytest.fixture(autouse=True)
def without_a_volume(monkeypatch):
    """Removes the requirement of a volume, because the probe stands for it."""
    box = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 0.0]])
    monkeypatch.setattr(isosurfaces, "world_box", lambda obj: box)
    monkeypatch.setattr(isosurfaces, "export_isosurfaces", lambda obj, several: None)


@pytest.mark.parametrize("shape", ["SQUARE", "RECTANGLE", "DISK", "ELLIPSE"])
def check_area_lights(assert_probe_agrees, shape):
    # Put it beside the camera, which would block it from right above.
    lamp = add_light("AREA", (0.4, 0.2, 1.0), (0.2, 0.3, 0.5), energy=5.0, color=(1.0, 0.7, 0.4))
    lamp.data.shape = shape
    lamp.data.size, lamp.data.size_y = 0.6, 0.4
    lamp.scale = (1.5, 0.5, 1.0)
    (light,) = assert_probe_agrees().lights
    assert light.ellipse == (shape in {"DISK", "ELLIPSE"})


@pytest.mark.parametrize("radius", [0.0, 0.1])
def check_a_point_light_whose_object_is_scaled(assert_probe_agrees, radius):
    lamp = add_light("POINT", (0.6, 0.3, 1.5), energy=40.0, color=(1.0, 0.7, 0.4))
    lamp.data.shadow_soft_size = radius
    lamp.scale = (3.0, 3.0, 3.0)
    (light,) = assert_probe_agrees().lights
    assert light.radius == pytest.approx(radius)


@pytest.mark.parametrize("off_axis", [0.0, 0.25, 0.4])
def check_a_spot(assert_probe_agrees, off_axis):
    lamp = add_light("SPOT", (0.5, 0.0, 2.0), energy=60.0, color=(1.0, 0.7, 0.4))
    lamp.data.spot_size, lamp.data.spot_blend = 1.0, 0.5
    lamp.data.shadow_soft_size = 0.0
    lamp.rotation_euler.y = math.atan2(0.5, 2.0) + off_axis
    (light,) = assert_probe_agrees().lights
    assert light.cone is not None


@pytest.mark.parametrize("angle", [0.0, 0.00918, 0.6])
def check_a_sun(assert_probe_agrees, angle):
    sun = add_light("SUN", (9, 9, 9), (0.5, 0.2, 0.0), energy=2.0, color=(1.0, 0.7, 0.4))
    sun.data.angle = angle
    assert_probe_agrees()


def check_a_wide_point_light_without_soft_falloff(assert_probe_agrees):
    """Checks hard falloff, which Blender offers from 4.2 on; before, light falls off softly."""
    lamp = add_light("POINT", (0.6, 0.3, 1.5), energy=40.0)
    hard = hasattr(lamp.data, "use_soft_falloff")
    lamp.data.shadow_soft_size = 0.5 if hard else 0.05
    versions.harden_falloff(lamp.data)
    assert versions.falls_off_softly(lamp.data) != hard
    assert_probe_agrees(samples=1024)


def check_exposure_and_temperature(assert_probe_agrees):
    """Checks the exposure and the temperature of lights, which Blender has from 4.4 on."""
    lamp = add_light("POINT", (0.6, 0.3, 1.5), energy=40.0, color=(1.0, 0.7, 0.4))
    lamp.data.shadow_soft_size = 0.0
    (plain,) = assert_probe_agrees().lights
    if not hasattr(lamp.data, "exposure"):
        return
    lamp.data.exposure = 1.5
    lamp.data.use_temperature, lamp.data.temperature = True, 3000.0
    (light,) = assert_probe_agrees().lights
    ratio = np.array(light.intensity) / plain.intensity
    assert ratio[0] > 2.8 and ratio[2] < 0.6 * ratio[0]


def check_what_only_eevee_knows_changes_nothing(assert_probe_agrees):
    lamp = add_light("AREA", (0.4, 0.2, 1.0), (0.2, 0.3, 0.5), energy=5.0)
    lamp.data.size = 0.4
    lamp.data.diffuse_factor = lamp.data.specular_factor = lamp.data.volume_factor = 0.3
    lamp.data.use_custom_distance, lamp.data.cutoff_distance = True, 0.1
    assert_probe_agrees()


def check_a_light_with_an_emission_node(assert_probe_agrees):
    lamp = add_light("POINT", (0.6, 0.3, 1.5), energy=40.0)
    lamp.data.shadow_soft_size = 0.0
    tree = versions.give_nodes(lamp.data)
    emission = next(n for n in tree.nodes if n.type == "EMISSION")
    emission.inputs["Color"].default_value = (0.2, 0.4, 0.8, 1.0)
    emission.inputs["Strength"].default_value = 2.5
    assert_probe_agrees()


@pytest.mark.parametrize("kind", ["ShaderNodeEmission", "ShaderNodeBsdfPrincipled"])
def check_an_emissive_mesh(assert_probe_agrees, kind):
    bpy.ops.mesh.primitive_plane_add(
        size=0.7, location=(0.6, 0.1, 0.8), rotation=(0.3, math.pi - 0.5, 0.0)
    )
    if kind == "ShaderNodeEmission":
        inputs = {"Color": (1.0, 0.6, 0.3, 1.0), "Strength": 3.0}
    else:
        inputs = {
            "Base Color": (0, 0, 0, 1),
            "Specular": 0.0,
            "Emission": (1.0, 0.6, 0.3, 1.0),
            "Emission Strength": 3.0,
        }
    bpy.context.object.data.materials.append(constant_material(kind, **inputs))
    description = assert_probe_agrees(samples=512, most=0.01)
    close(description.meshes[1].emission, (3.0, 1.8, 0.9), 1e-6)


def check_a_world_of_one_color(assert_probe_agrees):
    bpy.context.scene.world = one_colored_world((0.3, 0.5, 0.9))
    description = assert_probe_agrees(samples=64)
    close(description.environment.radiance, (0.3, 0.5, 0.9), 1e-6)


def _environment_texture(image):
    tree = versions.give_nodes(bpy.context.scene.world)
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    tree.links.new(texture.outputs[0], background.inputs["Color"])
    background.inputs["Strength"].default_value = 1.7
    return tree, texture


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("picture", [noise_image, smooth_image])
def check_an_hdri(assert_probe_agrees, picture, turned):
    tree, texture = _environment_texture(picture(64, 32))
    if turned:
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Rotation"].default_value = (0.4, 0.3, 1.1)
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    description = assert_probe_agrees(samples=1024, most=0.01)
    assert description.environment.image.shape == (32, 64, 3)
    assert np.array_equal(description.environment.world_to_image, np.eye(3)) != turned


def _shadowless(lamp):
    if hasattr(lamp.data.cycles, "cast_shadow"):
        lamp.data.cycles.cast_shadow = False
    else:
        lamp.data.use_shadow = False


def _square(lamp):
    lamp.data.type = "SPOT"
    lamp.data = bpy.data.lights[lamp.data.name]
    lamp.data.use_square = True


def _ies(lamp):
    tree = versions.give_nodes(lamp.data)
    emission = next(n for n in tree.nodes if n.type == "EMISSION")
    tree.links.new(tree.nodes.new("ShaderNodeTexIES").outputs[0], emission.inputs["Strength"])


@pytest.mark.parametrize(
    "spoil, reason",
    [
        (lambda lamp: setattr(lamp.data.cycles, "is_portal", True), "portal"),
        (_shadowless, "shadows"),
        (lambda lamp: setattr(lamp.data, "spread", math.radians(90)), "90 degrees"),
        (_square, "square"),
        (_ies, "IES"),
        (lambda lamp: setattr(lamp.data, "energy", -1), "negative"),
    ],
)
def check_a_light_that_cannot_be_baked_is_named(spoil, reason):
    lamp = add_light("AREA", (0, 0, 1))
    lamp.name = "My Lamp"
    spoil(lamp)
    sentence = sentence_of_export()
    assert '"My Lamp"' in sentence and reason in sentence


def sentence_of_export():
    with pytest.raises(LeaflightError) as caught:
        export()
    sentence = str(caught.value)
    assert "\n" not in sentence and sentence.endswith(".") and ":" in sentence
    return sentence


def check_a_wide_point_light_nearby_is_warned_of(probe):
    lamp = add_light("POINT", (0.0, 0.0, 1.0), energy=10.0)
    for radius, warned in ((0.05, False), (0.2, True)):
        lamp.data.shadow_soft_size = radius
        _, warnings = export()
        assert len(warnings) == warned and all("4 %" in sentence for sentence in warnings)


def check_a_light_that_is_not_normalized_is_refused(probe):
    lamp = add_light("AREA", (0, 0, 1))
    if hasattr(lamp.data, "normalize"):  # from 4.4 on
        lamp.data.normalize = False
        sentence = sentence_of_export()
        assert f'"{lamp.name}"' in sentence and "Normalize" in sentence


def check_light_linking_is_warned_of(probe):
    lamp = add_light("POINT", (0.0, 0.0, 9.0), energy=10.0)
    if not hasattr(lamp, "light_linking"):  # before 4.0
        return
    for name in ("receiver_collection", "blocker_collection"):
        setattr(lamp.light_linking, name, bpy.data.collections.new("Few"))
        (warning,) = export()[1]
        assert f'"{lamp.name}"' in warning and "light linking" in warning
        setattr(lamp.light_linking, name, None)
    assert not export()[1]


def check_another_working_space_is_refused(probe):
    if not hasattr(bpy.data, "colorspace"):  # before 5.0
        return
    add_light("POINT", (0.0, 0.0, 9.0), energy=10.0)
    bpy.ops.wm.set_working_color_space(working_space="ACEScg", convert_colors=True)
    assert "ACEScg" in sentence_of_export()


def check_versions_that_were_never_compared_are_warned_of(probe, monkeypatch):
    add_light("POINT", (0.0, 0.0, 9.0), energy=10.0)
    bpy.context.view_layer.update()
    monkeypatch.setattr(blender_versions, "CHECKED", ((3, 6),))
    (warning,) = export()[1]
    assert "Render Comparison" in warning


def check_a_light_that_some_rays_do_not_see_is_warned_of(probe):
    lamp = add_light("POINT", (0.0, 0.0, 9.0), energy=10.0)
    lamp.visible_camera = False
    assert not export()[1]
    lamp.visible_glossy = False
    (warning,) = export()[1]
    assert f'"{lamp.name}"' in warning


def _sky(tree, texture):
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    tree.links.new(tree.nodes.new("ShaderNodeTexSky").outputs[0], background.inputs["Color"])


def _moved(tree, texture):
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Location"].default_value = (0, 0, 1)
    tree.links.new(mapping.outputs[0], texture.inputs["Vector"])


def _by_normal(tree, texture):
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Window"], texture.inputs["Vector"])


@pytest.mark.parametrize(
    "spoil, reason",
    [
        (_sky, "Sky"),
        (lambda _, texture: setattr(texture, "projection", "MIRROR_BALL"), "Mirror Ball"),
        (_moved, "Mapping"),
        (_by_normal, "Texture Coordinate"),
        (lambda _, texture: setattr(texture, "image", None), "without an image"),
    ],
)
def check_a_world_that_cannot_be_baked_is_named(probe, spoil, reason):
    spoil(*_environment_texture(noise_image(8, 4)))
    bpy.context.scene.world.name = "My World"
    sentence = sentence_of_export()
    assert '"My World"' in sentence and reason in sentence


def check_dark_worlds(probe):
    assert world.is_dark(None) and world.is_dark(bpy.context.scene.world)
    image = bpy.data.images.new("Black", 8, 4, float_buffer=True)
    _environment_texture(image)
    assert world.is_dark(bpy.context.scene.world)
    assert not world.is_dark(one_colored_world((0, 0, 0.1)))


def check_units_of_other_versions():
    assert blender_versions.light_units((3, 4, 1)).area == 0.25
    assert blender_versions.light_units((5, 2, 2)).area == pytest.approx(1 / math.pi)
    assert blender_versions.light_units((3, 3, 0)) is None
