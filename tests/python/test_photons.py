# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests photons as points."""

import json

import leaflight
import meshio
import numpy as np
import pytest
from leaflight import _core
from leaflight.bake.bake import placed
from leaflight.bake.photons import trace_photons
from leaflight.scene.scene import core_scene
from leaflight_command import main

COUNT = 20_000


@pytest.fixture(scope="module")
def photons(bump_scene):
    return trace_photons(leaflight.bump_box(24), bump_scene, count=COUNT, seed=3)


def test_they_lie_on_their_isosurfaces(photons):
    field = leaflight.bump_box(24).field()
    heights = field.sample(photons.positions)
    low, high = field.range
    inside = np.isfinite(heights)
    assert inside.mean() > 0.99
    error = np.abs(heights - photons.common_isovalue)[inside]
    assert error.max() < 1e-3 * (high - low)
    assert photons.count == COUNT and 0.1 < photons.direct.mean() < 0.9


def test_they_carry_the_light_of_the_lamp(photons, bump_scene):
    """Checks that direct light is most of what the lamp emits over the isovalue range."""
    volume = leaflight.bump_box(24)
    (volume,), scene, isovalue_range = placed(volume, bump_scene, None)
    core = core_scene(scene, [volume.field()], isovalue_range)
    emitted = np.array(_core.photon_balance(core, COUNT, 3)["emitted"])
    direct = photons.flux_height[photons.direct].sum(axis=0)
    assert (direct < emitted).all() and (direct > 0.05 * emitted).all()
    colors = photons.colors()
    assert colors.mean() == pytest.approx(0.5, rel=1e-4)


def test_command(root, tmp_path, capsys, photons):
    out = tmp_path / "photons.ply"
    scene = root / "scenes" / "bump_box.json"
    arguments = ["photons", "bump_box", "--dims", "24", "--scene", str(scene), "--seed", "3"]
    assert main([*arguments, "--photons", str(COUNT), "--out", str(out), "--json"]) == 0
    result = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert result["points"] == len(photons.positions) and result["direct"] == photons.direct.sum()
    cloud = meshio.read(out)
    np.testing.assert_array_equal(cloud.points, photons.positions)
    np.testing.assert_array_equal(cloud.point_data["common_isovalue"], photons.common_isovalue)
    np.testing.assert_array_equal(cloud.point_data["direct"], photons.direct)
    np.testing.assert_array_equal(cloud.point_data["flux_g"], photons.flux_height[:, 1])
    assert cloud.point_data["red"].dtype == np.uint8 and cloud.point_data["red"].std() > 1
    assert main([*arguments, "--photons", "0", "--out", str(tmp_path / "none.ply")]) == 2
    assert "photons must be" in capsys.readouterr().err
    assert not (tmp_path / "none.ply").exists()
