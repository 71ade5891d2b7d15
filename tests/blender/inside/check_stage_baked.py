# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks stages with baked light."""

import os

import bpy
import numpy as np
import pytest
from leaflight_addon.stage import presets
from tools import require_eevee

BUILT = [name for name in presets.PRESETS if name != presets.MY_SCENE]


def _stage(preset):
    assert bpy.ops.leaflight.stage(preset=preset) == {"FINISHED"}
    bpy.context.view_layer.update()


def check_what_was_lit_by_the_last_bake_goes_with_its_stage(bumps):
    _stage("CORNELL")
    assert bumps.leaflight.light_walls
    bpy.ops.leaflight.bake()
    assert any(obj.name == "floor Lit" for obj in bpy.context.scene.objects)
    _stage("LIGHT_TENT")
    assert not any(obj.name.endswith(" Lit") for obj in bpy.context.scene.objects)
    bpy.ops.leaflight.bake()
    assert bumps.leaflight.bake_walls and bpy.data.objects["floor"].hide_render


def check_walls_and_isosurface_lose_their_light_together(bumps):
    """Checks that a new stage removes all baked light. The file of the bake stays, and undo
    restores the light.
    """
    _stage("CORNELL")
    bpy.ops.leaflight.bake()
    path = bpy.path.abspath(bumps.leaflight.bake_path)
    assert "radiance" in bumps.data.attributes
    _stage("STUDIO")
    assert not bumps.leaflight.bake_id and "radiance" not in bumps.data.attributes
    assert os.path.exists(path)
    bpy.ops.leaflight.bake()
    assert "radiance" in bumps.data.attributes
    assert "radiance" in bpy.data.objects["backdrop Lit"].data.attributes


@pytest.mark.parametrize("preset", BUILT)
def check_nothing_is_burnt_out(bumps, preset, tmp_path):
    """Checks the rendered picture: neither white nor all dark."""
    _stage(preset)
    scene = bpy.context.scene
    bpy.ops.leaflight.bake()
    scene.render.engine = require_eevee()
    scene.render.resolution_x, scene.render.resolution_y = 160, 90
    scene.render.resolution_percentage = 100
    scene.render.filepath = str(tmp_path / "still.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(160 * 90 * 4, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(90, 160, 4)[..., :3]
    assert pixels.min(axis=2).max() < 0.97
    middle = pixels[25:65, 60:100].mean()
    assert 0.15 < middle < 0.85
