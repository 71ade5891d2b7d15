# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that a saved .blend opens with its light in a Blender without the add-on."""

import os
import subprocess

import bpy
import leaflight
import numpy as np
import pytest
from blends import save
from leaflight import blender
from tools import HANG, close, render_exr

# Script that the other Blender runs. Leaflight must not be enabled there.
RENDER = """
import bpy, sys
assert not hasattr(bpy.types.Object, "leaflight"), "the add-on is enabled"
scene = bpy.context.scene
scene.render.filepath = {path!r}
bpy.ops.render.render(write_still=True)
print("RENDERED")
"""


def render_elsewhere(blend, path):
    """Returns pixels of the scene as a Blender without the add-on renders it."""
    if not bpy.app.binary_path:
        pytest.skip("Blender as a Python module has no program to start")
    nothing = {
        name: str(path.parent / "nobody")
        for name in ("BLENDER_USER_CONFIG", "BLENDER_USER_SCRIPTS", "BLENDER_USER_RESOURCES")
    }
    expression = RENDER.format(path=str(path))
    done = subprocess.run(
        [
            *(bpy.app.binary_path, "--background", "--factory-startup", str(blend)),
            *("--python-exit-code", "1", "--python-expr", expression),
        ],
        env={**os.environ, **nothing},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=HANG,
    )
    assert done.returncode == 0 and "RENDERED" in done.stdout, done.stdout
    return leaflight._core.read_exr(str(path))


def bake_in_a_file(tmp_path):
    """Bakes in a new .blend and returns its path and a picture; the caller saves it again."""
    blend = tmp_path / "made" / "scene.blend"
    blend.parent.mkdir()
    save(blend)
    bpy.ops.leaflight.bake()
    return blend, render_exr(tmp_path / "here.exr", samples=16)[..., :3]


@pytest.mark.parametrize("shading", ["ATLAS", "ATTRIBUTE"])
def check_it_opens_lit(boxed, tmp_path, shading):
    """Checks textures and vertex attributes, lit walls, translucent isosurfaces and cuts."""
    boxed.leaflight.bake_folder = ""
    boxed.leaflight.light_walls = True
    boxed.leaflight.shading = shading
    boxed.leaflight.isovalue = 47.0
    blender.add_isosurface(boxed, 40.0, opacity=0.5).leaflight_look.is_cut = False
    bpy.ops.leaflight.add_clip_box()
    blend, here = bake_in_a_file(tmp_path)
    save(blend)
    there = render_elsewhere(blend, tmp_path / "there.exr")[..., :3]
    assert here.mean() > 0.05 and here.std() > 0.05
    close(there, here, 1e-3)
    # Check that the comparison would notice a missing bake: without materials the picture differs.
    for obj in bpy.data.objects:
        if obj.type == "MESH" and obj.data.materials:
            obj.data.materials.clear()
    plain = render_exr(tmp_path / "plain.exr", samples=16)[..., :3]
    assert np.abs(plain - here).mean() > 0.02


def check_packed_it_is_one_file(boxed, tmp_path):
    """Checks File > External Data > Pack Resources: then the .blend is enough."""
    boxed.leaflight.bake_folder = ""
    boxed.leaflight.isovalue = 47.0
    blend, here = bake_in_a_file(tmp_path)
    bpy.ops.file.pack_all()
    save(blend)
    alone = tmp_path / "alone.blend"
    blend.rename(alone)
    (blend.parent / "leaflight").rename(tmp_path / "gone")
    there = render_elsewhere(alone, tmp_path / "there.exr")[..., :3]
    close(there, here, 1e-3)
