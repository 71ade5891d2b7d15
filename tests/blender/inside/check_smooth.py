# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks Smooth: at import, afterwards, in files and in the record of a bake."""

import bpy
import leaflight
import numpy as np
import pytest
from blends import reopened
from boxes import build_cornell_box
from leaflight_addon.stage import staleness
from leaflight_addon.store import cache
from leaflight_addon.show import distribution
from tools import assert_shows, close, vertices_of


@pytest.fixture
def steps(tmp_path):
    """Returns a ball of bytes whose values increase by two per voxel."""
    z, y, x = np.mgrid[:24, :24, :24]
    distance = np.sqrt((x - 11.5) ** 2 + (y - 11.5) ** 2 + (z - 11.5) ** 2)
    np.save(tmp_path / "steps.npy", np.uint8(np.maximum(0, 60 - 2 * distance)))
    return tmp_path / "steps.npy"


def imported(path, **options):
    bpy.ops.leaflight.import_volume(filepath=str(path), **options)
    obj = bpy.context.object
    obj.leaflight.bake_folder = str(path.parent / "bakes")
    return obj


def check_the_values_are_smoothed_and_stay_so_in_files(steps, tmp_path):
    expected = leaflight.read_volume(steps, smooth=1.0).values
    obj = imported(steps, smooth=1.0)
    np.testing.assert_array_equal(cache.volume_of(obj).values, expected)
    isovalue = obj.leaflight.isovalue
    obj = reopened(tmp_path / "scene.blend")
    obj.leaflight.isovalue = 0.9 * isovalue
    np.testing.assert_array_equal(cache.volume_of(obj).values, expected)
    assert_shows(obj, obj.leaflight.isovalue)


def check_it_is_proposed_for_bytes_and_done_afterwards(steps):
    obj = imported(steps)
    assert distribution.look_now(obj).is_terraced
    bpy.ops.leaflight.smooth(amount="1")
    assert obj.leaflight.smooth == 1.0 and not distribution.look_now(obj).is_terraced
    close(cache.volume_of(obj).values, leaflight.read_volume(steps, smooth=1.0).values, 0)
    assert_shows(obj, obj.leaflight.isovalue)
    bpy.ops.leaflight.smooth(amount="0")
    assert cache.volume_of(obj).values.dtype == np.uint8


def check_normals_alone_are_smoothed(steps, tmp_path):
    obj = imported(steps)
    vertices = vertices_of(obj)
    bpy.ops.leaflight.smooth(what="smooth_normals", amount="2")
    assert obj.leaflight.smooth == 0.0 and cache.volume_of(obj).values.dtype == np.uint8
    close(vertices_of(obj), vertices, 0)
    expected = leaflight.read_volume(steps, smooth_normals=2.0)
    assert cache.volume_of(obj).smooth_normals == expected.smooth_normals
    build_cornell_box()
    obj.leaflight.error, obj.leaflight.resolution = 50.0, 16
    bpy.ops.leaflight.bake()
    (record,) = cache.bake_of(obj).provenance.volumes
    assert record.source == f"{steps}, normals smoothed by 2 voxels"
    assert record.smooth_normals == 2.0 and "radiance" in obj.data.attributes
    obj = reopened(tmp_path / "scene.blend")
    assert cache.volume_of(obj).smooth_normals == 2.0
    assert staleness.change_since_bake(bpy.context, obj) == ""
    bpy.ops.leaflight.smooth(what="smooth_normals", amount="0")
    assert "radiance" not in obj.data.attributes
    # A loaded bake brings its normals.
    bpy.ops.leaflight.load_bake(filepath=obj.leaflight.bake_path)
    obj = bpy.context.object
    assert obj.leaflight.smooth_normals == 2.0 and "radiance" in obj.data.attributes


def check_a_bake_keeps_what_it_was_made_of(steps):
    obj = imported(steps, smooth=0.5)
    build_cornell_box()
    obj.leaflight.error, obj.leaflight.resolution = 50.0, 16
    bpy.ops.leaflight.bake()
    (record,) = cache.bake_of(obj).provenance.volumes
    assert record.source == f"{steps}, smoothed by 0.5 voxels"
    assert "radiance" in obj.data.attributes
    assert staleness.change_since_bake(bpy.context, obj) == ""
    bpy.ops.leaflight.smooth(amount="2")
    assert "radiance" not in obj.data.attributes
    staleness.forget()
    assert "Smooth or hidden labels have changed" in staleness.change_since_bake(bpy.context, obj)
    bpy.ops.leaflight.smooth(amount="0.5")
    assert "radiance" in obj.data.attributes
