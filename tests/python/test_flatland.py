# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests Flatland: isolines of images, lit within the plane."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest
from cone import cone
from leaflight import Cancelled, Checkpoint, Progress, _core, flatland
from leaflight.flatland import bake_flatland, bump_box_2d, picture, read_image
from leaflight.flatland.flat_scene import fit_flat_scene, flat_box, load_flat_scene
from outcomes import refused, written
from PIL import Image

SMALL = {"error": 2.0, "resolution": 60, "isovalues": (20.0, 200.0)}


@pytest.fixture(scope="module")
def baked():
    return bake_flatland(bump_box_2d(60), **SMALL)


def test_bump_box():
    box = bump_box_2d(50)
    assert box.values.shape == (50, 50) and box.field().range == pytest.approx((0, 255), abs=1e-3)
    np.testing.assert_allclose(box.field().bounds, [[0, 0], [1, 1]])
    # It increases towards y = 1, and has the bumps that disappear with z = 0.
    assert box.values[-1].mean() > box.values[0].mean() + 40
    assert box.field().sample([[0.4, 0.5]]) > box.field().sample([[0.4, 0.6]]) + 20


def test_read_image(tmp_path):
    path = tmp_path / "slope.png"
    Image.fromarray(np.arange(15, dtype=np.uint8).reshape(3, 5) * 10).save(path)
    volume = read_image(path)
    # y is up, and the longest side is 1.
    np.testing.assert_array_equal(volume.values[0], [100, 110, 120, 130, 140])
    np.testing.assert_allclose(volume.field().bounds, [[0, 0], [1, 0.5]])
    assert volume.name == "slope" and volume.values.dtype == np.float32


@pytest.mark.parametrize("pixels", [np.full((4, 4), 7), np.zeros((1, 9))])
def test_image_without_isolines(tmp_path, pixels):
    path = tmp_path / "flat.png"
    Image.fromarray(pixels.astype(np.uint8)).save(path)
    refused("flat.png", read_image, path)


def test_isolines_lie_on_their_isovalue():
    field = bump_box_2d(60).field()
    vertices, normals, segments = _core.contour2(field, 47)
    np.testing.assert_allclose(field.sample(vertices), 47, atol=0.01)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
    # The outside, which has lower values, is on the left.
    along = vertices[segments[:, 1]] - vertices[segments[:, 0]]
    left = np.stack([-along[:, 1], along[:, 0]], axis=1)
    assert ((left * normals[segments[:, 0]]).sum(axis=1) > 0).mean() > 0.98


def test_lit_isolines_are_those_of_path_tracing(baked):
    lines = baked.isolines(100.0)
    assert lines.radiance.shape == (len(lines.vertices), 3)
    middles = lines.vertices[lines.segments].mean(axis=1)
    truth, error = baked.reference(middles, 100.0, spp=512)
    difference = baked.radiance(middles) - truth
    assert truth.mean() > 0.1
    assert abs(difference.mean()) < 0.04 * truth.mean()
    assert np.sqrt((difference**2).mean()) < 0.12 * truth.mean()


def test_walls_color_their_side(baked):
    texture = baked.texture()
    assert texture.shape == (60, 60, 3)
    red, green = texture[..., 0], texture[..., 1]
    assert red[20:, 2:15].mean() > 1.3 * green[20:, 2:15].mean()
    assert green[20:, -15:-2].mean() > 1.3 * red[20:, -15:-2].mean()


def test_same_for_any_number_of_threads():
    box = bump_box_2d(20)
    one, two = (bake_flatland(box, threads=threads, **SMALL) for threads in (1, 2))
    np.testing.assert_array_equal(one.texture(), two.texture())


def test_furnace():
    """Checks that a white isoline between equally bright white walls is as bright as the walls."""
    side = np.array([[-1.5, -1.5], [1.5, -1.5], [1.5, 1.5], [-1.5, 1.5]], dtype=np.float32)
    segments = np.array([[0, 1], [1, 2], [2, 3], [3, 0]], dtype=np.uint32)
    wall = _core.Mesh2("wall", side, segments, (0.5,) * 3, emission=(1.0,) * 3)
    field = bump_box_2d(40).field()
    volume = _core.Volume2("box", field, [(0, (0.5,) * 3)], emission=[(0, (1.0,) * 3)])
    scene = _core.Scene2([volume], [wall], [], isovalues=(20, 200))
    vertices, _, segments = _core.contour2(field, 90.0)
    radiance, error = _core.reference2(scene, vertices[segments].mean(axis=1), 90.0, 256)
    # The radiance is emission / (1 - albedo).
    np.testing.assert_allclose(radiance.mean(), 2, rtol=0.02)


def test_picture(baked):
    """Checks that isolines are lit, bright and thick enough, and that the image behind is gray."""
    # Lower isolines have dark pockets, which are gray, too.
    pixels = picture(baked, [70.0, 100.0], width=600)
    assert pixels.shape == (600, 600, 3) and pixels.dtype == np.uint8
    gray = np.ptp(pixels, axis=2) == 0
    assert 0.02 < 1 - gray.mean() < 0.1
    light = pixels[~gray].max(axis=1)
    assert np.quantile(light, 0.95) > 200 and (light == 255).mean() < 0.06
    # Lines in a picture 600 pixels wide must be a few pixels thick.
    assert (~gray[:, 300]).sum() >= 4 * 2
    # The image is behind the lines; its nodes lie on a grid from border to border.
    values = baked.volume.values[::-1]
    nodes = np.rint(np.linspace(0, 599, len(values))).astype(int)
    there = pixels[np.ix_(nodes, nodes)]
    seen = np.ptp(there, axis=2) == 0
    expected = 255 * 0.5 * values / values.max()
    assert np.abs(there[..., 0] - expected)[seen].max() < 4


def test_a_picture_of_dim_lamps_is_exposed(baked):
    box = flat_box()
    dim = [replace(lamp, radiance=tuple(np.divide(lamp.radiance, 1024))) for lamp in box.lamps]
    dim = bake_flatland(bump_box_2d(60), replace(box, lamps=dim), **SMALL)
    pixels = [picture(one, [100.0], width=200) for one in (baked, dim)]
    np.testing.assert_array_equal(*pixels)


def test_isovalue_outside_the_range(baked):
    for isovalue in (19.0, 201.0, float("nan")):
        refused(r"20\.\.200", baked.isolines, isovalue)


@pytest.mark.parametrize(
    "arguments, sentence",
    [
        ({"isovalues": (70, 30)}, "empty"),
        ({"isovalues": (300, 400)}, "outside the data"),
        ({"error": 0}, "error"),
        ({"resolution": (8, 8, 8)}, "resolution"),
    ],
)
def test_bad_settings(arguments, sentence):
    refused(sentence, bake_flatland, bump_box_2d(8), **{**SMALL, **arguments})


def test_box_fits_any_image():
    box = bump_box_2d(8)
    fitted = fit_flat_scene(flat_box(), box)
    points = np.concatenate([wall.vertices for wall in fitted.walls])
    np.testing.assert_allclose(points.min(axis=0), -0.05, atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0), 1.05, atol=1e-6)
    (lamp,) = fitted.lamps
    # The lamp is at the bottom and shines up, to the left of an edge along +x.
    assert lamp.corner[1] < 0 and lamp.edge[0] > 0 and lamp.edge[1] == 0
    assert fit_flat_scene(fitted, box) is fitted


GOOD = {
    "name": "box",
    "coordinates": "world",
    "isosurface_albedo": [0.5, 0.5, 0.5],
    "exposure": 1,
    "meshes": [
        {"name": "wall", "albedo": [1, 1, 1], "vertices": [[0, 0], [1, 0]], "segments": [[0, 1]]}
    ],
    "lights": [{"name": "lamp", "corner": [0, 0], "edge": [1, 0], "radiance": [1, 1, 1]}],
}


@pytest.mark.parametrize(
    "place, value, sentence",
    [
        (["meshes", 0, "vertices"], [[0, 0, 0], [1, 0, 0]], r'mesh "wall".*\[x, y\]'),
        (["meshes", 0, "segments"], [[0, 2]], 'mesh "wall".*segments.*0..1'),
        (["meshes", 0, "segments"], [], 'mesh "wall".*empty'),
        (["meshes", 0, "faces"], [[0, 1]], 'mesh "wall".*key "faces" is unknown'),
        (["lights", 0, "edge"], [0, 0], 'light "lamp".*edge'),
        (["lights", 0, "edge"], [0, 1, 0], 'light "lamp".*two numbers'),
        (["lights", 0, "radiance"], [0, 0, -1], 'light "lamp".*not negative'),
        (["isosurface_albedo"], [2, 0, 0], "isosurface_albedo"),
        (["exposure"], 0, "exposure"),
    ],
)
def test_bad_scene_names_the_object(tmp_path, place, value, sentence):
    data = copy.deepcopy(GOOD)
    target = data
    for key in place[:-1]:
        target = target[key]
    target[place[-1]] = value
    path = written(tmp_path / "flat.json", json.dumps(data))
    refused(f"flat.json.*{sentence}", load_flat_scene, path)


def test_passes_and_an_interruption(tmp_path):
    settings = {"resolution": 60, "isovalues": (30.0, 70.0), "error": 0.05, "time": 600}
    volume = cone(40, is_open=True, dimensions=2)
    passes = []
    whole = bake_flatland(volume, on_pass=passes.append, **settings)
    assert len(passes) == whole.statistics.passes - 1 > 0
    assert len({whole.id, *(one.id for one in passes)}) == len(passes) + 1
    assert all(one.texture().mean() > 0.01 for one in passes)

    progress = Progress()
    path = tmp_path / "flat.checkpoint"
    arguments = {"checkpoint": Checkpoint(path, seconds=0.0), "progress": progress, **settings}
    with pytest.raises(Cancelled):
        bake_flatland(volume, on_pass=lambda _: progress.cancel(), **arguments)
    resumed = bake_flatland(volume, checkpoint=Checkpoint(path, resume=True), **settings)
    assert resumed.id == whole.id
    np.testing.assert_array_equal(resumed.texture(), whole.texture())
    other = {**settings, "seed": 1, "checkpoint": Checkpoint(path, resume=True)}
    refused("belongs to another bake", bake_flatland, volume, **other)


@pytest.mark.parametrize("name", ["both_sides", "walls"])
def test_light_that_it_does_not_hold_is_refused(name):
    refused(f"not {name}: leave it out", bake_flatland, bump_box_2d(20), **{name: True})


@pytest.fixture(scope="module")
def direct_bake():
    """Returns the 2D bump box with black walls and hardly any interreflection."""
    scene = flatland.flat_box()
    dark = replace(
        scene,
        walls=[replace(wall, albedo=(0.0, 0.0, 0.0)) for wall in scene.walls],
        isosurfaces=replace(scene.isosurfaces, albedo=(0.02, 0.02, 0.02)),
    )
    return flatland.bake_flatland(flatland.bump_box_2d(61), dark, resolution=61)


def _flattened(bake):
    """Returns the corrected texture at the centers of cells, and a mask of known texels."""
    texture = bake.texture() * flatland.BRIGHTNESS_CORRECTION
    known = bake.grid.mask() > 0
    corners = [(slice(a, a - 1 or None), slice(b, b - 1 or None)) for a in (0, 1) for b in (0, 1)]
    mean = sum(texture[corner] for corner in corners) / 4
    return mean, np.logical_and.reduce([known[corner] for corner in corners])


def test_the_mesh_is_the_graph(thesis):
    volume = flatland.bump_box_2d(9)
    vertices, triangles = thesis.graph_mesh(volume, 2.0)
    assert vertices.shape == (81, 3) and triangles.shape == (128, 3)
    np.testing.assert_allclose(vertices[:, 2].reshape(9, 9), volume.values / 127.5, rtol=1e-5)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_a_steep_graph_is_lit_as_by_flattened_light(thesis, direct_bake):
    # Walls of infinite height and lamps repeat along z. Light in space then equals light in the
    # plane with the factor 2/pi (thesis 3.4.3). The graph is flat, so it sees the lamp at an angle.
    flattened, known = _flattened(direct_bake)
    ratios = []
    for height in (1.0, 4.0, 32.0):
        ordinary, _ = thesis.graph_radiance(direct_bake, height=height, spp=1024)
        ratios.append(flattened[known].mean() / ordinary[known].mean())
    assert ratios[0] > ratios[1] > ratios[2]
    assert ratios[2] == pytest.approx(1, abs=0.06)
    # Single points agree, too, except for the mesh's facets and noise.
    assert np.corrcoef(flattened[known].ravel(), ordinary[known].ravel())[0, 1] > 0.95
