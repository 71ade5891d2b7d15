# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks Bake Flattened Illumination and its result."""

import os
import sys
import time
from pathlib import Path

import bpy
import leaflight
import numpy as np
import pytest
from blends import open_blend, save
from leaflight_addon.bake import bake
from leaflight_addon.show import surface_material, surface_object
from leaflight_addon.store import atlases, bake_files, cache
from passes import state
from tools import assert_shows, close, duplicate, error_of, mesh_arrays, start, to_world, wait_while


def check_the_surface_shows_the_radiance_of_the_bake(baked):
    isovalue = baked.leaflight.isovalue
    assert_shows(baked, isovalue)
    _, _, radiance = mesh_arrays(baked)
    assert radiance.max() > 0.01
    attribute = baked.data.attributes["radiance"]
    assert (attribute.data_type, attribute.domain) == ("FLOAT_COLOR", "POINT")


def check_the_bake_is_the_one_the_python_package_makes(baked):
    settings = baked.leaflight
    ours = cache.bake_of(baked)
    same = leaflight.bake(
        cache.world_volume(baked),
        ours.scene,
        isovalues=(settings.low, settings.high),
        error=settings.error,
        resolution=settings.resolution,
    )
    np.testing.assert_array_equal(same.grid.dense("radiance"), ours.grid.dense("radiance"))
    matrix = np.array(baked.matrix_world) @ cache.volume_of(baked).index_to_world
    close(ours.volume.index_to_world, matrix, 1e-6)


def check_a_turned_and_scaled_volume_is_baked_where_it_stands(boxed, uncut):
    boxed.rotation_euler = (0.2, 0.1, 0.7)
    boxed.scale = boxed.scale * 0.7
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    ours = cache.bake_of(boxed)
    isovalue = boxed.leaflight.isovalue
    vertices, _, radiance = mesh_arrays(boxed)
    surface = ours.surface(isovalue)
    close(to_world(boxed, vertices), surface.vertices, 1e-5)
    close(radiance, surface.radiance, 1e-3 * radiance.max())


def check_outside_its_window_the_surface_is_plain(baked):
    settings = baked.leaflight
    settings.low, settings.high = 40.0, 60.0
    settings.isovalue = 50.0
    bpy.ops.leaflight.bake()
    limits = settings.id_properties_ui("isovalue").as_dict()
    close([limits["soft_min"], limits["soft_max"]], [40, 60], 1e-4)
    assert baked.data.materials[0] == settings.baked_material
    settings.isovalue = 80.0
    assert baked.data.materials[0] == settings.isosurface_material
    assert "radiance" not in baked.data.attributes
    settings.isovalue = 59.0
    assert baked.data.materials[0] == settings.baked_material


def check_too_large_an_atlas_gives_the_vertex_attribute_with_the_reason(boxed, monkeypatch):
    monkeypatch.setattr(atlases, "LARGEST_ATLAS", 64)
    bpy.ops.leaflight.bake()
    settings = boxed.leaflight
    assert settings.shading == "ATLAS"
    mode, reason = surface_material.shading_in_use(settings)
    assert mode == "ATTRIBUTE" and "64 x 64" in reason
    kinds = {node.type for node in settings.baked_material.node_tree.nodes}
    assert "ATTRIBUTE" in kinds and "TEX_IMAGE" not in kinds
    assert not list(Path(settings.bake_folder).glob("*.exr"))


@pytest.fixture
def endless(boxed):
    boxed.leaflight.error, boxed.leaflight.resolution = 0.01, 128
    return boxed


def _cancel(obj):
    """Starts a bake, cancels it, and returns the seconds until it ended."""
    work = start(bake.BakeJob(bpy.context, obj))
    wait_while(work, lambda: work.progress.fraction == 0)
    cancelled = time.perf_counter()
    work.cancel()
    with pytest.raises(leaflight.Cancelled):
        work.result()
    return time.perf_counter() - cancelled


def check_a_cancelled_bake_leaves_scene_and_disk_alone(endless):
    before = state()
    _cancel(endless)
    assert state() == before
    assert not os.listdir(endless.leaflight.bake_folder)


@pytest.mark.machine
def check_a_cancelled_bake_ends_within_a_second(endless):
    assert _cancel(endless) < 1.0


def check_a_bake_of_an_object_that_was_deleted_meanwhile_says_so(boxed):
    job = bake.BakeJob(bpy.context, boxed)
    job.run(leaflight.Progress())
    name = boxed.name
    bpy.data.objects.remove(boxed)
    with pytest.raises(leaflight.LeaflightError, match=name):
        job.apply()


_LINUX = pytest.mark.skipif(sys.platform == "win32", reason="a folder of Linux")


@pytest.mark.parametrize(
    "setting, value, expected",
    [
        pytest.param("bake_folder", "/proc/nowhere", "/proc/nowhere", marks=_LINUX),
        pytest.param("bake_folder", "/proc", "/proc", marks=_LINUX),
        ("high", -5.0, "range"),
    ],
)
def check_bad_settings_give_one_sentence_and_change_nothing(boxed, setting, value, expected):
    setattr(boxed.leaflight, setting, value)
    before = state()
    sentence = error_of(bpy.ops.leaflight.bake)
    assert expected in sentence and "\n" not in sentence
    assert state() == before


def check_a_duplicate_is_lit_by_its_own_bake(baked):
    before = mesh_arrays(baked)[2].mean()
    copy = duplicate(baked)
    baked.hide_render = True
    assert copy != baked
    bpy.data.objects["lamp"].data.energy *= 2.0
    bpy.context.view_layer.update()
    bpy.ops.leaflight.bake()
    assert copy.data.materials[0] != baked.data.materials[0]
    assert_shows(copy, copy.leaflight.isovalue)
    assert mesh_arrays(copy)[2].mean() > 1.5 * before


def check_a_lost_bake_is_explained_and_the_surface_stays_plain(baked, tmp_path):
    save(tmp_path / "scene.blend")
    bake_files.locate(baked).unlink()
    obj = open_blend(tmp_path / "scene.blend")
    obj.leaflight.isovalue = 77.0
    assert Path(obj.leaflight.bake_path).name in surface_object.problems[obj.name]
    assert len(obj.data.vertices) > 100 and "radiance" not in obj.data.attributes
    assert obj.data.materials[0] == obj.leaflight.isosurface_material


def check_a_scene_without_light_is_refused(boxed):
    bpy.data.objects.remove(bpy.data.objects["lamp"])
    assert "light" in error_of(bpy.ops.leaflight.bake)


def check_the_default_folder_is_beside_a_saved_file_and_never_inside_the_addon(bumps, tmp_path):
    bumps.leaflight.bake_folder = ""
    unsaved = bake_files.folder_for(bumps)
    assert unsaved.is_absolute()
    assert Path(leaflight.__file__).parent not in unsaved.parents
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bumps = bpy.data.objects[bumps.name]
    assert bake_files.folder_for(bumps) == tmp_path / "leaflight"
