# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that three.js reads an exported .glb."""

import json
import shutil
import subprocess
from dataclasses import replace

import leaflight
import numpy as np
import pytest
from browser import PATHS, ROOT

pytestmark = pytest.mark.slow


def in_three(path):
    """Returns the data that three.js reads from a .glb."""
    node = shutil.which("node", path=PATHS)
    if not node or not (ROOT / "web" / "node_modules" / "three").is_dir():
        pytest.skip("Node or three.js is not installed; run scripts/setup --tests")
    script = ROOT / "web" / "tests" / "gltf.mjs"
    done = subprocess.run([node, script, path], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def test_colors_and_places_arrive_in_three(bakes, tmp_path):
    bake, path = bakes("box"), tmp_path / "box.glb"
    leaflight.export(bake, path, [47.0])
    found, surface = in_three(path), bake.surface(47.0)
    # In glTF, y is up.
    x, y, z = surface.vertices.T
    np.testing.assert_allclose(np.reshape(found["places"], (-1, 3)), np.c_[x, z, -y], atol=1e-5)
    np.testing.assert_allclose(found["size"], np.ptp(np.c_[x, z, y], axis=0), atol=1e-5)
    colors = np.reshape(found["colors"], (-1, found["channels"]))[:, :3]
    expected = np.clip(surface.radiance * bake.scene.exposure, 0, 1)
    assert found["usesColors"] and expected.max() > 0.2
    np.testing.assert_allclose(colors, expected, atol=1e-6)
    assert found["values"] is None


def test_values_of_the_colors_arrive_in_three(tmp_path):
    volume = leaflight.bump_box(12)
    values = np.ascontiguousarray(np.broadcast_to(np.arange(12, dtype=np.float32), (12, 12, 12)))
    along = replace(volume, values=values, name="along")
    scene = leaflight.cornell_box().colored_by(leaflight.texture_of(along))
    bake = leaflight.bake(volume, scene, error=20.0)
    leaflight.export(bake, tmp_path / "box.glb", [47.0])
    x = bake.surface(47.0).vertices[:, 0]
    np.testing.assert_allclose(in_three(tmp_path / "box.glb")["values"], 11 * x, atol=1e-5)
