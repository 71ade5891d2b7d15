# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the photon map as a cloud of points."""

import bpy
import numpy as np
import pytest
from leaflight import _core
from leaflight.scene.scene import core_scene
from leaflight_addon.stage import scene_export
from leaflight_addon.store import cache
from tools import close, colors_of, error_of, look_down, render_exr, vertices_of


def _cloud():
    (cloud,) = (obj for obj in bpy.context.scene.objects if obj.name.endswith("Photons"))
    return cloud


def _traced(isosurface, count):
    description, _, _ = scene_export.export_scene(bpy.context, isosurface)
    isovalue_range = (isosurface.leaflight.low, isosurface.leaflight.high)
    scene = core_scene(description, [cache.world_volume(isosurface).field()], isovalue_range)
    return _core.photon_points(scene, count)


def _values(cloud, name, kind):
    values = np.empty(len(cloud.data.vertices), kind)
    cloud.data.attributes[name].data.foreach_get("value", values)
    return values


def check_the_cloud_holds_the_cores_photons(boxed):
    bpy.ops.leaflight.photon_cloud(count=20_000)
    positions, flux, c, direct = _traced(boxed, 20_000)
    cloud = _cloud()
    assert len(positions) > 200
    close(vertices_of(cloud), positions, 1e-5)
    close(colors_of(cloud, "flux"), flux / flux.mean(), 1e-5)
    close(_values(cloud, "common_isovalue", np.float32), c, 1e-5)
    np.testing.assert_array_equal(_values(cloud, "direct", bool), direct.astype(bool))


def check_a_band_and_a_kind(boxed):
    boxed.leaflight.isovalue = 60.0
    _, _, c, direct = _traced(boxed, 20_000)
    reach = 0.05 * (boxed.leaflight.high - boxed.leaflight.low)
    near = np.abs(c - 60.0) <= reach
    for kind, chosen in (
        ("ALL", near),
        ("DIRECT", near & (direct == 1)),
        ("INDIRECT", near & (direct == 0)),
    ):
        bpy.ops.leaflight.photon_cloud(count=20_000, band=0.1, kind=kind)
        assert len(_cloud().data.vertices) == chosen.sum() > 0


@pytest.mark.parametrize("engine", ["CYCLES", "EEVEE"])
def check_it_renders_in_its_colors(boxed, tmp_path, engine):
    bpy.ops.leaflight.photon_cloud(count=100_000, radius=0.03)
    for obj in bpy.context.scene.objects:
        obj.hide_render = obj != _cloud()
    look_down(5.0, 2.4)
    pixels = render_exr(tmp_path / "cloud.exr", engine, size=32)
    assert pixels[..., :3].max() > 0.1
    assert (pixels[..., :3].sum(axis=-1) > 0).mean() > 0.2


def check_the_cloud_is_no_part_of_the_scene_that_is_baked(boxed):
    before = scene_export.export_scene(bpy.context, boxed)[0]
    bpy.ops.leaflight.photon_cloud(count=1000)
    _cloud().hide_render = False
    bpy.context.view_layer.update()
    after, _, warnings = scene_export.export_scene(bpy.context, boxed)
    assert len(after.meshes) == len(before.meshes) and warnings == []


def check_without_light_it_says_so(boxed):
    bpy.data.objects.remove(bpy.data.objects["lamp"])
    assert "light" in error_of(bpy.ops.leaflight.photon_cloud)
