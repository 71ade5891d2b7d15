# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks four clicks and one preset on scans that were not used for tuning
(validation/fetch_scans).
"""

from pathlib import Path

import bpy
import numpy as np
import pytest
from leaflight_addon.stage import camera
from tools import in_frame

SCANS = Path(__file__).resolve().parents[3] / "build" / "scans"
# File, True if its header has an orientation, and preset, by name.
FILES = {
    "human": (SCANS / "mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz", True, "SKIN"),
    "macaque": (Path("/usr/share/mricron/templates/inia19-t1-brain.nii.gz"), True, "CLAY"),
    "fly": (SCANS / "fly_150x256x256.tif", False, "COPPER"),
    "shell": (SCANS / "shell_225x128x128.tif", False, "IVORY"),
    "bone": (SCANS / "bone_128x128x128.tif", False, "BONE"),
}


@pytest.mark.parametrize("name", FILES)
def check_it_is_upright_or_asked_framed_and_lit(name, tmp_path):
    path, is_oriented, preset = FILES[name]
    if not path.exists():
        pytest.skip(f"{path.name} is not there: run validation/run fetch_scans")
    assert bpy.ops.leaflight.import_volume(filepath=str(path)) == {"FINISHED"}
    obj = bpy.context.object
    obj.leaflight.bake_folder = str(tmp_path)
    assert obj.leaflight_orientation.is_unknown != is_oriented
    bpy.ops.leaflight.stage()
    bpy.context.view_layer.update()
    x, y, _ = in_frame(obj).T
    assert 0 < x.min() and x.max() < 1 and 0 < y.min() and y.max() < 1
    fits = [np.ptp(x) - camera.WIDTH, np.ptp(y) - camera.HEIGHT]
    assert max(fits) == pytest.approx(0, abs=0.02)
    if is_oriented:
        up = np.array(obj.matrix_world)[2, :3]
        assert up[2] == pytest.approx(np.linalg.norm(up), rel=1e-3)
    bpy.ops.leaflight.isosurface_preset(preset=preset)
    assert bpy.ops.leaflight.bake() == {"FINISHED"}
    assert "radiance" in obj.data.attributes and obj.leaflight.bake_walls
    picture = _rendered(tmp_path / "picture.png")
    assert picture.min(axis=1).max() < 254 / 255, "burnt"
    assert picture.max(axis=1).min() > 1 / 255, "black"
    assert np.ptp(picture) > 0.3


def _rendered(path):
    """Returns displayed pixels (n, 3) of a small picture by Cycles."""
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 8
    scene.render.resolution_percentage = 10
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    pixels = np.array(bpy.data.images.load(str(path)).pixels, np.float32)
    return pixels.reshape(-1, 4)[:, :3]
