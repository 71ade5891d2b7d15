# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the checks: an empty scene, and the bump box imported, in a box, and baked."""

import math
import os
import shutil

import bpy
import leaflight
import pytest
from blends import open_saved
from boxes import build_cornell_box
from leaflight.bake import baked as bake_of_package
from leaflight_addon.show import whole_detail
from leaflight_addon.store import bake_files
from passes import UNREACHED
from tools import Clock, end_all

N = 24


@pytest.fixture(autouse=True)
def empty_scene():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    yield
    end_all()


@pytest.fixture
def bump_file(tmp_path):
    """Returns the bump box as a file without a header; its voxels are not cubes."""
    path = tmp_path / "bumps.raw"
    leaflight._core.bump_box(N).astype("<f4").tofile(path)
    return path


@pytest.fixture
def bumps(bump_file, tmp_path):
    """Returns the object of the imported bump box."""
    bpy.ops.leaflight.import_volume(
        filepath=str(bump_file),
        dims=(N, N, N),
        value_type="float32",
        spacing=(1.0, 1.0, 0.8),
    )
    obj = bpy.context.object
    obj.leaflight.bake_folder = str(tmp_path / "bakes")
    obj.leaflight.error, obj.leaflight.resolution = 20.0, N
    # Use colors in a file beside the bake, which is not the default.
    obj.leaflight.shading = "ATLAS"
    bpy.context.view_layer.update()
    return obj


@pytest.fixture
def boxed(bumps):
    """Returns the bump box in a Cornell box."""
    build_cornell_box()
    return bumps


@pytest.fixture
def baked(boxed):
    """Returns the bump box in a Cornell box, baked."""
    bpy.ops.leaflight.bake()
    return boxed


@pytest.fixture
def unsaved(boxed):
    """Yields the bump box, baked in a .blend that was never saved."""
    boxed.leaflight.bake_folder = ""
    bpy.ops.leaflight.bake()
    yield boxed
    shutil.rmtree(bake_files.session_folder(), ignore_errors=True)


@pytest.fixture
def saved(boxed, tmp_path):
    """Returns the bump box, baked in a .blend in a new folder."""
    boxed.leaflight.bake_folder = ""
    return open_saved(tmp_path / "here" / "scene.blend", bake=True)


@pytest.fixture
def passes(boxed):
    """Returns the bump box for bakes in passes, with an isovalue range."""
    boxed.leaflight.property_unset("error")
    boxed.leaflight.use_resolution = False
    boxed.leaflight.low, boxed.leaflight.high = 40.0, 60.0
    boxed.leaflight.isovalue = 50.0
    os.mkdir(boxed.leaflight.bake_folder)
    return boxed


@pytest.fixture
def noisy(passes):
    """Returns the same with a spot light on the ceiling only. All light of isosurfaces is then
    indirect, and most of its error is noise.
    """
    (lamp,) = [obj for obj in bpy.data.objects if obj.type == "LIGHT"]
    lamp.data.type = "SPOT"
    lamp.data.spot_size, lamp.data.spot_blend = 0.8, 0.0
    lamp.rotation_euler = (math.pi, 0.0, 0.0)
    lamp.location.z -= 1.0
    lamp.data.energy *= 20.0
    bpy.context.view_layer.update()
    return passes


@pytest.fixture
def endless(noisy):
    noisy.leaflight.error = UNREACHED
    return noisy


@pytest.fixture
def uncut(monkeypatch):
    """Prevents meshes with extra vertices at steps of the light, whose number depends on
    rounding.
    """
    monkeypatch.setattr(bake_of_package, "LARGEST_STEP", float("inf"))


@pytest.fixture
def interactive(monkeypatch):
    """Simulates a window, because without one no surface is coarse.

    Time passes only by tick() and rest().
    """

    class App:
        background = False
        timers = bpy.app.timers

    class Bpy:
        app, data = App, bpy.data

    monkeypatch.setattr(whole_detail, "bpy", Bpy)
    monkeypatch.setattr(whole_detail, "time", Clock())
    yield
    whole_detail.forget()
    if bpy.app.timers.is_registered(whole_detail._tick):
        bpy.app.timers.unregister(whole_detail._tick)
