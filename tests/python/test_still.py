# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests pictures that the core renders."""

from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight.io.images import read_pixels
from leaflight.scene.lights import SunLight
from leaflight.scene.scene import Isosurfaces, Mesh, SceneDescription
from leaflight.stills.camera import Camera, load_camera
from leaflight.stills.first_view import camera_around_bake
from outcomes import refused, written
from PIL import Image

SIZE = (80, 60)
# A sun that shines over the wall in front of the ball.
SUN = SunLight("sun", (0.0, 0.6, -0.8), (4.0, 2.0, 1.0))


def sphere_scene(lights=(SUN,), meshes=()):
    return SceneDescription(
        "ball", [Isosurfaces("ball", (0.8, 0.6, 0.4))], 1.0, list(meshes), list(lights)
    )


@pytest.fixture(scope="module")
def ball():
    """Returns spheres about the center of the unit cube; the radius is 1 - isovalue."""
    z, y, x = (np.mgrid[:33, :33, :33] / 32 - 0.5).astype(np.float32)
    values = 1 - np.sqrt(x**2 + y**2 + z**2)
    volume = leaflight.Volume(values, np.diag([1 / 32, 1 / 32, 1 / 32, 1]), "ball")
    wall = np.array([[-1, 2, -1], [2, 2, -1], [2, 2, 2], [-1, 2, 2]], np.float32)
    walls = [
        Mesh("behind", wall, np.array([[0, 1, 2], [0, 2, 3]], np.uint32), (0.5, 0.5, 0.5)),
        Mesh("before", wall - [0, 3, 0], np.array([[0, 1, 2], [0, 2, 3]], np.uint32), (0.5,) * 3),
    ]
    walls[1] = replace(walls[1], vertices=walls[1].vertices.astype(np.float32))
    settings = {"isovalues": (0.55, 0.75), "error": 5.0, "resolution": 33, "walls": True}
    return leaflight.bake(volume, sphere_scene(meshes=walls), **settings)


CAMERA = Camera((0.5, -4.0, 0.5), (0.5, 0.5, 0.5), angle=20.0)


def on_the_sphere():
    """Returns (pixels that see the sphere of radius 0.35, pixels near its edge, visible points)."""
    directions = CAMERA.directions(*SIZE, range(SIZE[1]))
    along = directions @ np.array([0.0, 4.5, 0.0])
    inside = along**2 - (4.5**2 - 0.35**2)
    points = CAMERA.position + (along - np.sqrt(np.maximum(inside, 0)))[..., None] * directions
    return inside > 0, abs(inside) < 0.02, points


def test_a_sphere_is_a_disc_with_the_light_of_the_bake(ball):
    picture = leaflight.still(ball, 0.65, CAMERA, SIZE, samples=1, walls=False)
    assert picture.shape == (60, 80, 4) and picture.dtype == np.float32
    is_hit, is_near, points = on_the_sphere()
    filled = picture[..., 3] == 1
    np.testing.assert_array_equal(filled[~is_near], is_hit[~is_near])
    plain = filled & ~is_near
    points, seen = points[plain], picture[plain][:, :3]
    # The edge of a shadow may differ slightly.
    inside, outside = (ball.radiance(0.5 + (points - 0.5) * scale) for scale in (0.98, 1.02))
    is_edge = np.abs(inside - outside).max(axis=1) > 0.2
    assert is_edge.mean() < 0.05
    np.testing.assert_allclose(seen[~is_edge], ball.radiance(points[~is_edge]), atol=0.02)
    assert seen.max() > 0.1 and not picture[~filled].any()


def test_local_shading_is_the_lamps_cosine(ball):
    picture = leaflight.still(ball, 0.65, CAMERA, SIZE, samples=1, walls=False, local=True)
    is_hit, is_near, points = on_the_sphere()
    seen = is_hit & ~is_near
    normals = (points[seen] - 0.5) / 0.35
    cosine = np.maximum(normals @ -np.array(SUN.direction), 0)
    expected = np.array([0.8, 0.6, 0.4]) * SUN.irradiance * cosine[:, None] / np.pi
    np.testing.assert_allclose(picture[seen][:, :3], expected, atol=0.02)
    assert cosine.max() > 0.9


def test_walls_between_the_viewer_and_the_volume_are_left_out(ball):
    with_walls = leaflight.still(ball, 0.65, CAMERA, SIZE, samples=1)
    without = leaflight.still(ball, 0.65, CAMERA, SIZE, samples=1, walls=False)
    isosurface = without[..., 3] == 1
    np.testing.assert_array_equal(with_walls[isosurface], without[isosurface])
    assert with_walls[..., 3].all() and with_walls[~isosurface][:, :3].max() > 0.05
    # From between the isosurfaces, looking back, the front one is visible.
    back = Camera((0.5, 1.9, 0.5), (0.5, -1.0, 0.5), angle=20.0)
    assert leaflight.still(ball, 0.65, back, SIZE, samples=1)[..., 3].all()


def test_rays_of_a_pixel_are_averaged(ball):
    fine = leaflight.still(ball, 0.65, CAMERA, (160, 120), samples=1)
    coarse = leaflight.still(ball, 0.65, CAMERA, SIZE, samples=2)
    mean = fine.reshape(60, 2, 80, 2, 4).mean(axis=(1, 3))
    np.testing.assert_allclose(coarse, mean, atol=1e-5)


def test_backs(lapr_bake):
    """Checks backs, seen through the open border: as baked, or shaded if they were not."""
    camera = camera_around_bake(lapr_bake, azimuth=90)
    picture = leaflight.still(lapr_bake, 0.5, camera, SIZE, walls=False)
    assert picture[..., 3].any() and np.isfinite(picture).all()


def test_the_command(cli, box_file, tmp_path):
    command = ("still", box_file, "--size", 64, 48)
    for name in ("box.png", "box.exr"):
        result = cli.json(*command, "--out", tmp_path / name, "--no-walls")
        assert result["size"] == [64, 48] and 0.01 < result["filled"] < 1
    radiance = read_pixels(tmp_path / "box.exr")
    assert radiance.shape == (48, 64, 3) and radiance.max() > 0.1

    colors = np.asarray(Image.open(tmp_path / "box.png"))
    assert colors.shape == (48, 64, 4) and colors[..., 3].min() == 0 and colors[..., :3].max() > 100
    placed = '{"position": [0.5, 0.5, 4], "target": [0.5, 0.5, 0.5], "up": [0, 1, 0]}'
    camera = written(tmp_path / "camera.json", placed)
    out = tmp_path / "other.png"
    cli.runs(*command, "--out", out, "--camera", camera)
    assert (np.asarray(Image.open(out)) != colors).any()


def test_sentences(cli, box_bake, box_file, tmp_path):
    out = tmp_path / "x.png"
    for arguments, words in (
        (["--out", tmp_path / "x.jpg"], ".png or .exr"),
        (["--out", out, "--isovalue", 400], "outside the baked range"),
        (["--out", out, "--size", 0, 10], "(--size)"),
        (["--out", out, "--samples", 99], "(--samples)"),
        (["--out", out, "--view", 0, 90], "between -90 and 90"),
        (["--out", out, "--zoom", 0], "positive"),
    ):
        cli.refuses(words, "still", box_file, *arguments)
    huge = '{"position": [1%s, 0, 0], "target": [1, 1, 1]}' % (400 * "0")
    short = '{"position": [0, 0], "target": [1, 1, 1]}'
    whole = huge.replace(400 * "0", 20 * "0")
    assert np.isfinite(load_camera(written(tmp_path / "camera.json", whole)).axes()).all()
    for text in ("[]", "{}", short, huge, 10**5 * "[", '{"angle": 20}', "x"):
        path = written(tmp_path / "camera.json", text)
        refused("is not a camera", load_camera, path)
    mirror = replace(box_bake.scene.isosurfaces[0], scattering="mirror")
    scene = replace(box_bake.scene, isosurfaces=[mirror])
    refused("mirror or glass", leaflight.still, replace(box_bake, scene=scene), 47.0)
    assert not out.exists()
