# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures: bakes, their web pages, and one browser for all tests."""

import math
import shutil
from dataclasses import replace
from pathlib import Path

import leaflight
import numpy as np
import pytest
from browser import PATHS, SESSION, Browser
from leaflight.scene.lights import AreaLight, Cone, PointLight, SunLight
from leaflight.scene.scene import Isosurfaces, Mesh, SceneDescription
from leaflight.scene.volume_texture import VolumeTexture, label_colors, texture_of
from leaflight.volume.label_table import labels_of
from leaflight.volume.particles import lapr
from leaflight.volume.regions import Box, HalfSpace, changed

ROOT = Path(__file__).resolve().parents[2]
COLIN27 = Path("/usr/share/mricron/templates/ch2.nii.gz")
WORK = {"error": 10.0}


@pytest.fixture(scope="session")
def browser():
    if not Path("/usr/bin/chromium").exists() or not shutil.which("node", path=PATHS):
        pytest.skip("Chromium or Node is not installed; run scripts/setup --tests")
    if not (SESSION.parents[1] / "node_modules" / "puppeteer-core").is_dir():
        pytest.skip("the packages of web/ are not installed; run scripts/setup --tests")
    browser = Browser()
    yield browser
    browser.end()


def box():
    """Returns the bump box with walls and both sides."""
    return leaflight.bake(
        leaflight.bump_box(64),
        leaflight.load_scene(ROOT / "scenes" / "bump_box.json"),
        both_sides=True,
        walls=True,
        resolution=64,
        **WORK,
    )


def brain():
    """Returns Colin27 with coarse light: rays hit every voxel."""
    if not COLIN27.exists():
        pytest.skip("the Debian package mricron-data is not installed")
    return leaflight.bake(leaflight.read_volume(COLIN27), resolution=60, error=10.0)


def oblong():
    """Returns a bake with unusual properties: rotated, with three voxel sizes, floats with a hole,
    no backs.
    """
    z, y, x = np.mgrid[:30, :22, :26].astype(np.float32)
    values = np.sin(0.4 * x) + np.cos(0.3 * y + 0.1 * z) + np.float32(0.01) * z * y
    values[12:20, 3:9, 4:12] = np.nan
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    index_to_world = np.eye(4)
    index_to_world[:3, :3] = turn @ np.diag([0.1, 0.15, 0.07])
    volume = leaflight.Volume(values.astype(np.float32), index_to_world, "oblong")
    return leaflight.bake(volume, resolution=50, isovalues=(0.2, 2.5), **WORK)


def two():
    """Returns two volumes that are shown together, whose backs have no visibility maps."""
    scene = leaflight.load_scene(ROOT / "scenes" / "lapr.json")
    volumes = [replace(one, values=one.values[:, :, :20].copy()) for one in lapr(30)]
    return leaflight.bake(volumes, scene, both_sides=True, **WORK)


def shadows():
    """Returns posts on a floor in front of a wall, with sharp shadows from above and below. One
    shadow is that of a plate.
    """
    z, y, x = np.mgrid[:40, :48, :44].astype(np.float32)
    values = 60 - 6 * z + 0.4 * np.sin(0.7 * x) * np.sin(0.5 * y)
    for px, py, height, width in ((12, 14, 26, 3), (29, 20, 18, 5), (16, 36, 32, 2.5)):
        far = np.maximum(np.hypot(x - px, y - py) - width, z - height)
        values = np.maximum(values, 20 - 8 * far)
    index_to_world = np.diag([0.02, 0.025, 0.03, 1.0])
    cone = Cone((0.0, 0.0, -1.0), 1.0, 0.5, cosine_falloff=True)
    lights = [
        SunLight("sun", (0.5, 0.3, -math.sqrt(1 - 0.34)), (0.9, 0.8, 0.6)),
        PointLight("spot", (0.35, 0.8, 1.8), 0.0, (1.6, 1.9, 2.4), cone),
        PointLight("below", (0.6, 0.3, -0.7), 0.0, (1.5, 0.6, 0.6)),
        AreaLight("lamp", (-0.3, 0.2, 1.4), (0.0, 0.3, 0.0), (0.3, 0.0, 0.2), (3.0, 3.0, 3.0)),
    ]
    meshes = [
        quadrilateral("plate", (-0.3, 0, 1.3), (0.4, 0, 0), (0, 0.4, 0)),
        quadrilateral("wall", (-0.4, 1.5, -0.3), (2.0, 0, 0), (0, 0, 1.8)),
    ]
    ramp = [(0.0, (0.8, 0.5, 0.3)), (40.0, (0.3, 0.6, 0.8))]
    scene = SceneDescription("shadows", [Isosurfaces("posts", ramp)], 1.2, meshes, lights)
    volume = leaflight.Volume(values.astype(np.float32), index_to_world, "posts")
    settings = {"isovalues": (-20.0, 40.0), "resolution": 48, "error": 5.0}
    return leaflight.bake(volume, scene, both_sides=True, walls=True, **settings)


def colored():
    """Returns waves over the whole box, whose color another volume gives; no walls."""
    return _with_texture(texture_of(_inner(np.sin), "CET_D1"))


def labeled():
    """Returns the same colored by labels, which cover a part of it."""
    labels = replace(_inner(np.sin), values=(_inner(np.sin).values > 0).astype(np.uint8))
    colors = label_colors(labels_of(labels.values))
    return _with_texture(VolumeTexture((labels,), colors, nearest=True))


def _inner(wave):
    """Returns a volume of 12 x 10 x 14 voxels within the box of _with_texture()."""
    z, y, x = np.mgrid[:14, :10, :12].astype(np.float32)
    matrix = np.diag([0.07, 0.09, 0.06, 1.0])
    matrix[:3, 3] = 0.1, 0.1, 0.05
    return leaflight.Volume(wave(0.7 * x + 0.3 * y + 0.2 * z), matrix, "inner")


def _with_texture(texture):
    z, y, x = np.mgrid[:36, :40, :44].astype(np.float32)
    values = 80 - 4 * z + 8 * np.sin(0.35 * x) * np.sin(0.3 * y)
    volume = leaflight.Volume(values, np.diag([0.025, 0.025, 0.025, 1.0]), "waves")
    lights = [
        SunLight("sun", (0.5, 0.3, -math.sqrt(1 - 0.34)), (0.9, 0.8, 0.6)),
        PointLight("below", (0.6, 0.3, -0.7), 0.0, (1.5, 0.6, 0.6)),
    ]
    material = Isosurfaces("waves", (0.9, 0.8, 0.9), texture=texture)
    scene = SceneDescription("colored", [material], 1.2, [], lights)
    settings = {"isovalues": (-20.0, 60.0), "resolution": 40, "error": 5.0}
    return leaflight.bake(volume, scene, both_sides=True, **settings)


def ball():
    """Returns a ball around the origin, lit by one point light."""
    z, y, x = (np.mgrid[:41, :41, :41] - 20.0) / 20.0
    values = (100 - 100 * np.sqrt(x * x + y * y + z * z)).astype(np.float32)
    index_to_world = np.diag([0.05, 0.05, 0.05, 1.0])
    index_to_world[:3, 3] = -1
    volume = leaflight.Volume(values, index_to_world, "ball")
    lamp = PointLight("lamp", (-2.0, -3.0, 2.5), 0.0, (20.0, 16.0, 13.0))
    scene = SceneDescription("ball", [Isosurfaces("ball", (0.7, 0.7, 0.7))], 1.0, [], [lamp])
    return leaflight.bake(volume, scene, isovalues=(20.0, 80.0), resolution=32, **WORK)


def quadrilateral(name, corner, edge, other):
    corners = np.add(corner, [(0, 0, 0), edge, np.add(edge, other), other]).astype(np.float32)
    return Mesh(name, corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32), (0.6, 0.6, 0.6))


def noisy():
    """Returns a ball of noisy bytes with smooth normals, cut in the middle and capped."""
    z, y, x = (np.mgrid[:36, :36, :36] - 17.5) / 17.5
    values = 200 - 130 * np.sqrt(x * x + y * y + z * z)
    values += np.random.default_rng(8).normal(0, 6, values.shape)
    volume = leaflight.Volume(np.uint8(values.clip(0, 255))[:20], name="noisy", smooth_normals=1.5)
    return leaflight.bake(volume.capped(), isovalues=(100.5, 160.5), resolution=36, **WORK)


def halved():
    """Returns a ball with noise inside, cut by a turned plane and by a box."""
    z, y, x = (np.mgrid[:36, :36, :36] - 17.5) / 17.5
    values = 200 - 130 * np.sqrt(x * x + y * y + z * z)
    values += np.random.default_rng(8).normal(0, 6, values.shape) * (values > 130)
    volume = leaflight.Volume(values.astype(np.float32), name="halved")
    box = Box.between((17.0, -9.0, 18.0), (45.0, 20.0, 45.0), keep="outside")
    plane = HalfSpace((17.5, 12.0, 17.5), (0.3, -0.9, 0.2))
    cut = changed(volume, [plane, box])
    return leaflight.bake(cut, isovalues=(100.5, 160.5), resolution=36, **WORK)


MAKERS = {
    maker.__name__: maker
    for maker in (box, brain, oblong, two, shadows, colored, labeled, ball, noisy, halved)
}


@pytest.fixture(scope="session")
def bakes():
    """Returns each bake by its name, made once."""
    made = {}

    def get(name):
        if name not in made:
            made[name] = MAKERS[name]()
        return made[name]

    return get


@pytest.fixture(scope="session")
def pages(bakes, tmp_path_factory):
    """Returns the path of the page of a bake, by its name."""
    folder = tmp_path_factory.mktemp("pages")

    def get(name):
        path = folder / f"{name}.html"
        if not path.exists():
            bakes(name).export_page(path)
        return path

    return get
