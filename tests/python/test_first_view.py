# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the first view of a bake: its direction, distance and brightness."""

from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight.export.histogram import bin_width
from leaflight.scene.facing import quarter_turns, turned
from leaflight.scene.lights import PointLight, SunLight
from leaflight.scene.scene import Isosurfaces, SceneDescription, fit_scene
from leaflight.stills.first_view import camera_around_bake, framing
from leaflight.stills.photograph import BRIGHTEST, metered_stops, photographed, tone_mapped

SUN = SunLight("sun", (0.0, 0.6, -0.8), (2.0, 2.0, 2.0))
SIZES = ((320, 180), (180, 320))


def block(x, y, z, **options):
    """Returns a volume with a central block of this size; its sides are isosurfaces 0 to 1."""
    values = np.zeros((32, 32, 32), np.float32)
    slices = (slice(16 - n // 2, 16 + n // 2) for n in (z, y, x))
    values[tuple(slices)] = 1.0
    return replace(leaflight.Volume(values, np.diag([0.1, 0.1, 0.1, 1.0]), "block"), **options)


def lit(volume, scene=None, **options):
    """Returns a quick bake with little light."""
    scene = scene or SceneDescription("sun", [Isosurfaces("block", (0.8,) * 3)], 1.0, [], [SUN])
    settings = {"isovalues": (0.3, 0.7), "error": 20.0, "resolution": 16}
    return leaflight.bake(volume, scene, **settings, **options)


@pytest.fixture(scope="module")
def cornell_patient():
    return lit(block(12, 20, 20, patient=True), leaflight.cornell_box())


def azimuth(found):
    x, y, _ = found.back
    return round(np.degrees(np.arctan2(x, -y))) % 360


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("sides", [(24, 12, 8), (6, 6, 26)])
def test_the_isosurface_fills_half_to_all_of_a_picture(sides, size):
    bake = lit(block(*sides))
    picture = leaflight.still(bake, 0.5, size=size, samples=1, walls=False)
    rows, columns = np.nonzero(picture[..., 3])
    filled = max(np.ptp(rows) / size[1], np.ptp(columns) / size[0])
    assert 0.5 < filled < 0.95
    assert abs(rows.min() + rows.max() - size[1]) < 0.1 * size[1]
    assert abs(columns.min() + columns.max() - size[0]) < 0.1 * size[0]


def test_the_largest_silhouette_is_seen():
    assert azimuth(framing(lit(block(20, 6, 20)))) == 0
    assert azimuth(framing(lit(block(6, 20, 20)))) == 90
    # A slightly larger side makes no difference.
    assert azimuth(framing(lit(block(18, 20, 20)))) == 0
    side, flat = framing(lit(block(20, 20, 20))), framing(lit(block(24, 24, 4)))
    assert side.back[2] < 0.3 < 0.7 < flat.back[2]


def test_a_patient_is_seen_from_the_front_and_the_room_stands_around_it(cornell_patient):
    assert azimuth(framing(cornell_patient)) == 180
    walls = {mesh.name: mesh.vertices.mean(axis=0) for mesh in cornell_patient.scene.meshes}
    middle = np.full(3, 1.55)
    assert walls["back wall"][1] < middle[1] - 1 and walls["left wall"][0] > middle[0] + 1
    assert azimuth(framing(lit(block(12, 20, 20, patient=True)))) == 180


def test_a_bake_remembers_that_it_is_of_a_patient(cornell_patient, tmp_path):
    cornell_patient.save(tmp_path / "patient.vdb")
    assert leaflight.load_bake(tmp_path / "patient.vdb").volume.patient


def test_a_room_turns_to_the_wider_side():
    assert quarter_turns([block(6, 20, 20)]) == 1
    assert quarter_turns([block(20, 6, 20)]) == quarter_turns([block(16, 18, 20)]) == 0
    assert azimuth(framing(lit(block(6, 20, 20), leaflight.cornell_box()))) == 90


def test_a_turned_scene_is_the_same_scene():
    scene = leaflight.cornell_box()
    four = turned(turned(turned(turned(scene, 1), 1), 1), 1)
    for before, after in zip(scene.meshes, four.meshes):
        np.testing.assert_allclose(before.vertices, after.vertices, atol=1e-6)
    once = turned(scene, 1)
    corner, edge = np.array(scene.lights[0].corner), np.array(scene.lights[0].edge_u)
    np.testing.assert_allclose(once.lights[0].corner, [-corner[1], corner[0], corner[2]])
    np.testing.assert_allclose(once.lights[0].edge_u, [-edge[1], edge[0], edge[2]])
    lamps = [PointLight("lamp", (1.0, 2.0, 3.0), 0.1, (1.0,) * 3), SUN]
    point, sun = turned(replace(scene, lights=lamps), 2).lights
    assert point.position == (-1.0, -2.0, 3.0) and sun.direction == (0.0, -0.6, -0.8)
    assert fit_scene(once, [block(8, 8, 8)]).coordinates == "world"


def test_a_camera_of_ones_own(cornell_patient):
    camera = camera_around_bake(cornell_patient, azimuth=90, elevation=0, zoom=2.0)
    whole = camera_around_bake(cornell_patient, azimuth=90, elevation=0)
    assert camera.position[0] > camera.target[0] + 1
    np.testing.assert_allclose(camera.position[1:], camera.target[1:], atol=1e-9)
    distances = [x.position[0] - x.target[0] for x in (whole, camera)]
    assert distances[0] == pytest.approx(2 * distances[1])


def test_tones():
    """Checks that Khronos PBR Neutral ascends above 0.8, and approaches white from below."""
    grays = np.linspace(0, 20, 2001)[:, None] * np.ones(3)
    shown = tone_mapped(grays)
    np.testing.assert_array_equal(shown[grays <= 0.8], np.float32(grays[grays <= 0.8]))
    assert (np.diff(shown[:, 0]) > 0).all() and shown.max() < 1
    red = tone_mapped([[2.0, 0.2, 0.1], [200.0, 20.0, 10.0]])
    assert red[0, 0] > 2 * red[0, 1] and red[1].min() > 0.9
    white = np.full((2, 2, 4), 8.0, np.float32) / [1, 1, 1, 8]
    assert photographed(white, 1.0)[..., :3].max() < 255


@pytest.mark.parametrize("times", [0.1, 1.0, 10.0])
def test_less_than_a_hundredth_clips_whatever_the_lamps(times):
    lamp = replace(SUN, irradiance=(2.0 * times,) * 3)
    scene = SceneDescription("sun", [Isosurfaces("block", (0.8,) * 3)], 1.0, [], [lamp])
    bake = lit(block(20, 20, 20), scene)
    stops = metered_stops(bake)
    picture = leaflight.still(bake, 0.5, size=(160, 90), samples=1)
    pixels = photographed(picture, 2.0**stops)[picture[..., 3] > 0][:, :3]
    assert (pixels.max(axis=1) >= 255).mean() < 0.01 and 100 < pixels.max()
    assert (stops == 0) == (times == 1.0)
    brightest = np.quantile(picture[picture[..., 3] > 0][:, :3].max(axis=1), 0.99) * 2.0**stops
    assert brightest < 1.1 * BRIGHTEST


def test_walls_without_baked_light_are_shaded_locally(cornell_patient):
    """Checks walls without baked light, and baked walls with local shading."""
    camera = camera_around_bake(cornell_patient, zoom=0.45)
    picture = leaflight.still(cornell_patient, 0.5, camera, (120, 120), samples=1)
    assert (picture[..., 3] == 1).mean() > 0.6
    row = np.flatnonzero(picture[60, :, 3])
    ends = [row[0] + 1, row[-1] - 1]
    colors = picture[60, ends, :3]
    # Seen from the front, the left wall is red, and the right one green.
    assert colors[0, 0] > 3 * colors[0, 1] and colors[1, 1] > 2 * colors[1, 0]
    local = leaflight.still(cornell_patient, 0.5, camera, (120, 120), samples=1, local=True)
    np.testing.assert_allclose(local[60, ends], picture[60, ends])


def test_open_isosurfaces_show_their_shape_inside():
    """Checks that a back without baked light is shaded. The sun cannot reach it."""
    values = np.hypot(*(np.mgrid[:24, :24].astype(np.float32) - 11.5))
    tube = np.repeat((12 - values)[:, None, :], 24, axis=1)  # open towards -y and +y
    volume = leaflight.Volume(np.ascontiguousarray(tube), np.diag([0.1, 0.1, 0.1, 1.0]), "tube")
    scene = SceneDescription("sun", [Isosurfaces("tube", (0.5,) * 3)], 4.0, [], [SUN])
    settings = {"isovalues": (2.0, 6.0), "error": 20.0, "resolution": 16}
    bake = leaflight.bake(volume, scene, **settings)
    camera = camera_around_bake(bake, azimuth=0, elevation=0, isovalue=4.0)
    picture = leaflight.still(bake, 4.0, camera, (90, 90), samples=1)
    inside = picture[45, :, 0][picture[45, :, 3] == 1] * 4.0
    assert len(inside) > 4 and inside.max() < 0.15 and np.ptp(inside) > 0.005


def test_bins_hold_the_same_number_of_steps():
    steps = np.arange(0, 256, dtype=np.uint8).repeat(5)
    assert bin_width(steps, -0.5, 255.5) == 1.0
    thousandths = steps.astype(np.float32) / 1000
    assert bin_width(thousandths, -5e-4, 0.2555) == pytest.approx(1e-3, rel=1e-3)
    # 3000 integers have at most 256 bins of equally many integers; here 12.
    assert bin_width(np.arange(3000), -0.5, 2999.5) == 12.0
    # The number of bins for other values follows from the number of values.
    numbers = np.random.default_rng(1).normal(size=100_000)
    assert 1 / 256 <= bin_width(numbers, -4.0, 4.0) / 8 < 1 / 64
    assert bin_width(numbers[:200], -4.0, 4.0) > 4 * bin_width(numbers, -4.0, 4.0)
