# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the comparison of a bake with path tracing, and its points on meshes."""

from dataclasses import replace

import leaflight
import numpy as np
import pytest
from leaflight.measure.cycles import _lay_out, _pack, wall
from leaflight.measure.flip import flip
from leaflight.measure.truth import Truth, parts_of
from leaflight.scene.on_mesh import interpolated, positions, random_places, random_points
from leaflight.scene.scene import Mesh
from outcomes import refused, written


def test_random_points_are_uniform_over_the_area():
    # A square of side 3 as two triangles, and a far one without area.
    vertices = np.array(
        [[0, 0, 5], [3, 0, 5], [3, 3, 5], [0, 3, 5], [99, 99, 99]], dtype=np.float32
    )
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 4, 4]], dtype=np.int32)
    points = random_points(vertices, triangles, 20_000, seed=1)
    assert points.shape == (20_000, 3) and (points[:, 2] == 5).all()
    counts, _, _ = np.histogram2d(points[:, 0], points[:, 1], bins=4, range=[[0, 3], [0, 3]])
    # 16 cells of 1250 expected points: six standard deviations.
    np.testing.assert_allclose(counts, 1250, atol=6 * np.sqrt(1250))


def test_compare(box_bake):
    result = leaflight.compare(box_bake, 47.0, points=200, spp=64)
    assert result["points"] == 200 and result["spp"] == 64 and result["triangles"] > 100
    # With 20^3 texels and 4 samples, expect only the right order of magnitude.
    assert 0 < result["rms_percent"] < 25
    assert 0 < result["relative_rms"] < 1
    assert 0 < result["reference_noise_percent"] < 10
    assert 0.1 < result["mean_radiance"] < 1
    assert result["bake_seconds"] == box_bake.statistics.seconds
    assert result["reference_seconds"] > 0
    exposed = result["exposed"]
    assert 0 < exposed["points"] <= 200 and 0 < exposed["rms_percent"] < 25
    # The parts and the reference's noise add up to the whole, unless noise alone exceeds it.
    parts = result["parts"]
    assert parts["mesh_percent"] is None and parts["noise_percent"] > 0
    squares = [parts["noise_percent"], parts["texture_percent"], result["reference_noise_percent"]]
    assert np.linalg.norm(squares) >= result["rms_percent"] * (1 - 1e-6)
    again = leaflight.compare(box_bake, 47.0, points=200, spp=64, threads=1)
    assert again["rms_percent"] == result["rms_percent"]


def test_parts_of_an_error():
    """Checks that differences of known size are found, each as the right part."""
    rng = np.random.default_rng(3)
    n, weights = 200_000, rng.uniform(0.5, 1.5, 200_000)
    isosurface = rng.uniform(0.3, 0.6, (n, 3))
    noise = 0.02 * rng.normal(size=(n, 1))
    radiance = isosurface + 0.03 * rng.normal(size=(n, 3)) + noise

    def measured(values, error):
        known = np.full((n, 3), error)
        return Truth(None, weights, values + error * rng.normal(size=(n, 3)), known, None)

    path, truth = (
        measured(isosurface, 0.01),
        measured(isosurface + 0.04 * rng.normal(size=(n, 3)), 0.015),
    )
    parts = parts_of(radiance, np.full(n, 0.02), path, truth, 1.0)
    assert parts["noise_percent"] == pytest.approx(2.0)
    assert parts["texture_percent"] == pytest.approx(3.0, rel=0.01)
    assert parts["mesh_percent"] == pytest.approx(4.0, rel=0.01)
    assert parts_of(radiance, np.full(n, 0.02), path, path, 1.0)["mesh_percent"] is None


def test_colors_saturate(box_bake):
    """Checks that an exposure at which all is white hides differences of color alone."""
    white = replace(box_bake, scene=replace(box_bake.scene, exposure=1e9))
    result = leaflight.compare(white, 47.0, points=50, spp=256)
    assert result["rms_percent"] < 1e-6 < result["relative_rms"]
    # Noise must not change white colors.
    assert result["reference_noise_percent"] < 1e-6


def test_exposed_points_are_those_seen_from_outside():
    """Checks a hollow shell: its outer face can be seen from outside, its inner face cannot."""
    x = np.linspace(-1, 1, 33)
    radius = np.sqrt(sum(axis**2 for axis in np.meshgrid(x, x, x)))
    values = np.exp(-(((radius - 0.6) / 0.1) ** 2)).astype(np.float32)
    field = leaflight.Volume(values, np.diag([1.0, 1.0, 1.0, 1.0]), "shell", "shell").field()
    vertices, _, _ = leaflight._core.contour(field, 0.5)
    on_isosurface = leaflight._core.project_to_isosurface(field, vertices, 0.5)
    exposed = leaflight._core.seen_from_outside(field, on_isosurface, 0.5) > 0
    outer = np.linalg.norm(on_isosurface - 16.0, axis=1) > 0.6 * 16
    assert 0.3 < outer.mean() < 0.8
    assert (exposed == outer).mean() > 0.999


@pytest.mark.parametrize("n", [8, 15, 20])
def test_the_border_is_lit(bump_scene, n):
    """Checks that vertices on the border of the domain count, for any index transform."""
    volume = leaflight.bump_box(n)
    baked = leaflight.bake(volume, bump_scene, error=50.0, isovalues=(30.0, 70.0))
    vertices = baked.surface(47.0).vertices
    on_isosurface = leaflight._core.project_to_isosurface(volume.field(), vertices, 47.0)
    on_border = ((vertices == 0) | (vertices == 1)).any(axis=1)
    # The scene is open towards z = 1, so some light arrives even where the lamp is hidden.
    dark = (baked.reference(on_isosurface, 47.0, spp=64)[0] == 0).all(axis=1)
    assert on_border.sum() > 10 and dark[on_border].mean() < 0.02
    moved = on_isosurface + [0.0, 0.0, 1e-9]
    assert ((baked.reference(moved, 47.0, spp=64)[0] == 0).all(axis=1) == dark).all()
    exposed = leaflight._core.seen_from_outside(volume.field(), on_isosurface, 47.0, 32, 0) > 0
    assert exposed[on_border].mean() > 0.5


def test_compare_on_a_wall(lapr_bake):
    result = leaflight.compare(lapr_bake, 0.5, points=300, spp=256, mesh="floor")
    assert result["points"] == 300 and result["triangles"] == 2 and result["exposed"] is None
    assert result["mean_ratio"] == pytest.approx(1, abs=0.03 + 4 * result["mean_ratio_error"])
    assert 0 < result["relative_rms"] < 0.5
    outside = leaflight.compare(lapr_bake, 0.5, points=50, spp=4, mesh="floor", back=True)
    assert outside["mean_radiance"] == 0 and outside["mean_ratio"] is None


FEW = {"points": 10, "spp": 4}


def test_compare_on_walls_needs_them(box_bake, lapr_bake):
    refused("bake again with walls", leaflight.compare, box_bake, 47.0, mesh="far wall", **FEW)
    refused("floor, ceiling", leaflight.compare, lapr_bake, 0.5, mesh="moon", **FEW)


def test_a_mirror_has_no_radiance_of_its_own(box_bake):
    mirror = replace(box_bake.scene.isosurfaces[0], scattering="mirror")
    bake = replace(box_bake, scene=replace(box_bake.scene, isosurfaces=[mirror]))
    refused("depends on the view", leaflight.compare, bake, 47.0, **FEW)


def test_cycles_needs_blender_and_names_its_error(box_bake, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    settings = {"reference": "cycles", **FEW}
    refused("package blender", leaflight.compare, box_bake, 47.0, **settings)
    written(tmp_path / "blender", "#!/bin/sh\necho no display\nexit 3\n").chmod(0o755)
    refused("Blender failed: no display", leaflight.compare, box_bake, 47.0, **settings)


@pytest.mark.parametrize("arguments", [{"points": 0}, {"spp": 0}, {"isovalue": 10.0}])
def test_bad_arguments(box_bake, arguments):
    refused(".", leaflight.compare, box_bake, **{"isovalue": 47.0, **arguments})


@pytest.fixture
def picture():
    """Returns a smooth linear picture from dark to white."""
    y, x = np.mgrid[0:48, 0:64] / 64.0
    return np.stack([x, y, 0.5 * (x + y)], axis=-1).astype(np.float32)


def test_equal_pictures_do_not_differ_and_black_and_white_do_most(picture):
    found = flip(picture, picture)
    assert found.map.shape == (48, 64) and found.mean == 0.0 == found.percentile_95
    assert flip(np.zeros_like(picture), np.ones_like(picture)).mean > 0.9


def test_only_what_is_displayed_counts(picture):
    brighter = np.where(picture > 0.5, 4.0, picture)
    assert flip(2.0 * brighter, 2.0 * picture).mean == 0.0
    assert flip(brighter, picture, exposure=2.0).mean == 0.0
    assert 0.0 < flip(brighter, picture).mean < 1.0


def test_a_patch_is_found_where_it_is(picture):
    other = picture.copy()
    other[20:28, 30:40] += 0.2
    found = flip(other, picture)
    assert found.map[22:26, 32:38].min() > 5 * found.map[:8].max() > -1
    assert found.mean < found.percentile_95


# A bent sheet of three triangles; the last one is much smaller.
VERTICES = np.array([[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0], [3, 0, 0.5]], dtype=np.float32)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]], dtype=np.uint32)
SOME_FLAT = np.array([*TRIANGLES, [0, 0, 1], [2, 2, 2]], dtype=np.uint32)
AREAS = np.array([4.5, 4.5, 0.75])


def linear(points):
    return np.stack([points @ [1.0, 2.0, 3.0], 5.0 - points @ [2.0, 0.0, 1.0]], axis=-1)


@pytest.mark.parametrize("triangles", [TRIANGLES, SOME_FLAT], ids=["all", "some without area"])
def test_what_is_linear_over_the_mesh_is_interpolated_exactly(triangles):
    points = positions(VERTICES, triangles, *random_places(VERTICES, triangles, 500, seed=2))
    found = interpolated(VERTICES, triangles, linear(VERTICES), points)
    np.testing.assert_allclose(found, linear(points), atol=1e-5)


def test_between_the_vertices_of_a_large_mesh(box_bake):
    surface = box_bake.surface(47.0)
    facets, coordinates = random_places(surface.vertices, surface.triangles, 400, 5)
    points = positions(surface.vertices, surface.triangles, facets, coordinates)
    a, b, c = (surface.radiance[surface.triangles[facets, k]] for k in range(3))
    expected = a + coordinates[:, :1] * (b - a) + coordinates[:, 1:] * (c - a)
    found = interpolated(surface.vertices, surface.triangles, surface.radiance, points)
    np.testing.assert_allclose(found, expected, atol=1e-4)
    # A point far from the mesh takes values of the nearest triangle.
    far = interpolated(surface.vertices, surface.triangles, surface.radiance, points[:1] + 9.0)
    assert np.isfinite(far).all()


@pytest.mark.parametrize("sides", [[3, 1, 0, 2, 1, 1], [1], [5], [1] * 100, [0, 40, 1]])
def test_squares_of_pixels_do_not_overlap(sides):
    places, (width, height) = _pack(np.array(sides))
    taken = np.zeros((height, width), dtype=int)
    assert set(places) == {i for i, side in enumerate(sides) if side > 0}
    for number, (x, y) in places.items():
        assert x + sides[number] <= width and y + sides[number] <= height
        taken[y : y + sides[number], x : x + sides[number]] += 1
    assert taken.max() == 1


@pytest.mark.parametrize("count", [1, 3, 400])
def test_probes_lie_where_cycles_bakes_their_pixels(count):
    mesh = wall(Mesh("sheet", VERTICES, TRIANGLES, (0.5, 0.5, 0.5)))
    probes, pixels, (width, height), uv = _lay_out(mesh, count, seed=3)
    assert len(set(pixels)) == len(pixels) >= count
    # Each texture coordinate must be the center of the probe's pixel.
    a, b, c = (uv[probes.facets, k] * [width, height] for k in range(3))
    u, v = probes.coordinates.T[..., None]
    assert (u > 0).all() and (v > 0).all() and (u + v < 1).all()
    centers = np.stack([pixels % width, pixels // width], axis=1) + 0.5
    np.testing.assert_allclose(a + u * (b - a) + v * (c - a), centers, atol=1e-3)
    on_mesh = positions(VERTICES, TRIANGLES, probes.facets, probes.coordinates)
    np.testing.assert_array_equal(probes.points, on_mesh)
    shares = np.bincount(probes.facets, probes.weights, minlength=3)
    assert shares.sum() == pytest.approx(1)
    if count == 400:
        np.testing.assert_allclose(shares, AREAS / AREAS.sum(), atol=4 * np.sqrt(0.25 / count))
