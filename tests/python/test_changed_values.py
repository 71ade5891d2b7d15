# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests a bake shown on cut values, against bakes of the cut."""

import leaflight
import numpy as np
import pytest
from leaflight.bake.changed_values import with_values
from leaflight.volume.cuts import Box
from leaflight.volume.regions import changed
from outcomes import refused

ISOVALUES = (20.0, 100.0)
ISOVALUE = 47.0
WHOLE = leaflight.bump_box(24)
SCENE = leaflight.fit_scene(leaflight.cornell_box(), WHOLE)


def cut(keep="outside", share=0.5):
    """Returns the volume without a turned box at its highest corner."""
    low, high = np.asarray(WHOLE.field().bounds)
    box = Box.between(low + share * (high - low), high + 0.2, keep)
    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(0.1), -np.sin(0.1)], [np.sin(0.1), np.cos(0.1)]]
    return changed(WHOLE, [box.moved(turn)])


def baked(volume, **settings):
    settings = {"error": 8.0, "isovalues": ISOVALUES, "resolution": 24, **settings}
    return leaflight.bake(volume, SCENE, **settings)


@pytest.fixture(scope="module")
def bake():
    return baked(WHOLE, both_sides=True, walls=True)


@pytest.fixture(scope="module")
def truth():
    return baked(cut())


def near_cut(points, distance):
    """Returns True for points of an isosurface of the cut that are not on that of the whole."""
    return abs(WHOLE.field().sample(points) - ISOVALUE) > distance


def test_the_estimate_is_that_of_lit_surfaces_near_the_cut_and_of_the_bake_elsewhere(bake, truth):
    estimate, surface = with_values(bake, [cut()]), truth.surface(ISOVALUE)
    points, fresh = surface.vertices, surface.radiance
    opened = near_cut(points, 20.0)
    assert 0.1 < opened.mean() < 0.5
    found, before = estimate.radiance(points), bake.radiance(points)
    # Some of it is black in the bake.
    assert np.percentile(before[opened].mean(axis=1), 10) < 0.02 * fresh[opened].mean()
    assert 0.6 < found[opened].mean() / fresh[opened].mean() < 1.4
    assert found[opened].mean(axis=1).min() > 0.1 * fresh[opened].mean()
    low, high = np.asarray(WHOLE.field().bounds)
    far = (points < 0.5 * (low + high) - 0.25 * (high - low)).any(axis=1)
    assert far.sum() > 100
    assert abs(found[far].mean() / before[far].mean() - 1) < 0.05
    back = estimate.surface(ISOVALUE, back=True).radiance
    assert np.isfinite(back).all() and back.max() > 0


def test_direct_light_of_the_cut_is_exact_when_it_moves(bake, truth):
    moved = with_values(bake, [cut()]).moved([cut()], SCENE)
    assert moved.walls is not None and moved.is_moved
    surface = truth.surface(ISOVALUE)
    for point in range(len(truth.grid.direct.light_points)):
        codes = moved.grid.direct.codes(point)
        np.testing.assert_array_equal(codes, truth.grid.direct.codes(point))
    found = moved.radiance(surface.vertices)
    error = np.sqrt(((found - surface.radiance) ** 2).mean())
    assert error < 0.15 * surface.radiance.mean()
    assert abs(found.mean() / surface.radiance.mean() - 1) < 0.05
    indirect_alone = with_values(bake, [cut()], direct=False).moved([cut()], SCENE)
    np.testing.assert_array_equal(indirect_alone.radiance(surface.vertices), found)


@pytest.mark.parametrize("isovalue", [22.1, 47.1, 61.1])
def test_light_on_the_edges_of_a_cut_does_not_depend_on_rounding(truth, isovalue):
    points = truth.surface(isovalue).vertices.astype(np.float64)
    light = truth.radiance(points)
    for step in (-1e-7, 1e-7):
        differs = (abs(truth.radiance(points + step) - light) > 1e-3).any(axis=1)
        # A few points lie where the code of a visibility map changes.
        assert differs.mean() < 0.002


def test_a_smaller_volume_has_texels_of_the_same_width(bake):
    inside = cut(keep="inside")
    assert inside.values.size < 0.5 * WHOLE.values.size
    estimate = with_values(bake, [inside])
    assert estimate.grid.resolution == list(inside.values.shape[::-1])
    surface = estimate.surface(ISOVALUE)
    assert surface.radiance.mean(axis=1).min() > 0


@pytest.mark.slow
def test_a_much_larger_volume_has_texels_as_wide_as_voxels():
    whole = leaflight.bump_box(170)
    center, half = np.asarray(whole.field().bounds).mean(axis=0), 10 * whole.spacing[0]
    inside = changed(whole, [Box.between(center - half, center + half, "inside", "open")])
    scene = leaflight.fit_scene(leaflight.cornell_box(), whole)
    bake = leaflight.bake(inside, scene, error=8.0, isovalues=ISOVALUES)
    assert min(bake.grid.resolution) > max(inside.values.shape)
    assert max(bake.grid.map_resolution) > max(inside.values.shape)
    moved = with_values(bake, [whole], direct=False).moved([whole], scene)
    assert moved.grid.resolution == moved.grid.direct.resolution == list(whole.values.shape)


def test_a_removed_cut_is_lit(bake, truth):
    estimate = with_values(truth, [WHOLE])
    points = bake.surface(ISOVALUE).vertices
    opened = points[near_cut(points, -1.0)]
    light = estimate.radiance(opened).mean(axis=1)
    assert light.min() > 0.1 * light.mean()
    assert 0.6 < light.mean() / bake.radiance(opened).mean() < 1.4


def test_equal_values_keep_their_light(bake):
    points = bake.surface(ISOVALUE).vertices
    same = leaflight.Volume(WHOLE.values.copy(), WHOLE.index_to_world)
    found, texels = with_values(bake, [same]).grid, bake.grid.dense("radiance")
    np.testing.assert_array_equal(found.dense("radiance"), texels)
    np.testing.assert_array_equal(found.mask(), bake.grid.mask())
    assert with_values(bake, [WHOLE]).radiance(points) == pytest.approx(bake.radiance(points))


def test_a_bake_from_a_file_has_the_same_estimate(bake, tmp_path):
    bake.save(tmp_path / "bake.vdb")
    reopened = leaflight.load_bake(tmp_path / "bake.vdb")
    for _ in range(2):
        mine, again = (with_values(each, [cut()]).grid for each in (bake, reopened))
        for name in ("radiance", "radiance_indirect", "radiance_back", "radiance_back_indirect"):
            np.testing.assert_array_equal(mine.dense(name), again.dense(name), err_msg=name)
    saved_again = tmp_path / "again.vdb"
    reopened.save(saved_again)
    assert saved_again.stat().st_size == (tmp_path / "bake.vdb").stat().st_size


def test_relit_bakes_are_estimated_with_their_lamps(bake):
    name = bake.scene.lights[0].name
    points = with_values(bake, [cut()]).surface(ISOVALUE).vertices
    bright, dim = (
        with_values(bake.relit({name: factor}), [cut()]).radiance(points) for factor in (1.0, 0.5)
    )
    assert dim == pytest.approx(0.5 * bright, rel=0.01, abs=1e-3)
    relit = with_values(bake.relit({name: 0.5}), [cut()])
    refused("other lamps", lambda: relit.moved([cut()], SCENE))


@pytest.mark.parametrize("moves", [False, True])
def test_colors_of_another_volume_count_once(moves):
    scene = SCENE.colored_by(leaflight.texture_of(WHOLE, "VIRIDIS", (0.0, 200.0)))
    bake = leaflight.bake(WHOLE, scene, error=8.0, isovalues=ISOVALUES, resolution=24)
    now = with_values(bake, [cut(share=0.85)], direct=not moves)
    if moves:
        now = now.moved([cut(share=0.85)], scene)
    low, high = np.asarray(WHOLE.field().bounds)
    points = bake.surface(ISOVALUE).vertices
    points = points[(points < 0.5 * (low + high)).any(axis=1)]
    found, before = now.radiance(points).mean(axis=0), bake.radiance(points).mean(axis=0)
    assert found == pytest.approx(before, rel=0.03)


def test_an_estimate_is_neither_saved_nor_made_of_other_volumes(bake, tmp_path):
    estimate = with_values(bake, [cut()])
    assert estimate.id not in (bake.id, with_values(bake, [cut(share=0.4)]).id)
    refused("cannot be saved", lambda: estimate.save(tmp_path / "estimate.vdb"))
    refused("The bake has 1 volumes, but 2 are given", lambda: with_values(bake, [cut(), cut()]))
    refused("its values have changed since the bake", lambda: bake.moved([cut()], SCENE))
