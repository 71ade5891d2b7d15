# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that voxels keep the type of the file, and that only memory depends on it."""

from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight import Volume, default_isovalue, default_isovalue_range, read_volume
from leaflight.bake.provenance import sha256, values_sha256
from leaflight.volume.memory import VOXEL_TYPES, as_voxels

INTEGERS = VOXEL_TYPES[:3]


def bumps(kind, n=20):
    """Returns the bump box as integers of a type, noisy, over most of the type's range."""
    box = leaflight.bump_box(n)
    limits, noise = np.iinfo(kind), np.random.default_rng(1).normal(0, 4, box.values.shape)
    share = np.clip((box.values + noise) / 255, 0.02, 0.98)
    values = np.rint(limits.min + share * (limits.max - limits.min)).astype(kind)
    return replace(box, values=values)


def in_floats(volume):
    return replace(volume, values=volume.values.astype(np.float32))


@pytest.mark.parametrize(
    "kind, kept",
    [
        ("?", np.uint8),
        ("i1", np.int16),
        (">i2", np.int16),
        (">u2", np.uint16),
        ("i4", np.float32),
        ("u4", np.float32),
        ("f2", np.float32),
        (">f4", np.float32),
        ("f8", np.float32),
        *((kind, kind) for kind in VOXEL_TYPES),
    ],
)
def test_the_type_that_is_kept(kind, kept):
    values = (np.arange(24).reshape(2, 3, 4) % 2).astype(kind)
    voxels = as_voxels(values)
    assert voxels.dtype == kept and voxels.dtype.isnative and voxels.flags.c_contiguous
    np.testing.assert_array_equal(voxels, values)
    assert np.shares_memory(voxels, values) == (np.dtype(kind) == kept)
    assert as_voxels(np.moveaxis(values, 0, 1)).flags.c_contiguous


@pytest.mark.parametrize("kind", INTEGERS)
def test_they_are_neither_copied_nor_converted(kind):
    volume = bumps(kind)
    values = volume.field().values
    assert values.dtype == kind and np.shares_memory(values, volume.values)


@pytest.mark.parametrize("kind", INTEGERS)
def test_bakes_have_the_same_bits_and_ids(kind, bump_scene, tmp_path):
    volume = bumps(kind, 10)
    isovalue_range = default_isovalue_range(volume)
    own, floats = (
        leaflight.bake(one, bump_scene, isovalues=isovalue_range, error=20.0)
        for one in (volume, in_floats(volume))
    )
    assert own.id == floats.id
    for name in ("radiance", "radiance_indirect"):
        light = [bake.grid.dense(name) for bake in (own, floats)]
        assert light[0].any() and sha256(light[0]) == sha256(light[1])
    # The file stores floats, and the name of the original type.
    own.save(tmp_path / "own.vdb")
    loaded = leaflight.load_bake(tmp_path / "own.vdb")
    assert loaded.id == own.id and loaded.volume.values.dtype == kind
    np.testing.assert_array_equal(loaded.volume.values, volume.values)
    assert values_sha256(loaded.volume) == values_sha256(in_floats(volume))
    floats.save(tmp_path / "floats.vdb")
    assert leaflight.load_bake(tmp_path / "floats.vdb").volume.values.dtype == np.float32


@pytest.mark.parametrize("kind", INTEGERS)
@pytest.mark.parametrize("spread", [3, 30, 3000])
def test_isovalues_to_begin_with(kind, spread):
    rng, limits = np.random.default_rng(spread), np.iinfo(kind)
    middle, width = 0.3 * limits.max + 0.7 * limits.min, (limits.max - limits.min) / spread
    for background in (False, True):
        values = rng.normal(middle, max(width, 1.5), (12, 13, 14)).clip(limits.min, limits.max)
        values = values.astype(kind)
        if background:
            values[values < middle] = values.min()
        volume = Volume(values, np.eye(4), "noise")
        for one in (volume, volume.capped()):
            assert default_isovalue_range(one) == default_isovalue_range(in_floats(one))
            assert default_isovalue(one) == default_isovalue(in_floats(one))


@pytest.mark.parametrize(
    "kind, low, high, kept",
    [
        (np.uint8, 0, 255, np.int16),
        (np.int16, -1024, 3071, np.int16),
        (np.int16, -32768, 32767, np.float32),
        (np.uint16, 0, 65535, np.float32),
        (np.uint16, 60_000, 60_100, np.uint16),
    ],
)
def test_the_layer_of_a_cap_is_held_too(kind, low, high, kept):
    values = np.random.default_rng(2).integers(low, high, (4, 5, 6), endpoint=True).astype(kind)
    values.flat[:2] = low, high
    volume = Volume(values, np.eye(4), "noise")
    capped = volume.capped()
    assert capped.values.dtype == kept
    np.testing.assert_array_equal(capped.values, in_floats(volume).capped().values)
    np.testing.assert_array_equal(capped.data(), values)


def test_differences_do_not_wrap_around():
    """Checks differences near the limits of a type, by which the Cycles reference cuts cells."""
    from leaflight.measure.cycles import _finer

    volume = bumps(np.uint8)
    fine, same = (_finer(one.field(), 2).values for one in (volume, in_floats(volume)))
    np.testing.assert_array_equal(fine, same)


def test_images_in_the_plane():
    values = np.random.default_rng(3).integers(0, 255, (9, 8)).astype(np.uint8)
    volume = Volume(values, np.eye(3), "image")
    assert volume.field().values.dtype == np.uint8
    points = np.random.default_rng(4).uniform(0, 7, (50, 2))
    same = in_floats(volume).field().sample(points)
    np.testing.assert_array_equal(volume.field().sample(points), same)


def test_slices_of_different_types_agree_on_one(tmp_path):
    tifffile = pytest.importorskip("tifffile")
    planes = [np.arange(6, dtype=kind).reshape(2, 3) for kind in (np.uint8, np.uint16)]
    planes[1][0, 0] = 300
    for k, plane in enumerate(planes):
        tifffile.imwrite(tmp_path / f"{k}.tif", plane)
    volume = read_volume(tmp_path)
    assert volume.values.dtype == np.uint16 and volume.values.max() == 300
