# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares mirrors, glass and textured walls around a small square, by Cycles and by the core."""

import math

import bpy
import numpy as np
import pytest
from leaflight_addon.show import isosurfaces
from leaflight_addon.stage import scene_export
from tools import (
    add_light,
    build_probe,
    close,
    constant_material,
    noise_image,
    rendered_probe,
    traced_probe,
)


@pytest.fixture
def probe(monkeypatch):
    box = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 0.0]])
    monkeypatch.setattr(isosurfaces, "world_box", lambda obj: box)
    monkeypatch.setattr(isosurfaces, "export_isosurfaces", lambda obj, several: None)
    return build_probe((0.8, 0.5, 0.3))


def assert_probe_agrees(tmp_path, samples):
    bpy.context.view_layer.update()
    isosurface = bpy.data.objects.new("Isosurface", None)
    description, _, warnings = scene_export.export_scene(bpy.context, isosurface)
    assert warnings == []
    expected, error = traced_probe(description, 1 << 20)
    assert np.all(error < 0.003 * expected)
    rendered = rendered_probe(tmp_path / "probe.exr", samples)
    assert expected.min() > 1e-3
    close(rendered / expected, 1.0, 0.01)


def _plane(size, location, rotation, kind, **inputs):
    bpy.ops.mesh.primitive_plane_add(size=size, location=location, rotation=rotation)
    bpy.context.object.data.materials.append(constant_material(kind, **inputs))
    return bpy.context.object


def _glowing_wall():
    """Adds an upright emissive wall beside the square. A mirror opposite or glass in front changes
    the light.
    """
    _plane(1.0, (-0.8, 0.1, 0.6), (0, math.pi / 2, 0), "ShaderNodeEmission", Color=(1, 0.6, 0.3, 1))


@pytest.mark.parametrize("kind", ["ShaderNodeBsdfGlossy", "ShaderNodeBsdfPrincipled"])
def check_a_mirror(probe, tmp_path, kind):
    _glowing_wall()
    color = (0.9, 0.8, 0.6, 1)
    if kind == "ShaderNodeBsdfGlossy":
        inputs = {"Color": color, "Roughness": 0.0}
    else:
        # Use white, because the Principled BSDF makes other colors whiter at grazing angles.
        inputs = {"Base Color": (1, 1, 1, 1), "Metallic": 1.0, "Roughness": 0.0}
    _plane(1.5, (0.6, 0.0, 0.5), (0, math.pi / 2 + 0.2, 0), kind, **inputs)
    assert_probe_agrees(tmp_path, 2048)


@pytest.mark.parametrize("kind", ["ShaderNodeBsdfGlass", "ShaderNodeBsdfPrincipled"])
@pytest.mark.parametrize("flipped", [False, True])
def check_a_glass_block(probe, tmp_path, kind, flipped):
    _glowing_wall()
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(-0.45, 0.05, 0.31), rotation=(0.1, 0, 0.2))
    if kind == "ShaderNodeBsdfGlass":
        inputs = {"Color": (0.9, 0.95, 1, 1), "Roughness": 0.0, "IOR": 1.6}
    else:
        inputs = {"Base Color": (1, 1, 1, 1), "Transmission": 1.0, "Roughness": 0.0, "IOR": 1.6}
    cube = bpy.context.object
    cube.data.materials.append(constant_material(kind, **inputs))
    if flipped:
        cube.scale.x = -1.0
    assert_probe_agrees(tmp_path, 2048)


def check_a_textured_wall(probe, tmp_path):
    """Checks a wall that reflects the light of a sun, from behind the square, in its colors."""
    wall = _plane(1.6, (0.5, 0.0, 0.6), (0, math.pi / 2, 0), "ShaderNodeBsdfDiffuse")
    tree = wall.data.materials[0].node_tree
    (diffuse,) = (n for n in tree.nodes if n.type == "BSDF_DIFFUSE")
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = noise_image(4, 4)
    tree.links.new(texture.outputs["Color"], diffuse.inputs["Color"])
    sun = add_light("SUN", rotation=(0, -1.2, 0), energy=3.0)
    sun.data.angle = 0.0
    assert_probe_agrees(tmp_path, 1024)
