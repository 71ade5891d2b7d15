# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests a bake with other strengths of its lamps, against bakes of such scenes."""

from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight.bake.relit import scales_exactly
from leaflight.scene.lights import PointLight
from leaflight.scene.scene import Environment
from outcomes import refused

ISOVALUES = (30.0, 70.0)
SUN = PointLight("Side lamp", (-0.9, -0.9, 0.9), 0.1, (4.0, 2.0, 8.0))


def baked(scene, **settings):
    settings = {"error": 5.0, "isovalues": ISOVALUES, "walls": True, **settings}
    return leaflight.bake(leaflight.bump_box(10), scene, **settings)


def lit_by(scene, factors, exposure=1.0):
    """Returns the scene with its lamps scaled by (r, g, b)."""
    lights = []
    for light, factor in zip(scene.lights, factors):
        name = "radiance" if hasattr(light, "radiance") else "intensity"
        lights.append(replace(light, **{name: tuple(np.multiply(getattr(light, name), factor))}))
    return replace(scene, lights=lights, exposure=exposure * scene.exposure)


@pytest.fixture(scope="module")
def one_lamp():
    return leaflight.cornell_box()


@pytest.fixture(scope="module")
def two_lamps(one_lamp):
    return replace(one_lamp, lights=[*one_lamp.lights, SUN])


@pytest.fixture(scope="module")
def of_one(one_lamp):
    return baked(one_lamp)


@pytest.fixture(scope="module")
def of_two(two_lamps):
    return baked(two_lamps)


def light_of(bake):
    """Returns the radiance of the front of an isosurface and of all walls."""
    points = bake.surface(47.0).vertices
    walls = [bake.walls.radiance(mesh, 47.0) for mesh in range(len(bake.scene.meshes))]
    return points, bake.radiance(points), np.concatenate(walls)


def test_with_one_lamp_it_is_a_new_bake(of_one, one_lamp):
    # A power of two and unchanged displayed colors let the new bake take the same branches.
    name = one_lamp.lights[0].name
    relit = of_one.relit({name: 4})
    new = baked(lit_by(one_lamp, [(4, 4, 4)], exposure=0.25))
    assert scales_exactly(relit) and relit.scene.lights[0].radiance == new.scene.lights[0].radiance
    points, radiance, walls = light_of(relit)
    np.testing.assert_allclose(radiance, new.radiance(points), rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(radiance, 4 * of_one.radiance(points), rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(walls, light_of(new)[2], rtol=1e-4, atol=1e-6)
    for name in ("radiance", "radiance_indirect", "radiance_error"):
        ours, theirs = relit.grid.dense(name), new.grid.dense(name)
        np.testing.assert_allclose(ours, theirs, rtol=1e-3, atol=1e-5 * theirs.max())
    np.testing.assert_array_equal(of_one.grid.atlas()[0].shape, relit.grid.atlas()[0].shape)
    np.testing.assert_allclose(relit.grid.atlas()[0], new.grid.atlas()[0], rtol=1e-3, atol=1e-4)


def test_with_two_lamps_direct_light_is_exact(of_two, two_lamps):
    factors = [(0.25, 1.0, 3.0), (2.0, 0.0, 5.0)]
    relit = of_two.relit({light.name: by for light, by in zip(two_lamps.lights, factors)})
    new = baked(lit_by(two_lamps, factors))
    assert not scales_exactly(relit)
    points = relit.surface(47.0).vertices
    soft = [bake.grid.dense("radiance_indirect") for bake in (relit, new)]
    own, other = (bake.grid.dense("radiance") - s for bake, s in zip((relit, new), soft))
    np.testing.assert_allclose(own, other, rtol=1e-3, atol=1e-4 * other.max())
    assert other.max(axis=(0, 1, 2)).min() > 0.1
    # Indirect light has about the right amount, but not the right distribution.
    means = [s[relit.grid.mask().astype(bool)].mean(axis=0) for s in soft]
    np.testing.assert_allclose(means[0], means[1], rtol=0.1)
    assert np.abs(relit.radiance(points) / of_two.radiance(points) - 1).max() > 0.5


def test_lamps_go_out_and_on(of_two, two_lamps):
    first, second = (light.name for light in two_lamps.lights)
    out = of_two.relit({first: 0, second: 0})
    for light in light_of(out)[1:]:
        assert np.all(light == 0)
    assert out.original is of_two and np.all(out.grid.dense("radiance") == 0)
    # Factors are relative to the original bake, whose texels stay.
    half = of_two.relit({first: 0.5})
    assert half.relit({first: 2}) is of_two
    assert half.relit({first: 0.5, second: 3}).factors == ((0.25,) * 3, (3.0,) * 3)
    assert half.original is of_two and half.id != of_two.id
    assert half.relit({second: (1, 2, 3)}).original is of_two
    # A common factor is exact, except for the light of other emitters.
    assert scales_exactly(of_two.relit({first: 2, second: 2}))
    assert not scales_exactly(half)


def test_other_light_stays(one_lamp):
    world = Environment("world", (0.5, 0.5, 0.5))
    bake = baked(replace(one_lamp, environment=world))
    out = bake.relit({one_lamp.lights[0].name: 0})
    assert not scales_exactly(out)
    points = out.surface(47.0).vertices
    left, before = out.radiance(points).mean(), bake.radiance(points).mean()
    assert 0.01 * before < left < before


def test_files_and_stills_of_it(of_one, one_lamp, tmp_path):
    name = one_lamp.lights[0].name
    relit = of_one.relit({name: (2, 1, 0.5)})
    refused("cannot be saved", relit.save, tmp_path / "relit.vdb")
    assert not list(tmp_path.iterdir())
    refused("continue its original", leaflight.refine, relit)
    of_one.save(tmp_path / "bake.vdb")
    loaded = leaflight.load_bake(tmp_path / "bake.vdb").relit({name: (2, 1, 0.5)})
    points = relit.surface(47.0).vertices
    found, expected = loaded.radiance(points), relit.radiance(points)
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=1e-4)
    bright, dim = tmp_path / "bright.ply", tmp_path / "dim.ply"
    leaflight.export(relit, bright, [47.0])
    leaflight.export(of_one, dim, [47.0])
    assert bright.read_bytes() != dim.read_bytes()


def test_it_says_what_is_wrong(of_one, one_lamp):
    name = one_lamp.lights[0].name
    refused(f'"Moon".*{name}', of_one.relit, {"Moon": 2})
    for wrong in (-1, float("nan"), (1, 2), (1, -2, 3), "bright"):
        refused(f'factor of the lamp "{name}"', of_one.relit, {name: wrong})
