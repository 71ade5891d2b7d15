# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that three.js reads an exported .glb."""

import json
import shutil
import subprocess

import leaflight
import numpy as np
import pytest
from browser import PATHS, ROOT

pytestmark = pytest.mark.slow


def test_colors_and_places_arrive_in_three(bakes, tmp_path):
    node = shutil.which("node", path=PATHS)
    if not node or not (ROOT / "web" / "node_modules" / "three").is_dir():
        pytest.skip("Node or three.js is not installed; run scripts/setup --tests")
    bake, path = bakes("box"), tmp_path / "box.glb"
    leaflight.export(bake, path, [47.0])
    script = ROOT / "web" / "tests" / "gltf.mjs"
    done = subprocess.run([node, script, path], capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    surface = bake.surface(47.0)
    # In glTF, y is up.
    x, y, z = surface.vertices.T
    np.testing.assert_allclose(np.reshape(found["places"], (-1, 3)), np.c_[x, z, -y], atol=1e-5)
    np.testing.assert_allclose(found["size"], np.ptp(np.c_[x, z, y], axis=0), atol=1e-5)
    colors = np.reshape(found["colors"], (-1, found["channels"]))[:, :3]
    expected = np.clip(surface.radiance * bake.scene.exposure, 0, 1)
    assert found["usesColors"] and expected.max() > 0.2
    np.testing.assert_allclose(colors, expected, atol=1e-6)
