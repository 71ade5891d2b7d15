# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions: where cuts lie, how flat they are, and which parts go."""

import argparse
import json
from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight import Progress, Volume
from leaflight._core import contour
from leaflight.volume import regions
from leaflight.volume.regions import Box, Dust, HalfSpace, LargestPart, Part, WithinLabels, sphere
from leaflight_command.region_options import add_region_options
from outcomes import refused

N = 48


def turn(angle, tilt):
    """Returns a rotation matrix (3, 3)."""
    c, s, d, t = np.cos(angle), np.sin(angle), np.cos(tilt), np.sin(tilt)
    about_z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return about_z @ np.array([[1, 0, 0], [0, d, -t], [0, t, d]])


def balls(matrix=None, centers=((0.0, 0.0, 0.0),), radii=(0.8,), dtype=np.float32):
    """Returns a Volume on -1..1 with 1000 at centers, 0 from the radii on."""
    axis = np.linspace(-1, 1, N)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    values = np.zeros((N, N, N))
    for (a, b, c), radius in zip(centers, radii):
        distance = np.sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2)
        values = np.maximum(values, 1000 * (1 - distance / radius))
    own = np.diag([2 / (N - 1)] * 3 + [1.0])
    own[:3, 3] = -1
    return Volume(values.astype(dtype), own if matrix is None else matrix @ own)


def cut(volume, *parts):
    return regions.changed(volume, parts, Progress())


def vertices_of(volume, isovalue):
    found, *_ = contour(volume.field(), isovalue)
    return np.asarray(found, np.float64)


# World coordinates of tests: turned, scaled along each axis, and sheared.
MATRICES = {
    "cube": np.eye(4),
    "sheared": np.array([[3, 0.2, 0, 5], [0, 1, 0.3, -2], [0.1, 0, 0.6, 1], [0, 0, 0, 1.0]]),
}


@pytest.mark.parametrize("dtype", [np.float32, np.int16, np.uint8])
@pytest.mark.parametrize("matrix", MATRICES.values(), ids=MATRICES)
def test_turned_caps_are_flat_and_within_a_voxel(matrix, dtype):
    whole = balls(matrix, dtype=np.float32 if dtype is np.uint8 else dtype)
    if dtype is np.uint8:
        whole = Volume((whole.values / 4).astype(dtype), whole.index_to_world)
    normal = turn(0.4, 0.7) @ [1.0, 0.0, 0.0]
    point = (matrix @ [0.1, 0.05, -0.1, 1.0])[:3]
    halved = cut(whole, HalfSpace(tuple(point), tuple(normal)))
    # Length of a voxel along the normal.
    voxel = np.linalg.norm(normal @ whole.index_to_world[:3, :3])
    low, high = whole.data_range()
    for share in (0.2, 0.5, 0.8):
        isovalue = low + share * (high - low)
        vertices, normals, *_ = contour(halved.field(), isovalue)
        vertices, normals = np.asarray(vertices, np.float64), np.asarray(normals)
        inside = (vertices - point) @ -normal / voxel
        is_cap = whole.field().sample(vertices) > isovalue + 0.1 * (high - low)
        assert is_cap.sum() > 10
        # The cap is a plane at this share of a voxel.
        assert abs(inside[is_cap] - share).max() < 0.01
        outward = normal if np.linalg.det(matrix) > 0 else -normal
        assert (normals[is_cap] @ outward).min() > 0.9999
        assert inside.min() > -0.01


def test_values_inside_keep_their_bits_and_types():
    whole = balls(dtype=np.int16)
    halved = cut(whole, HalfSpace((0, 0, 0), (0, 0, 1)))
    assert halved.values.dtype == np.int16
    assert halved.data_range()[0] == 0
    inside = int(np.ceil((N - 1) / 2)) - 1
    assert (halved.values[:inside] == whole.values[:inside]).all()
    assert len(halved.values) < len(whole.values)
    box = Box(tuple(map(tuple, np.diag([0.5, 0.5, 0.5, 1.0]))))
    assert cut(whole, box).values.shape == (28,) * 3


def test_default_isovalues_ignore_what_closes_a_cut():
    whole = balls()
    halved = cut(whole, HalfSpace((0, 0, 0), (0.2, 0.1, 1)))
    assert halved.field().range[0] < whole.field().range[0]
    assert leaflight.default_isovalue_range(halved)[0] >= 0
    assert halved.distribution.count < whole.distribution.count
    low, _ = halved.distribution.histogram(10)[1][[0, -1]]
    assert low == 0
    capped = halved.capped()
    assert capped.data_range() == halved.data_range()
    assert capped.field().range[0] == halved.field().range[0]


@pytest.mark.parametrize("matrix", MATRICES.values(), ids=MATRICES)
def test_a_capped_cut_shows_a_slice(matrix):
    whole = balls(matrix)
    point, normal = (matrix @ [0.1, 0.05, -0.1, 1.0])[:3], turn(0.4, 0.7) @ [1.0, 0.0, 0.0]
    half = HalfSpace(tuple(point), tuple(normal))
    slices = leaflight.slices_of(whole, [LargestPart(300), half, regions.record_of(half)])
    assert slices.values.size < whole.values.size
    vertices = vertices_of(cut(whole, half), 200.0)
    uncut = whole.field().sample(vertices)
    on_cut = uncut > 230
    assert on_cut.sum() > 100
    gray = leaflight.texture_of(slices, [(0.0, (0, 0, 0)), (1000.0, (1, 1, 1))])
    np.testing.assert_allclose(gray.at(vertices)[on_cut, 0], uncut[on_cut] / 1000, atol=1e-5)
    # Elsewhere the albedo counts.
    depth = (vertices - point) @ -normal / np.linalg.norm(normal @ whole.index_to_world[:3, :3])
    assert (gray.at(vertices)[depth > 4] == 1).all() and (depth > 4).any()


def test_slices_need_a_capped_cut():
    opened = HalfSpace((0, 0, 0), (0, 0, 1), cut="open")
    refused("volume: no capped cut", leaflight.slices_of, balls(), [opened, LargestPart(300)])
    outside = HalfSpace((0, 0, 9), (0, 0, 1))
    refused("its cuts lie outside", leaflight.slices_of, balls(), [outside])


def test_an_open_cut_has_no_values_beyond_it():
    whole = balls()
    opened = cut(whole, HalfSpace((0, 0, 0), (0, 0, 1), cut="open"))
    reach = vertices_of(opened, 300.0)[:, 2].max()
    assert 0 < reach < 2 * 2 / (N - 1)
    known = np.isfinite(opened.values)
    assert (opened.values[known] == whole.values[: len(opened.values)][known]).all()


@pytest.mark.parametrize("dtype", [np.float32, np.uint8])
@pytest.mark.parametrize("matrix", MATRICES.values(), ids=MATRICES)
def test_an_open_box_along_the_voxels_is_a_crop(matrix, dtype):
    values = (balls().values / 4).astype(dtype)
    whole = Volume(values, matrix @ balls().index_to_world)
    box = Box.between([3.5, 10.0, -5.0], [40.0, 30.2, 20.0], cut="open").moved(whole.index_to_world)
    cropped = cut(whole, box)
    np.testing.assert_array_equal(cropped.values, whole.values[:21, 10:32, 3:41])
    assert cropped.values.dtype == dtype
    assert not np.shares_memory(cropped.values, whole.values)
    corner = whole.index_to_world @ [3, 10, 0, 1]
    np.testing.assert_allclose(cropped.index_to_world @ [0, 0, 0, 1], corner, atol=1e-12)
    turned = Box(box.moved(np.array(turned_about_z(0.01))).matrix, cut="open")
    assert np.isnan(cut(whole, turned).values).any()
    far = Box.between([60, 0, 0], [70, 9, 9], cut="open").moved(whole.index_to_world)
    refused("the box leaves nothing", cut, whole, far)


def turned_about_z(angle):
    matrix = np.eye(4)
    matrix[:3, :3] = turn(angle, 0.0)
    return matrix


def test_a_sphere_and_a_box_remove_their_inside_or_outside():
    whole = balls()
    drilled = vertices_of(cut(whole, sphere((0.4, 0, 0), 0.3)), 500.0)
    assert np.linalg.norm(drilled - [0.4, 0, 0], axis=1).min() > 0.3 - 1e-3
    alone = vertices_of(cut(whole, sphere((0.4, 0, 0), 0.3, keep="inside")), 100.0)
    assert np.linalg.norm(alone - [0.4, 0, 0], axis=1).max() < 0.3 + 1e-3
    matrix = np.eye(4)
    matrix[:3, :3] = turn(0.5, 0.3) * 0.3
    rows = tuple(map(tuple, matrix.tolist()))
    corner = vertices_of(cut(whole, Box(rows)), 100.0) @ np.linalg.inv(matrix[:3, :3]).T
    assert 0.9 < abs(corner).max() < 1.001
    hollow = vertices_of(cut(whole, Box(rows, "outside")), 500.0) @ np.linalg.inv(matrix[:3, :3]).T
    assert abs(hollow).max(axis=1).min() > 0.999


def two_balls(dtype=np.float32):
    return balls(centers=((-0.4, 0, 0), (0.7, 0, 0)), radii=(0.5, 0.25), dtype=dtype)


@pytest.mark.parametrize(
    "region",
    [LargestPart(300), Part((0.7, 0, 0.1), 300), Part((-0.4, 0, 0), 300, "inside"), Dust(400, 300)],
    ids=lambda region: type(region).__name__,
)
@pytest.mark.parametrize("dtype", [np.float32, np.int16])
def test_a_part_goes_without_a_shell(region, dtype):
    whole = two_balls(dtype)
    left = cut(whole, region)
    assert left.values.dtype == dtype and left.cuts is None
    for isovalue in (50.0, 300.0, 600.0):
        assert vertices_of(whole, isovalue)[:, 0].max() > 0.5
        assert vertices_of(left, isovalue)[:, 0].max() < 0.3
    kept = vertices_of(left, 300.0)
    before = vertices_of(whole, 300.0)
    np.testing.assert_array_equal(kept, before[before[:, 0] < 0.3])


def test_regions_follow_one_another():
    left = cut(two_balls(), LargestPart(300), HalfSpace((-0.4, 0, 0), (1, 0, 0)), Dust(2, 300))
    assert vertices_of(left, 300.0)[:, 0].max() < -0.36
    assert left.source == ", largest part, half space, dust"


def test_a_thousand_parts():
    values = np.zeros((40, 40, 40), np.uint8)
    values[::4, ::4, ::4] = 100
    values[1:4, 1:4, 1:4] = 200
    left = cut(Volume(values), Dust(2, 50))
    assert np.count_nonzero(left.values) == 27


def test_a_region_outside_changes_nothing():
    whole = balls()
    left = cut(whole, sphere((9, 0, 0), 1), Box(tuple(map(tuple, np.diag([9.0, 9, 9, 1])))))
    np.testing.assert_array_equal(left.values, whole.values)
    np.testing.assert_array_equal(left.index_to_world, whole.index_to_world)


@pytest.mark.parametrize(
    ("record", "message"),
    [
        ({"kind": "disk"}, "is no region"),
        ("largest", "is no region"),
        ({"kind": "ball", "radius": 1}, "is incomplete or has another field: give matrix, keep"),
        ({"kind": "ball", "matrix": [[0, 0], [1, 1]]}, "give 16 numbers"),
        ({"kind": "dust", "voxels": 0}, "is empty: its voxels"),
        ({"kind": "dust", "voxels": "many"}, "give a number"),
        ({"kind": "half_space", "point": [0, 0, 0], "normal": [0, 0, 0]}, "is empty: its normal"),
        ({"kind": "box", "matrix": np.zeros((4, 4)).tolist()}, "is empty: its matrix"),
        ({"kind": "box", "matrix": np.eye(4).tolist(), "keep": "all"}, "choose inside or outside"),
        ({"kind": "half_space", "point": [0, 0, float("nan")], "normal": [0, 0, 1]}, "3 numbers"),
    ],
)
def test_wrong_records_are_named(record, message):
    refused(message, regions.region_of, record)


def test_a_cut_that_leaves_nothing_is_named():
    for region, words in (
        (HalfSpace((0, 0, -5), (0, 0, 1)), "the half space leaves nothing of the volume"),
        (Part((0.9, 0.9, 0.9), 500), "nothing at or above the isovalue 500 at"),
        (LargestPart(5000), "nothing at or above the isovalue 5000"),
    ):
        refused(words, cut, balls(), region)


def test_records_are_json():
    for region in (Box(tuple(map(tuple, np.eye(4).tolist()))), Dust(3), Part((1.0, 2.0, 3.0), 4.0)):
        record = json.loads(json.dumps(regions.record_of(region)))
        assert regions.region_of(record) == region


def test_a_bake_keeps_its_regions(tmp_path):
    halved = cut(balls(), HalfSpace((0, 0, 0), (0.2, 0.1, 1)))
    bake = leaflight.bake(halved, resolution=16, error=20)
    bake.save(tmp_path / "halved.vdb")
    again = leaflight.load_bake(tmp_path / "halved.vdb")
    assert again.volume.cuts == halved.cuts
    assert again.volume.data_range() == halved.data_range()
    assert again.id == bake.id
    points = vertices_of(halved, 300)
    np.testing.assert_array_equal(again.radiance(points), bake.radiance(points))


@pytest.mark.parametrize("resolution", [N, 32])
def test_a_cap_has_the_light_of_its_own_isosurface(resolution):
    """Cuts a corner out of a box, whose wall lights the floor. Isosurfaces above 300 lack it."""
    axis = np.linspace(-1, 1, N)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    values = np.where(x < 0, 300, 1000).astype(np.float32)
    values[np.maximum(np.maximum(abs(x), abs(y)), abs(z)) > 0.9] = 0
    corner = np.eye(4)
    corner[:3, 3] = 0.97, 0, 1
    box = Box(tuple(map(tuple, corner.tolist())), "outside", "capped")
    bake = leaflight.bake(cut(replace(balls(), values=values), box), resolution=resolution)
    for isovalue in (100, 200, 500, 800):
        points = vertices_of(bake.volume, isovalue)
        x, y, z = points.T
        points = points[(x > 0.05) & (x < 0.45) & (abs(y) < 0.4) & (abs(z) < 0.06)][::8]
        expected = bake.reference(points, isovalue, 512)[0].mean()
        assert bake.radiance(points).mean() == pytest.approx(expected, rel=0.03)


def test_reading_takes_regions(tmp_path):
    path = tmp_path / "balls.npy"
    np.save(path, two_balls().values)
    record = {"kind": "largest_part", "isovalue": 300}
    read = leaflight.read_volume(path, regions=[record])
    assert read.values[24, 24, 40] == 0
    high = {**record, "isovalue": 2000}
    refused(r"balls\.npy: There is nothing at", leaflight.read_volume, path, regions=[high])


def half_labels(step=1):
    """Returns labels on -1..1: 1 is a ball of radius 0.6, 2 is the rest of x > 0."""
    axis = np.linspace(-1, 1, N)[::step]
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    labels = np.where(x**2 + y**2 + z**2 < 0.36, 1, 2 * (x > 0.0)).astype(np.uint8)
    matrix = np.diag([2 * step / (N - 1)] * 3 + [1.0])
    matrix[:3, 3] = -1
    return Volume(labels, matrix, name="halves")


def full(matrix=None):
    """Returns a Volume on -1..1 of 100, with 20 at its border."""
    volume = balls(matrix)
    values = np.full((N, N, N), 20, np.uint8)
    values[1:-1, 1:-1, 1:-1] = 100
    return Volume(values, volume.index_to_world)


@pytest.mark.parametrize("step", [1, 2])
def test_a_mask_has_the_smooth_boundary_of_its_labels(step):
    left = cut(full(), WithinLabels(half_labels(step), (1,)))
    # Half of the values is on the boundary, and others are within two voxels of the labels.
    for isovalue, tolerance in ((60.0, 0.5), (25.0, 2.0), (95.0, 2.0)):
        radii = np.linalg.norm(vertices_of(left, isovalue), axis=1)
        assert np.abs(radii - 0.6).max() < tolerance * step * 2 / (N - 1)
    assert left.data_range() == (20.0, 100.0)
    assert left.source == ", within labels" and max(left.values.shape) < N


def test_a_mask_is_placed_by_both_coordinates():
    scan, meters = MATRICES["sheared"], np.diag([0.001, 0.001, 0.001, 1.0])
    scan_volume = replace(full(scan), unit="mm")
    labels = half_labels()
    labels = replace(labels, index_to_world=meters @ scan @ labels.index_to_world, unit="m")
    left = cut(scan_volume, WithinLabels(labels, (1,)))
    expected = cut(full(), WithinLabels(half_labels(), (1,)))
    np.testing.assert_allclose(left.values, expected.values, atol=1e-3)
    assert vertices_of(cut(full(), WithinLabels(half_labels())), 60.0)[:, 0].max() > 0.9


def test_missing_values_and_cuts_stay_under_a_mask():
    values = np.float32(full().values)
    values[24, 24, 24] = np.nan
    volume = Volume(values, full().index_to_world)
    halved = cut(volume, HalfSpace((0, 0, 0), (1, 0, 0)), WithinLabels(half_labels(), (1,)))
    assert np.isnan(halved.values).sum() == 1
    found = vertices_of(halved, 60.0)
    assert found[:, 0].max() < 2 / N and found[:, 0].min() < -0.55


def test_wrong_masks_are_named(tmp_path):
    far = half_labels()
    far = replace(far, index_to_world=half_labels().index_to_world + 9 * np.eye(4, k=3))
    for region, message in (
        (WithinLabels(half_labels(), (1, 7)), "^halves: .* no label 7: choose among 1, 2"),
        (WithinLabels(far), "nothing of the volume is within the labels of halves"),
        (WithinLabels(balls()), "labels"),
        (WithinLabels(half_labels(), (1.5,)), "no whole numbers above 0"),
        (WithinLabels("labels.nrrd"), "read the label map first"),
    ):
        refused(message, cut, full(), region)


def test_readers_and_the_command_take_a_mask(tmp_path):
    np.save(tmp_path / "scan.npy", full().values)
    np.save(tmp_path / "labels.npy", half_labels().values)
    paths = [str(tmp_path / name) for name in ("scan.npy", "labels.npy")]
    labels = WithinLabels(Volume(half_labels().values), (1,))
    expected = cut(Volume(full().values), labels).values
    record = {"kind": "within_labels", "label_map": paths[1], "labels": [1]}
    read = leaflight.read_volume(paths[0], regions=[record])
    np.testing.assert_array_equal(read.values, expected)
    parser = argparse.ArgumentParser()
    add_region_options(parser)
    found = parser.parse_args(["--within", f"{paths[1]}:1", "--within", paths[1]]).regions
    assert found == [record, {**record, "labels": []}]
    absent = WithinLabels("nowhere.nrrd")
    refused("^nowhere.nrrd: there is no", leaflight.read_volume, paths[0], regions=[absent])


def test_the_command_line_removes_a_sphere():
    parser = argparse.ArgumentParser()
    add_region_options(parser)
    (record,) = parser.parse_args(["--remove-sphere", "0.4", "0", "-0.1", "0.3"]).regions
    assert regions.region_of(record) == sphere((0.4, 0, -0.1), 0.3)
