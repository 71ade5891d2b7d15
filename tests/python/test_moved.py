# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests a bake whose lamps, walls or volume have moved, against bakes of the changed scenes."""

from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight.scene.lights import PointLight
from outcomes import refused

ISOVALUES = (30.0, 70.0)
BOX = leaflight.bump_box(10)
NEW_LAMP = PointLight("Side lamp", (-0.1, -0.4, 1.2), 0.05, (2.0, 1.5, 0.7))


def baked(volume, scene, **settings):
    defaults = {"error": 8.0, "isovalues": ISOVALUES, "walls": True, "resolution": 10}
    return leaflight.bake(volume, scene, **{**defaults, **settings})
    return leaflight.bake(volume, scene, **settings)


@pytest.fixture(scope="module")
def scene():
    return leaflight.fit_scene(leaflight.cornell_box(), BOX)


@pytest.fixture(scope="module")
def bake(scene):
    return baked(BOX, scene)


def with_lamp_moved(scene, by=(0.3, -0.2, -0.1)):
    lamp = scene.lights[0]
    corner = tuple(np.add(lamp.corner, by).tolist())
    return replace(scene, lights=[replace(lamp, corner=corner)])


def with_wall_moved(scene, by=(0.0, 0.0, 0.06)):
    first, *others = scene.meshes
    vertices = (first.vertices + np.float32(by)).astype(np.float32)
    return replace(scene, meshes=[replace(first, vertices=vertices), *others])


def shifted(volume, by=(0.04, 0.0, 0.03)):
    matrix = np.array(volume.index_to_world)
    matrix[:3, 3] += by
    return replace(volume, index_to_world=matrix)


def assert_same_maps(ours, theirs):
    assert ours.grid.direct.resolution == theirs.grid.direct.resolution
    np.testing.assert_array_equal(ours.grid.direct.light_points, theirs.grid.direct.light_points)
    for point in range(len(theirs.grid.direct.light_points)):
        codes = (one.grid.direct.codes(point) for one in (ours, theirs))
        np.testing.assert_array_equal(*codes)


def direct(bake):
    return bake.grid.dense("radiance") - bake.grid.dense("radiance_indirect")


def assert_direct_light_of(ours, theirs):
    """Checks for equal direct light: maps bit by bit, radiance up to rounding."""
    assert_same_maps(ours, theirs)
    most = direct(theirs).max()
    assert most > 0.05
    np.testing.assert_allclose(direct(ours), direct(theirs), rtol=0, atol=1e-5 * most)


def walls_direct(bake):
    return [bake.walls.direct_ways(mesh) for mesh in range(len(bake.scene.meshes))]


def assert_walls_have_direct_light_of(ours, theirs):
    for own, other in zip(walls_direct(ours), walls_direct(theirs)):
        for a, b in zip(own, other):
            assert (a is None) == (b is None)
            if a is not None:
                np.testing.assert_array_equal(a, b)


def test_a_lamp_that_moves_lights_as_in_a_new_bake(bake, scene):
    there = with_lamp_moved(scene)
    ours, theirs = bake.moved(BOX, there), baked(BOX, there)
    assert_direct_light_of(ours, theirs)
    assert_walls_have_direct_light_of(ours, theirs)
    assert np.abs(direct(ours) - direct(bake)).max() > 0.3 * direct(bake).max()
    # Indirect light keeps its distribution, and has about the right amount.
    soft, before = (one.grid.dense("radiance_indirect") for one in (ours, bake))
    lit = before.min(axis=-1) > 0.01
    factors = soft[lit] / before[lit]
    assert len(factors) > 500 and (factors.max(axis=0) / factors.min(axis=0)).max() < 1.001
    means = [one.grid.dense("radiance_indirect").mean(axis=(0, 1, 2)) for one in (ours, theirs)]
    np.testing.assert_allclose(means[0], means[1], rtol=0.2)
    points = ours.surface(47.0).vertices
    near = np.abs(ours.radiance(points) - theirs.radiance(points)).mean()
    far = np.abs(bake.radiance(points) - theirs.radiance(points)).mean()
    assert near < 0.4 * far


def test_lamps_come_and_go(bake, scene):
    larger = replace(scene.lights[0], edge_u=tuple(2 * np.array(scene.lights[0].edge_u)))
    for lamps in ([NEW_LAMP, *scene.lights], [NEW_LAMP], [larger]):
        there = replace(scene, lights=lamps)
        ours = bake.moved(BOX, there, walls=False)
        assert_direct_light_of(ours, baked(BOX, there, walls=False))


def test_the_volume_moves(bake, scene):
    there = shifted(BOX)
    ours, theirs = bake.moved(there, scene), baked(there, scene)
    assert_direct_light_of(ours, theirs)
    # Texels move with the volume.
    now, before = (one.surface(47.0).vertices.mean(axis=0) for one in (ours, bake))
    np.testing.assert_allclose(now, before + (0.04, 0, 0.03), atol=0.005)


def test_walls_move_come_and_go(bake, scene):
    there = with_wall_moved(scene)
    ours, theirs = bake.moved(BOX, there), baked(BOX, there)
    assert_direct_light_of(ours, theirs)
    for number, mesh in enumerate(there.meshes):
        vertices = ours.walls.mesh(number)[0]
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        np.testing.assert_allclose(vertices.min(axis=0), low, atol=1e-4)
        np.testing.assert_allclose(vertices.max(axis=0), high, atol=1e-4)
        for back in (False, True):
            soft = [one.walls.indirect(number, back) for one in (ours, bake)]
            assert (soft[0] > 0).sum() == (soft[1] > 0).sum()
    fewer = replace(scene, meshes=scene.meshes[1:])
    ours = bake.moved(BOX, fewer)
    assert_direct_light_of(ours, baked(BOX, fewer, walls=False))
    assert ours.walls.count == len(fewer.meshes)
    assert (ours.walls.indirect(0, True) > 0).any()
    copied = replace(scene.meshes[0], name="New wall", vertices=0.5 * scene.meshes[0].vertices)
    more = replace(scene, meshes=[copied, *scene.meshes])
    ours = bake.moved(BOX, more)
    assert_same_maps(ours, baked(BOX, more, walls=False))
    assert not ours.walls.indirect(0).any() and ours.walls.indirect(1).any()


PAIR = [BOX, shifted(BOX, (1.4, 0.0, 0.0))]
OF_PAIR = {"isovalues": None, "walls": False, "resolution": 8, "error": 20.0}


def test_back_sides_and_several_volumes(scene):
    both = baked(BOX, scene, both_sides=True, walls=False)
    there = with_lamp_moved(scene)
    ours, theirs = both.moved(BOX, there), baked(BOX, there, both_sides=True, walls=False)
    for point in range(len(theirs.grid.direct.light_points)):
        codes = (one.grid.direct.codes(point, back=True) for one in (ours, theirs))
        np.testing.assert_array_equal(*codes)
    scene = leaflight.fit_scene(leaflight.cornell_box(), PAIR)
    there = with_lamp_moved(scene)
    ours, theirs = baked(PAIR, scene, **OF_PAIR).moved(PAIR, there), baked(PAIR, there, **OF_PAIR)
    for own, other in zip(ours.grids, theirs.grids):
        for point in range(len(other.direct.light_points)):
            np.testing.assert_array_equal(own.direct.codes(point), other.direct.codes(point))


def test_beside_a_mirror_what_is_diffuse_is_lit():
    scene = leaflight.fit_scene(leaflight.cornell_box(), PAIR)
    mirror = replace(scene.isosurfaces[0], name="mirror", scattering="mirror")
    scene = replace(scene, isosurfaces=[scene.isosurfaces[0], mirror])
    there = with_lamp_moved(scene)
    ours = baked(PAIR, scene, **OF_PAIR).moved(PAIR, there)
    assert_same_maps(ours, baked(PAIR, there, **OF_PAIR))
    assert ours.grids[1].direct is None


def test_coarser_maps_come_close(bake, scene):
    there = with_lamp_moved(scene)
    fine = bake.moved(BOX, there, walls=False)
    coarse = bake.moved(BOX, there, quick=True, walls=False)
    assert coarse.grid.direct.resolution == [5, 5, 5] and coarse.walls is None
    assert coarse.id != fine.id
    points = fine.surface(47.0).vertices
    off = np.abs(coarse.radiance(points) - fine.radiance(points))
    assert 0 < off.mean() < 0.1 * fine.radiance(points).mean()


def test_it_is_a_bake_but_for_its_file(bake, scene, tmp_path):
    there = with_lamp_moved(scene)
    ours = bake.moved(BOX, there)
    assert ours.original is bake and len({bake.id, ours.id, baked(BOX, there).id}) == 3
    again = bake.moved(BOX, with_wall_moved(scene)).moved(BOX, there)
    assert again.original is bake and again.id == ours.id
    np.testing.assert_array_equal(again.grid.dense("radiance"), ours.grid.dense("radiance"))
    back = ours.moved(BOX, scene)
    light = [one.grid.dense("radiance") for one in (back, bake)]
    np.testing.assert_allclose(*light, rtol=1e-5, atol=1e-6)
    bake.save(tmp_path / "bake.vdb")
    loaded = leaflight.load_bake(tmp_path / "bake.vdb").moved(BOX, there)
    assert loaded.id == ours.id
    assert_same_maps(loaded, ours)
    refused("cannot be saved", ours.save, tmp_path / "moved.vdb")
    refused("continue its original", leaflight.refine, ours)
    refused("move its original", ours.relit, {scene.lights[0].name: 2})


def test_it_says_what_cannot_move(bake, scene):
    other = leaflight.Volume(BOX.values + 1, BOX.index_to_world, BOX.name)
    mirror = replace(scene, isosurfaces=[replace(scene.isosurfaces[0], scattering="mirror")])
    for volume, changed, settings, what in (
        (other, scene, {}, "values have changed"),
        ([BOX, BOX], scene, {}, "1 volumes, .* 2"),
        (BOX, scene, {"isovalues": (30.0, 60.0)}, "isovalue range has changed"),
        (BOX, mirror, {}, "material"),
    ):
        refused(what, bake.moved, volume, changed, **settings)
    progress = leaflight.Progress()
    progress.cancel()
    with pytest.raises(leaflight.Cancelled):
        bake.moved(BOX, scene, progress=progress)
