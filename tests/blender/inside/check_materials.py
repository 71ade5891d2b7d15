# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks how materials and image textures are converted for the bake."""

import math

import bpy
import numpy as np
import pytest
from leaflight import LeaflightError
from leaflight_addon.stage import materials, meshes
from tools import (
    camera_rays_down,
    close,
    constant_material,
    look_down,
    noise_image,
    one_colored_world,
    plain_material,
    render_exr,
    smooth_image,
)


COLOR = (0.2, 0.4, 0.6, 1)


def surface(material):
    return materials.surface_of("Thing", material)


def check_diffuse_and_principled():
    diffuse = surface(constant_material("ShaderNodeBsdfDiffuse", Color=(0.1, 0.2, 0.3, 1)))
    close(diffuse.albedo, (0.1, 0.2, 0.3), 1e-6)
    assert (diffuse.scattering, diffuse.warnings) == ("diffuse", [])
    rough = surface(constant_material("ShaderNodeBsdfDiffuse", Roughness=0.5))
    assert "roughness" in rough.warnings[0]
    principled = surface(principled_material(Specular=0.5))
    close(principled.albedo, (0.2, 0.4, 0.6), 1e-6)
    assert principled.scattering == "diffuse" and "Specular" in principled.warnings[0]


def principled_material(**inputs):
    inputs = {"Base Color": (0.2, 0.4, 0.6, 1), "Specular": 0.0, **inputs}
    return constant_material("ShaderNodeBsdfPrincipled", **inputs)


def check_mirrors():
    white = {"Base Color": (1, 1, 1, 1)}
    for material, color in (
        (constant_material("ShaderNodeBsdfGlossy", Color=COLOR, Roughness=0.0), COLOR[:3]),
        (principled_material(Metallic=1.0, Roughness=0.0, Transmission=0.3, **white), (1, 1, 1)),
    ):
        found = surface(material)
        assert (found.scattering, found.warnings) == ("mirror", [])
        close(found.albedo, color, 1e-6)
    sharp = constant_material("ShaderNodeBsdfGlossy", Roughness=0.5)
    (glossy,) = (n for n in sharp.node_tree.nodes if n.type == "BSDF_GLOSSY")
    if "SHARP" in glossy.bl_rna.properties["distribution"].enum_items:  # until 3.6
        glossy.distribution = "SHARP"
        assert surface(sharp).scattering == "mirror"


def check_glass():
    polished = {"Roughness": 0.0, "IOR": 1.7}
    clear = {"Base Color": (1, 1, 1, 1), "Transmission": 1.0, "Specular": 0.5}
    for material, color in (
        (constant_material("ShaderNodeBsdfGlass", Color=COLOR, **polished), COLOR[:3]),
        (principled_material(**polished, **clear), (1, 1, 1)),
    ):
        found = surface(material)
        assert (found.scattering, found.warnings) == ("glass", [])
        close(found.albedo, color, 1e-6)
        assert found.ior == pytest.approx(1.7)


def _brightness(path, material, angle):
    """Returns the light (r, g, b) of a white world through a polished slab at an angle."""
    bpy.context.scene.world = one_colored_world((1, 1, 1))
    bpy.ops.mesh.primitive_cube_add(size=2)
    slab = bpy.context.object
    slab.data.materials.append(material)
    camera = look_down(3.0, 0.1)
    camera.location = (2 * math.sin(angle), 0, 1 + 2 * math.cos(angle))
    camera.rotation_euler.y = angle
    pixels = render_exr(path, size=8, samples=256)[..., :3].mean(axis=(0, 1))
    bpy.data.objects.remove(slab)
    return pixels


def check_a_colored_principled_glass_lets_pass_what_cycles_does_and_is_warned_of(tmp_path):
    """Checks that only its reflection differs, 4 % at each face, and that a warning says so."""
    principled = principled_material(Transmission=1.0, Roughness=0.0, IOR=1.5)
    found = surface(principled)
    assert len(found.warnings) == 1 and "Glass BSDF" in found.warnings[0]
    baked = constant_material(
        "ShaderNodeBsdfGlass", Color=(*found.albedo, 1), Roughness=0.0, IOR=found.ior
    )
    pixels = [_brightness(tmp_path / "slab.exr", each, 0.0) for each in (principled, baked)]
    close(*pixels, 0.04)


def check_a_principled_diffuse_that_is_not_lambertian_is_warned_of(tmp_path):
    """Checks the warning where Cycles renders it differently in a white world: until 3.6, by its
    roughness.
    """
    for roughness in (0.0, 0.5, 1.0):
        material = principled_material(Roughness=roughness)
        found = surface(material)
        pixels = [_brightness(tmp_path / "slab.exr", material, x) for x in (0.0, 1.2)]
        off = max(np.abs(seen / found.albedo - 1).max() for seen in pixels)
        assert off < 0.02 or len(found.warnings) == 1 and "Diffuse BSDF" in found.warnings[0]
        assert not found.warnings or off > 0.02


def check_a_colored_principled_metal_is_warned_of_where_its_edges_differ(tmp_path):
    for specular in (0.0, 0.5):
        metal = principled_material(Metallic=1.0, Roughness=0.0, Specular=specular)
        found = surface(metal)
        flat, grazing = (_brightness(tmp_path / "slab.exr", metal, x) for x in (0.0, 1.2))
        close(flat, found.albedo, 2e-3)
        assert len(found.warnings) == (np.abs(grazing - flat).max() > 0.02)
        assert all("Glossy BSDF" in warning for warning in found.warnings)


def check_thin_films_and_thin_walls():
    """Checks each input that this version has; they were added in 4.2, 4.5, 5.0 and 5.2."""
    white = {"Base Color": (1, 1, 1, 1), "Roughness": 0.0}
    film = {"Thin Film Thickness": 400.0}
    for material, inputs in (
        (principled_material(), film),
        (principled_material(Metallic=1.0, **white), film),
        (principled_material(Transmission=1.0, **white), film),
        (constant_material("ShaderNodeBsdfGlass", Roughness=0.0), film),
        (principled_material(), {"Diffuse Roughness": 0.5}),
    ):
        shader = next(n for n in material.node_tree.nodes if n.type.startswith("BSDF"))
        assert surface(material).warnings == []
        for name, value in inputs.items():
            if name in shader.inputs:
                shader.inputs[name].default_value = value
                assert name in surface(material).warnings[0]
    pane = principled_material(Transmission=1.0, **white)
    shader = next(n for n in pane.node_tree.nodes if n.type.startswith("BSDF"))
    if "Thin Wall" in shader.inputs:
        shader.inputs["Thin Wall"].default_value = True
        assert "Thin Wall" in sentence_of(pane)
        shader.inputs["Transmission Weight"].default_value = 0.0
        assert surface(pane).warnings == []


def check_emission_beside_reflection():
    glow = {"Emission": (1.0, 0.5, 0.25, 1), "Emission Strength": 2.0}
    found = surface(principled_material(**glow))
    close(found.albedo, (0.2, 0.4, 0.6), 1e-6)
    close(found.emission, (2.0, 1.0, 0.5), 1e-6)
    added = constant_material("ShaderNodeAddShader")
    tree = added.node_tree
    (add,) = (n for n in tree.nodes if n.type == "ADD_SHADER")
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    emission = tree.nodes.new("ShaderNodeEmission")
    diffuse.inputs["Color"].default_value = (0.2, 0.4, 0.6, 1)
    emission.inputs["Strength"].default_value = 3.0
    tree.links.new(diffuse.outputs[0], add.inputs[0])
    tree.links.new(emission.outputs[0], add.inputs[1])
    found = surface(added)
    close(found.albedo, (0.2, 0.4, 0.6), 1e-6)
    close(found.emission, (3.0, 3.0, 3.0), 1e-6)


def check_no_material_no_nodes_and_nothing_connected():
    close(surface(None).albedo, materials.DEFAULT_ALBEDO, 0)
    plain = plain_material("Plain", (0.3, 0.3, 0.1))
    close(surface(plain).albedo, (0.3, 0.3, 0.1), 1e-6)
    black = constant_material("ShaderNodeBsdfDiffuse")
    black.node_tree.links.clear()
    close(surface(black).albedo, (0, 0, 0), 0)


@pytest.mark.parametrize(
    "kind, inputs, reason",
    [
        ("ShaderNodeBsdfGlossy", {"Roughness": 0.3}, "roughness 0.3"),
        ("ShaderNodeBsdfGlass", {"Roughness": 0.2}, "roughness 0.2"),
        ("ShaderNodeBsdfPrincipled", {"Metallic": 1.0}, "roughness 0.5"),
        ("ShaderNodeBsdfPrincipled", {"Metallic": 0.5}, "Metallic 0.5"),
        ("ShaderNodeBsdfPrincipled", {"Transmission": 0.5}, "Transmission 0.5"),
        ("ShaderNodeBsdfPrincipled", {"Transmission": 1.0}, "roughness 0.5"),
        ("ShaderNodeBsdfPrincipled", {"Alpha": 0.5}, "Alpha"),
        ("ShaderNodeBsdfPrincipled", {"Subsurface": 0.5}, "Subsurface"),
        ("ShaderNodeEmission", {"Strength": -1.0}, "negative"),
        ("ShaderNodeBsdfTransparent", {}, "Transparent"),
        ("ShaderNodeMixShader", {}, "Mix Shader"),
    ],
)
def check_a_material_that_cannot_be_baked_is_named_with_its_object(kind, inputs, reason):
    material = constant_material(kind, **inputs)
    sentence = sentence_of(material)
    assert reason in sentence


def sentence_of(material):
    with pytest.raises(LeaflightError) as caught:
        surface(material)
    sentence = str(caught.value)
    assert '"Thing"' in sentence and f'"{material.name}"' in sentence
    assert "\n" not in sentence and sentence.endswith(".") and ":" in sentence
    return sentence


def check_other_textures_and_volumes_are_refused():
    checkered = constant_material("ShaderNodeBsdfDiffuse")
    tree = checkered.node_tree
    checker = tree.nodes.new("ShaderNodeTexChecker")
    tree.links.new(checker.outputs[0], _diffuse(tree).inputs["Color"])
    assert "Checker" in sentence_of(checkered)
    mirror = constant_material("ShaderNodeBsdfGlossy", Roughness=0.0)
    tree = mirror.node_tree
    (glossy,) = (n for n in tree.nodes if n.type == "BSDF_GLOSSY")
    tree.links.new(tree.nodes.new("ShaderNodeTexImage").outputs[0], glossy.inputs["Color"])
    assert "textured color" in sentence_of(mirror)
    fog = constant_material("ShaderNodeBsdfDiffuse")
    tree = fog.node_tree
    (output,) = (n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    scatter = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(scatter.outputs[0], output.inputs["Volume"])
    assert "volume" in sentence_of(fog)


def check_a_normal_map_is_warned_of():
    bumpy = constant_material("ShaderNodeBsdfDiffuse")
    tree = bumpy.node_tree
    tree.links.new(
        tree.nodes.new("ShaderNodeNormalMap").outputs[0], _diffuse(tree).inputs["Normal"]
    )
    assert "normal map" in surface(bumpy).warnings[0]


def _diffuse(tree):
    return next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE")


def _textured_plane(image, extension="REPEAT"):
    """Adds a plane that uses its second UV map, which rotates, scales and moves the image."""
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    plane = bpy.context.object
    second = plane.data.uv_layers.new(name="Second")
    for loop in plane.data.loops:
        x, y, _ = plane.data.vertices[loop.vertex_index].co
        second.data[loop.index].uv = (0.5 + 0.3 * x - 0.2 * y, 0.5 + 0.2 * x + 0.3 * y)
    material = constant_material("ShaderNodeBsdfDiffuse")
    tree = material.node_tree
    texture, uv_map = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeUVMap")
    texture.image, texture.extension, uv_map.uv_map = image, extension, "Second"
    tree.links.new(uv_map.outputs[0], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], _diffuse(tree).inputs["Color"])
    plane.data.materials.append(material)
    bpy.context.view_layer.update()
    return plane, tree, texture


def _exported(plane):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    warnings = []
    parts = meshes.export_meshes(plane.evaluated_get(depsgraph), plane.matrix_world, warnings)
    assert warnings == []
    return parts


def _albedo_at(part, points):
    """Returns texture colors of a mesh at points (n, 2) of its plane z = 0, between pixels."""
    colors = np.full((len(points), 3), np.nan)
    for triangle, uv in zip(part.triangles, part.uv):
        a, b, c = part.vertices[triangle][:, :2].astype(np.float64)
        weights = (points - a) @ np.linalg.inv(np.array([b - a, c - a]))
        inside = (weights >= -1e-6).all(axis=1) & (weights.sum(axis=1) <= 1 + 1e-6)
        u, v = (uv[0] + weights[inside] @ np.array([uv[1] - uv[0], uv[2] - uv[0]])).T
        rows, columns = part.texture.shape[:2]
        x, y = u * columns - 0.5, v * rows - 0.5
        i, j = np.floor(x).astype(int), np.floor(y).astype(int)
        total = 0.0
        for di in (0, 1):
            for dj in (0, 1):
                weight = np.abs(1 - di - (x - i)) * np.abs(1 - dj - (y - j))
                total += weight[:, None] * part.texture[(j + dj) % rows, (i + di) % columns]
        colors[inside] = total
    return colors * np.array(part.albedo)


@pytest.mark.parametrize("mapped", [False, True])
@pytest.mark.parametrize("picture", [noise_image, smooth_image])
def check_an_image_on_a_uv_map_is_what_cycles_renders(tmp_path, picture, mapped):
    plane, tree, texture = _textured_plane(picture(128, 64))
    if mapped:
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Location"].default_value = (0.3, -0.2, 0)
        mapping.inputs["Rotation"].default_value = (0, 0, 0.6)
        mapping.inputs["Scale"].default_value = (1.5, 0.8, 1)
        tree.links.new(texture.inputs["Vector"].links[0].from_socket, mapping.inputs["Vector"])
        tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
    (part,) = _exported(plane)
    bpy.context.scene.world = one_colored_world((1, 1, 1))
    look_down(2.0, 1.8)
    rendered = render_exr(tmp_path / "plane.exr", size=24, samples=1)[..., :3].reshape(-1, 3)
    x, y = camera_rays_down(1.8, 24)
    expected = _albedo_at(part, np.stack([x.ravel(), y.ravel()], axis=-1))
    assert expected.std() > 0.1
    close(rendered, expected, 0.01)


def check_an_8_bit_image_that_holds_data_and_one_with_alpha(tmp_path):
    pixels = np.full((4, 4, 4), 0.5, np.float32)
    image = bpy.data.images.new("Half", 4, 4, alpha=True)
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = str(tmp_path / "half.png"), "PNG"
    image.save()
    loaded = bpy.data.images.load(str(tmp_path / "half.png"))
    for space, mode, encoded in (
        ("sRGB", "CHANNEL_PACKED", 128 / 255),
        ("sRGB", "STRAIGHT", (128 / 255) ** 2),
        ("Non-Color", "CHANNEL_PACKED", None),
    ):
        loaded.colorspace_settings.name, loaded.alpha_mode = space, mode
        plane, _, _ = _textured_plane(loaded)
        (part,) = _exported(plane)
        linear = 128 / 255 if encoded is None else ((encoded + 0.055) / 1.055) ** 2.4
        close(part.texture, linear, 1e-3)
        bpy.context.scene.world = one_colored_world((1, 1, 1))
        look_down(2.0, 1.0)
        rendered = render_exr(tmp_path / "plane.exr", size=4, samples=1)[..., :3]
        close(rendered, linear, 2e-3)
        bpy.data.objects.remove(plane)


def check_a_repainted_image_is_read_again():
    image = noise_image(4, 4)
    plane, _, _ = _textured_plane(image)
    (before,) = _exported(plane)
    assert _exported(plane)[0].texture is before.texture
    image.pixels.foreach_set(np.ones(64, np.float32))
    (after,) = _exported(plane)
    close(after.texture, 1.0, 0)


@pytest.mark.parametrize("mirrored", [False, True])
def check_parts_keep_their_uv_and_normals_through_a_mirroring_scale(mirrored):
    plane, _, _ = _textured_plane(noise_image(8, 8))
    plane.scale.x = -1.0 if mirrored else 1.0
    bpy.context.view_layer.update()
    (part,) = _exported(plane)
    corners = part.vertices[part.triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.all(normals[:, 2] > 0)
    sign = -1 if mirrored else 1
    x, y = sign * corners[..., 0], corners[..., 1]
    close(part.uv[..., 0], 0.5 + 0.3 * x - 0.2 * y, 1e-5)
    close(part.uv[..., 1], 0.5 + 0.2 * x + 0.3 * y, 1e-5)


def _no_uv(plane, texture):
    while plane.data.uv_layers:
        plane.data.uv_layers.remove(plane.data.uv_layers[0])
    plane.data.update_tag()


def _clipped(plane, texture):
    texture.extension = "CLIP"
    plane.data.uv_layers["Second"].data[0].uv = (2, 2)


def _box(plane, texture):
    texture.projection = "BOX"


def _no_image(plane, texture):
    texture.image = None


def _movie(plane, texture):
    texture.image.source = "SEQUENCE"


def _filmic(plane, texture):
    texture.image = smooth_image(4, 4)
    texture.image.colorspace_settings.name = "Filmic sRGB"


@pytest.mark.parametrize(
    "spoil, reason",
    [
        (_no_uv, '"Second"'),
        (_clipped, "Repeat"),
        (_box, "Flat"),
        (_no_image, "without an image"),
        (_movie, "sequence"),
        (_filmic, "Filmic"),
    ],
)
def check_a_texture_that_cannot_be_baked_is_named(spoil, reason):
    plane, _, texture = _textured_plane(noise_image(4, 4))
    plane.name = "My Plane"
    spoil(plane, texture)
    bpy.context.view_layer.update()
    with pytest.raises(LeaflightError) as caught:
        _exported(plane)
    sentence = str(caught.value)
    assert '"My Plane"' in sentence and reason in sentence and "\n" not in sentence


def check_a_smooth_mirror_is_warned_of():
    bpy.ops.mesh.primitive_uv_sphere_add()
    sphere = bpy.context.object
    sphere.data.materials.append(constant_material("ShaderNodeBsdfGlossy", Roughness=0.0))
    warnings = []
    for smooth in (False, True):
        sphere.data.polygons.foreach_set("use_smooth", [smooth] * len(sphere.data.polygons))
        sphere.data.update()
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        meshes.export_meshes(sphere.evaluated_get(depsgraph), sphere.matrix_world, warnings)
        assert len(warnings) == smooth
