# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the built-in volume and the default isovalues."""

import leaflight
import numpy as np
import pytest
from leaflight import Volume, default_isovalue, default_isovalue_range
from leaflight.volume.first_isovalue import inner_isovalue
from outcomes import refused


def volume(values):
    return Volume(np.asarray(values, dtype=np.float32), np.eye(4), "test")


def test_bump_box_fills_the_unit_cube():
    box = leaflight.bump_box(30)
    assert box.values.shape == (30, 30, 30)
    np.testing.assert_allclose(box.field().range, (0, 255), atol=1e-3)
    np.testing.assert_allclose(box.field().bounds, [[0, 0, 0], [1, 1, 1]], atol=1e-6)
    assert box.values[:, -1, :].mean() > box.values[:, 0, :].mean() + 40


def test_placed_volumes_share_their_fields():
    box = leaflight.bump_box(20)
    there = np.diag([2.0, 3.0, 4.0, 1.0]) @ box.index_to_world
    placed = box.placed(there, unit="mm").placed(there)
    assert placed.unit == "mm" and placed.distribution is box.distribution
    fresh = Volume(box.values, there).field()
    point = np.array([[0.4, 1.1, 2.3]])
    assert placed.field().sample(point) == fresh.sample(point)
    np.testing.assert_array_equal(placed.field().bounds, fresh.bounds)
    np.testing.assert_allclose(box.field().bounds, [[0, 0, 0], [1, 1, 1]], atol=1e-6)
    flat = box.placed(np.diag([1.0, 1.0, 0.0, 1.0]))
    refused("cannot be inverted", flat.field)


def test_bump_box_has_a_least_size():
    refused("nodes per side", leaflight.bump_box, 1)


def test_range_leaves_out_background_and_outliers():
    values = np.zeros(30**3)
    values[: 30**2 * 10] = np.random.default_rng(2).normal(100, 5, 9000)
    values[0] = 1000
    lo, hi = default_isovalue_range(volume(values.reshape(30, 30, 30)))
    assert 80 < lo < 95 and 105 < hi < 120


def test_isovalues_of_integer_data_are_half_integers():
    values = np.random.default_rng(3).integers(0, 200, (12, 12, 12))
    for isovalue in (*default_isovalue_range(volume(values)), default_isovalue(volume(values))):
        assert isovalue % 1 == 0.5


def test_isovalue_lies_in_the_range():
    rng = np.random.default_rng(4)
    for values in (
        rng.normal(size=(5, 6, 7)),
        rng.integers(0, 2, (5, 6, 7)),
        np.where(rng.random((9, 9, 9)) < 0.999, -1000, 7),
        np.where(rng.random((9, 9, 9)) < 0.3, np.nan, rng.random((9, 9, 9))),
    ):
        values = np.array(values, dtype=np.float32)
        values.flat[:2] = (np.nanmin(values) - 1, np.nanmax(values) + 1)
        test = volume(values)
        lo, hi = default_isovalue_range(test)
        low, high = test.field().range
        assert low <= lo < default_isovalue(test) < hi <= high


def test_colin27(colin27):
    brain = leaflight.read_volume(colin27)
    lo, hi = default_isovalue_range(brain)
    # The range must include the isovalues of the thesis.
    assert lo < 24.5 and 150.5 < hi
    assert 40 < default_isovalue(brain) < 60


def test_isovalue_parts_the_object_from_noisy_air():
    rng = np.random.default_rng(5)
    values = rng.normal(390, 20, (20, 20, 20))
    values[5:15, 5:15, 5:15] = rng.normal(1000, 50, (10, 10, 10))
    assert 450 < default_isovalue(volume(values)) < 900


def test_the_next_isovalue_is_inside():
    """Checks bone in skin in air; bone has no further material inside."""
    rng = np.random.default_rng(7)
    values = rng.normal(-1000, 10, (24, 24, 24))
    values[4:20, 4:20, 4:20] = rng.normal(40, 20, (16, 16, 16))
    values[9:15, 9:15, 9:15] = rng.normal(900, 50, (6, 6, 6))
    values[12, 12, 12] = 1300.0
    head = volume(np.float32(values))
    assert 150 < inner_isovalue(head, -300.0) < 750
    assert inner_isovalue(head, 1299.0) is None


def test_values_are_not_copied():
    values = np.random.default_rng(6).random((5, 6, 7)).astype(np.float32)
    field = volume(values).field()
    assert np.shares_memory(field.values, values)
    assert field.dims == [7, 6, 5]
    # The field must keep the values alive.
    del values
    assert np.isfinite(field.values).all()


MATRIX = np.array([[-2.0, 0, 0, 90], [0, 2.5, 0, -126], [0, 0.5, 3.0, -72], [0, 0, 0, 1]])


def test_coarser_voxels_fill_the_same_domain():
    index_to_world = np.array([[0, 2, 0, 5], [1, 0, 0, 6], [0, 0, -3, 7], [0, 0, 0, 1.0]])
    z, y, x = np.mgrid[:6, :9, :4].astype(np.float32)
    fine = Volume(x - 2 * y + 7 * z, index_to_world, "linear")
    coarser = fine.coarser()
    assert coarser.values.shape == (4, 5, 3) and coarser is fine.coarser()
    k, j, i = np.mgrid[:4, :5, :3]
    nodes = np.stack([i, j, k, np.ones_like(i)], axis=-1).reshape(-1, 4)
    points = (nodes @ coarser.index_to_world.T)[:, :3]
    np.testing.assert_allclose(fine.field().sample(points), coarser.values.ravel(), atol=1e-5)
    np.testing.assert_allclose(fine.field().bounds, coarser.field().bounds)
    assert coarser.coarser().coarser().values.shape == (2, 2, 2)


def test_capped_keeps_every_voxel_in_its_place():
    values = np.random.default_rng(7).random((5, 6, 7)).astype(np.float32)
    test = Volume(values, MATRIX, "test")
    capped = test.capped()
    np.testing.assert_array_equal(capped.values[1:-1, 1:-1, 1:-1], values)
    np.testing.assert_allclose(
        capped.index_to_world @ [1, 1, 1, 1], test.index_to_world @ [0, 0, 0, 1]
    )
    x, y, z = capped.values[:, 2, 2], capped.values[2, :, 2], capped.values[2, 2]
    for line in (x, y, z):
        assert line[0] == line[-1] < values.min() - (values.max() - values.min())
    assert np.shares_memory(capped.data(), capped.values)
    np.testing.assert_array_equal(capped.data(), values)


def test_caps_lie_flat_just_beyond_the_border():
    values = np.random.default_rng(8).random((8, 9, 10)).astype(np.float32) + 1
    capped = volume(values).capped()
    for isovalue in (1.05, 1.5, 1.95):
        vertices, normals, triangles = leaflight._core.contour(capped.field(), isovalue)
        beyond = np.maximum(-vertices, vertices - [9, 8, 7]).max(axis=1)
        assert 0 < beyond.max() < 1 / 3
        # The mesh is closed: every edge belongs to two triangles, or to four where noise touches
        # itself.
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] % 2 == 0).all()


def test_capping_twice_is_capping_once():
    capped = leaflight.bump_box(9).capped()
    assert capped.capped() is capped


def test_what_is_closed_needs_no_cap():
    values = np.zeros((5, 5, 5))
    values[1:4, 1:4, 1:4] = np.random.default_rng(9).integers(0, 9, (3, 3, 3))
    closed = volume(values)
    assert closed.capped() is closed and closed.data() is closed.values


def test_missing_data_at_the_border_stay_missing():
    values = np.random.default_rng(10).random((5, 5, 5))
    values[0, 2, 2] = np.nan
    capped = volume(values).capped()
    assert np.isnan(capped.values).sum() == 1 and np.isnan(capped.values[1, 3, 3])
    assert capped.field().masked


def test_isovalues_to_begin_with_do_not_see_the_cap(colin27):
    for test in (leaflight.bump_box(12), leaflight.read_volume(colin27)):
        assert default_isovalue_range(test.capped()) == default_isovalue_range(test)
        assert default_isovalue(test.capped()) == default_isovalue(test)
        assert test.capped().data_range() == pytest.approx(test.field().range)


def test_too_large_values_cannot_be_capped():
    values = np.random.default_rng(11).random((3, 3, 3)) * 9e37 - 3.3e38
    refused("test: .*capped", volume(values).capped)


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.uint16, np.float32])
def test_distribution_is_that_of_the_sorted_values(kind):
    rng = np.random.default_rng(5)
    values = (1000 * rng.standard_normal((7, 8, 9))).astype(kind)
    values[2:4] = values[0, 0, 0]
    if kind is np.float32:
        values[1], values[5, :3] = np.nan, -0.0
    test = volume(values)
    known = np.sort(values[np.isfinite(values)]) if kind is np.float32 else np.sort(values.ravel())
    found = test.distribution
    assert found.count == known.size
    assert np.array_equal(found.at(range(known.size)), known)
    low, common = known[0], values[0, 0, 0]
    left = known[(known != low) & (known != common)]
    assert np.array_equal(found.at(range(left.size), [low, common]), left)
    assert found.voxels_of(common) == np.count_nonzero(known == common)
    counts, edges = found.histogram(50)
    wanted, wanted_edges = np.histogram(known.astype(np.float32), 50)
    assert np.array_equal(counts, wanted) and np.array_equal(edges, wanted_edges)
    assert found.are_whole() == (kind is not np.float32)


def test_whole_numbers_but_for_the_background():
    values = np.arange(64, dtype=np.float32).reshape(4, 4, 4)
    values[0] = -0.5
    found = volume(values).distribution
    assert not found.are_whole() and found.are_whole(without=[-0.5])


def test_coarse_vertices_stay_on_their_side_of_a_thin_shell():
    """Checks vertices that would move to the shell's other, dark side along the gradient."""
    k, j, i = np.mgrid[:49, :49, :49]
    distance = np.sqrt((i - 24.0) ** 2 + (j - 24.0) ** 2 + (k - 24.0) ** 2)
    head = volume(np.interp(distance, [15.5, 16.5, 19.5, 20.5], [0.45, 1, 1, 0]))
    field, core = head.field(), leaflight._core
    vertices, normals, _ = core.contour(head.coarser().coarser().field(), 0.5)
    is_outside = np.einsum("ij,ij->i", vertices - 24, normals) > 0

    def misses(points):
        return np.abs(np.linalg.norm(points - 24, axis=1) - np.where(is_outside, 20, 15.6))

    assert misses(core.project_along(field, vertices, normals, 0.5, 8.0)).max() < 1
    assert misses(core.project_to_isosurface(field, vertices, 0.5)).max() > 2
    far, up = np.array([[24.0, 24, 24]]), np.array([[0.0, 0, 1]])
    np.testing.assert_array_equal(core.project_along(field, far, up, 0.5, 8.0), far)
    refused("directions", core.project_along, field, vertices, normals[1:], 0.5, 8.0)
