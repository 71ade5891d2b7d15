# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the first shown isovalue of masks, labels and values of both signs, and its lit side."""

import warnings

import leaflight
import numpy as np
import pytest
import vtk_files
from leaflight import Volume, default_isovalue, default_isovalue_range
from leaflight.bake.both_sides import why_both_sides
from leaflight.bake.settings import ChosenSetting
from leaflight.volume.backs import back_shares
from leaflight.volume.first_isovalue import inner_isovalue

N = 32
Z, Y, X = np.mgrid[:N, :N, :N] - 0.5 * (N - 1)
R = np.sqrt(X**2 + Y**2 + Z**2)
BALL = R < 9


def volume(values):
    values = np.asarray(values)
    return Volume(values if values.dtype != np.float64 else values.astype(np.float32), name="v")


def mesh_volume(field, isovalue):
    vertices, _, triangles = leaflight._core.contour(field, isovalue)
    a, b, c = np.moveaxis(vertices[triangles].astype(np.float64), 1, 0)
    return abs(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize(
    "low, high, kind",
    [
        (0, 1, bool),
        (0, 1, np.uint8),
        (0, 1, np.float32),
        (0, 255, np.uint8),
        (0, 257, np.uint16),
        (-1, 1, np.int8),
        (-32768, 32767, np.int16),
        (1000, 1001, np.float32),
        (0.25, 0.75, np.float32),
    ],
)
def test_a_mask_is_shown_half_way_between_its_values(low, high, kind):
    mask = volume(np.where(BALL, high, low).astype(kind))
    assert default_isovalue(mask) == 0.5 * (low + high)
    assert default_isovalue_range(mask) == (low, high)
    assert inner_isovalue(mask, 0.5 * (low + high)) is None
    # The isosurface must enclose the mask's voxels; the first step of a histogram would enlarge a
    # ball by half a voxel.
    shown = mesh_volume(mask.field(), default_isovalue(mask))
    assert shown == pytest.approx(BALL.sum(), rel=0.02)


def labels_of(count, names):
    """Returns pieces of a ball, each with one of the labels, in a background of 0."""
    rng = np.random.default_rng(3)
    middles = rng.uniform(-12, 12, (count, 3))
    near = np.stack([(X - x) ** 2 + (Y - y) ** 2 + (Z - z) ** 2 for x, y, z in middles])
    return np.where(R < 14, np.asarray(names)[near.argmin(axis=0) % len(names)], 0)


@pytest.mark.parametrize("kind", [np.int32, np.float32, np.float64])
@pytest.mark.parametrize(
    "values, isovalue",
    [
        ((R < 14) * 1 + (R < 10) + (R < 6), 0.5),
        (labels_of(40, [2, 3, 41, 42, 1001, 2035]), 1.0),
        (labels_of(90, range(7, 4000, 90)), 3.5),
        # Brain tissues without a background; voxels without a label are -1.
        ((R < 10) + 1, 1.5),
        (np.where(X < -12, -1, (R < 10) * 1 + (R < 6)), 0.5),
        (np.where(R < 10, 0, -1) - (R < 6) * 0 - (R > 13) * 1, -0.5),
    ],
)
def test_labels_are_shown_beside_their_background_and_all_can_be_reached(kind, values, isovalue):
    labels = volume(values.astype(kind))
    assert labels.distribution.are_labels
    assert default_isovalue(labels) == isovalue
    assert default_isovalue_range(labels) == (values.min(), values.max())


def test_labels_within_missing_data():
    values = np.where(R < 14, 1.0 + (R < 10) + (R < 6), np.nan)
    assert volume(values).distribution.are_labels
    assert default_isovalue(volume(values)) == 1.5


def noisy(low, high, sigma, kind):
    rng = np.random.default_rng(4)
    limits = np.iinfo(kind)
    values = np.where(BALL, high, low) + rng.normal(0, sigma, R.shape)
    return np.rint(values).clip(limits.min, limits.max).astype(kind)


MEASURED = {
    "a mask with soft edges": (255 * np.clip(5.0 - 0.5 * R, 0, 1)).astype(np.uint8),
    "few steps of a soft edge": 60 * np.rint(4 * np.clip(5.0 - 0.5 * R, 0, 1)).astype(np.uint8),
    "16 noisy steps": noisy(4, 11, 1.5, np.uint8).clip(0, 15),
    "a noisy scan": noisy(40, 180, 12, np.uint8),
    "a noisy scan in floats": noisy(40, 180, 12, np.uint8).astype(np.float32),
    "whole distances from a cube": np.rint(np.max(np.abs([X, Y, Z]) + 0.5, axis=0)).astype(int),
    "saturated vessels": (600 * np.exp(-(X**2 + Y**2) / 20)).clip(0, 255).astype(np.uint8),
}


@pytest.mark.parametrize("name", MEASURED)
def test_measurements_are_no_labels(name):
    values = MEASURED[name]
    measured = volume(values)
    assert not measured.distribution.are_labels
    lo, hi = default_isovalue_range(measured)
    isovalue = default_isovalue(measured)
    assert lo < isovalue < hi
    levels = np.unique(values)
    if len(levels) <= 32:
        assert isovalue in 0.5 * (levels[1:] + levels[:-1]).astype(np.float64)


@pytest.mark.parametrize("first", [0, 1_000_000, 8_000_000])
def test_values_that_span_few_steps_of_single_precision(first):
    labels = volume(np.float32(first + (R < 14) + (R < 10) + (R < 6)))
    assert default_isovalue(labels) == first + 0.5
    rng = np.random.default_rng(5)
    noise = volume(np.float32(first + np.where(BALL, 200, 50) + rng.normal(0, 9, R.shape)))
    assert first + 80 < default_isovalue(noise) < first + 170
    counts, edges = noise.distribution.histogram(100)
    assert counts.sum() == R.size and (np.diff(edges) > 0).all()


ORBITAL = X * np.exp(-R / 3)
SIGNS = {
    "orbital": (ORBITAL, "its isosurfaces below 0"),
    "orbital turned round": (-ORBITAL, "its isosurfaces below 0"),
    "t-map": (
        4 * np.exp(-((X - 6) ** 2 + Y**2 + Z**2) / 9)
        - 3 * np.exp(-((X + 6) ** 2 + Y**2 + Z**2) / 9),
        "its isosurfaces below 0",
    ),
    "level set": (R - 8, "its isosurfaces are"),
    "truncated level set": (np.clip(R - 8, -2, 2), "its isosurfaces are"),
    "level set of a box": (np.max(np.abs([X / 2, Y, Z]), axis=0) - 5, "its isosurfaces are"),
    "potential well": (-5 * np.exp(-(R**2) / 40) + 0.2, "its isosurfaces are"),
    "inverse mask": (1.0 - BALL, "its isosurfaces are"),
    "bubbles in noise": (
        np.where(BALL, 0, 200) + np.random.default_rng(6).normal(0, 5, R.shape),
        "its isosurfaces are",
    ),
    "level set, inside high": (8 - R, ""),
    "density": (np.exp(-R / 4), ""),
    "density in noise": (np.exp(-R / 4) + np.random.default_rng(7).normal(0, 0.02, R.shape), ""),
    "computed tomography": (
        np.where(BALL, 60, -1000) + np.random.default_rng(8).normal(0, 20, R.shape),
        "",
    ),
    "mask": (1.0 * BALL, ""),
}


@pytest.mark.parametrize("name", SIGNS)
def test_the_isosurface_that_is_shown_first_is_lit(name):
    values, why = SIGNS[name]
    test = volume(values)
    lo, hi = default_isovalue_range(test)
    isovalue = default_isovalue(test)
    (share,) = back_shares(test.values, test.index_to_world, [isovalue])
    said = why_both_sides(test, (lo, hi))
    assert said.removeprefix("v: ").startswith(why) and bool(said) == bool(why)
    assert lo < isovalue < hi and (share < 0.4 or said)
    if name.startswith(("orbital", "t-map")):
        assert isovalue > 0
    if "level set" in name and why:
        assert isovalue == 0
    # A cap hides the data behind it.
    assert default_isovalue(test.capped()) == isovalue


def test_backs_of_large_volumes_and_thin_ones_are_seen_by_a_part_of_the_voxels():
    z, y, x = np.mgrid[:11, :400, :400].astype(np.float32)
    values = np.sqrt((40 * (z - 5)) ** 2 + (y - 200) ** 2 + (x - 200) ** 2)
    thin = Volume(values, spacing=(1, 1, 40))
    assert back_shares(thin.values, thin.index_to_world, (150.0, 1e6)) == [1.0, 0.0]
    assert back_shares(-thin.values, thin.index_to_world, [-150.0]) == [0.0]


def by_nibabel(path, values):
    nibabel = pytest.importorskip("nibabel")
    nibabel.save(nibabel.Nifti1Image(values.T, np.diag([-1.0, -1.0, 2.0, 1.0])), path)


def by_vtk(path, values):
    vtk_files.write("XMLImageData", path, vtk_files.image_of(values))


def by_ase(path, values):
    cube = pytest.importorskip("ase.io.cube")
    ase = pytest.importorskip("ase")
    with open(path, "w") as file:
        cube.write_cube(file, ase.Atoms("H", cell=np.diag([8.0] * 3)), data=values.T)


@pytest.mark.parametrize(
    "name, write, values, isovalue, both_sides",
    [
        ("mask.nii.gz", by_nibabel, BALL.astype(np.float32), 0.5, False),
        ("mask.vti", by_vtk, BALL.astype(np.float32), 0.5, False),
        ("labels.nii.gz", by_nibabel, np.int16((R < 14) * 1 + (R < 10) + (R < 6)), 0.5, False),
        ("large.vti", by_vtk, np.int32(1_000_000 + (R < 14) + (R < 6)), 1_000_000.5, False),
        ("orbital.cube", by_ase, ORBITAL[::3, ::3, ::3], None, True),
    ],
)
def test_files_of_other_libraries(tmp_path, name, write, values, isovalue, both_sides):
    write(tmp_path / name, values)
    read = leaflight.read_volume(tmp_path / name)
    range_ = default_isovalue_range(read)
    shown = default_isovalue(read)
    assert range_[0] < shown < range_[1] and (shown == isovalue or isovalue is None and shown > 0)
    assert bool(why_both_sides(read, range_)) == both_sides


SMALL = {"error": 50.0, "resolution": 8}


def test_both_sides_are_baked_where_the_back_is_seen(bump_scene):
    level_set = volume((R - 8)[::3, ::3, ::3])
    with pytest.warns(ChosenSetting, match="seen from their backs, so both sides are baked"):
        chosen = leaflight.bake(level_set, bump_scene, **SMALL)
    assert chosen.provenance.both_sides and chosen.grid.has_back
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        given = leaflight.bake(level_set, bump_scene, both_sides=False, **SMALL)
        same = leaflight.bake(level_set, bump_scene, both_sides=True, **SMALL)
        usual = leaflight.bake(leaflight.bump_box(12), bump_scene, **SMALL)
    assert not given.grid.has_back and not usual.provenance.both_sides
    assert same.id == chosen.id
    capped = [level_set.capped()]
    assert why_both_sides(capped[0], default_isovalue_range(level_set)) == ""


def test_the_command_line_says_so(cli, tmp_path):
    np.save(tmp_path / "p.npy", ORBITAL[::3, ::3, ::3])
    options = ("bake", tmp_path / "p.npy", "--error", 50, "--resolution", 8, "--json", "--out")
    done = cli(*options, tmp_path / "p.vdb")
    assert done.status == 0 and '"both_sides": true' in done.out
    assert "leaflight: p: its isosurfaces below 0 are seen from their backs, so both" in done.err
    done = cli(*options, tmp_path / "q.vdb", "--no-both-sides")
    assert '"both_sides": false' in done.out and "backs" not in done.err
