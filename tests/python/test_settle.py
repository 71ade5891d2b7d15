# SPDX-License-Identifier: GPL-3.0-or-later
"""Isosurfaces that settle: in Python, on the command line, and compared with the path tracer."""

import json

import leaflight
import numpy as np
import pytest
from leaflight import LeaflightError
from leaflight.scene.on_mesh import interpolated, positions, random_places


def _between_vertices(bake, surface, isovalue, volume=0, back=False, step=1):
    """What a surface shows amid its triangles, and what the path tracer finds there."""
    triangles = surface.triangles[::step]
    middles = surface.vertices[triangles].mean(axis=1, dtype=np.float64)
    field = bake.volumes[volume].field()
    own = bake.isovalue_of(volume, isovalue)
    points = leaflight._core.project_to_leaf(field, middles, own)
    truth, _ = bake.reference(points, isovalue, spp=128, volume=volume, back=back)
    return surface.radiance[triangles].mean(axis=1), truth


@pytest.mark.slow
def test_a_settled_surface_is_the_baked_one_in_better_light(box_bake):
    baked = box_bake.surface(47.0)
    settled = box_bake.surface(47.0, settle=True)
    # The same mesh, each edge cut in two twice.
    np.testing.assert_array_equal(settled.vertices[: len(baked.vertices)], baked.vertices)
    assert len(settled.triangles) == 16 * len(baked.triangles)
    assert baked.error is None and settled.error.shape == (len(settled.vertices),)
    assert settled.radiance.shape == settled.vertices.shape and (settled.radiance >= 0).all()

    def error(surface):
        shown, truth = _between_vertices(box_bake, surface, 47.0)
        return np.sqrt(np.mean((shown - truth) ** 2)), shown.mean() / truth.mean()

    # 20^3 texels and 4 samples a texel.
    assert error(settled)[0] < 0.6 * error(baked)[0]
    assert abs(error(settled)[1] - 1) < 0.03


@pytest.mark.slow
def test_settling_does_not_depend_on_threads(box_bake):
    one = box_bake.surface(47.0, settle=True, threads=1)
    two = box_bake.surface(47.0, settle=True, threads=2)
    np.testing.assert_array_equal(one.radiance, two.radiance)
    np.testing.assert_array_equal(one.error, two.error)
    other = box_bake.surface(47.0, settle=True, seed=1)
    assert not np.array_equal(one.radiance, other.radiance)


def test_rounds_improve_what_there_is(box_bake):
    settling = box_bake.settling(47.0, *box_bake.contour(47.0, at_rest=True))
    progress = leaflight.Progress()
    rays = [settling.rays]
    while settling.rounds_done < settling.rounds:
        settling.refine(progress)
        rays.append(settling.rays)
    assert len(rays) == settling.rounds + 1 and rays == sorted(rays) and rays[0] < rays[1]
    assert progress.stage == "Light of the isosurface at rest" and progress.fraction > 0
    whole = box_bake.surface(47.0, settle=True)
    np.testing.assert_array_equal(settling.settled()[0], whole.radiance)
    settling.refine(progress)  # nothing is left to do
    assert settling.rays == rays[-1]


@pytest.mark.slow
def test_seconds_end_it_early(box_bake):
    # Over before the first round is.
    early = box_bake.surface(47.0, settle=1e-9)
    whole = box_bake.surface(47.0, settle=True)
    assert early.radiance.shape == whole.radiance.shape
    assert not np.array_equal(early.radiance, whole.radiance)
    with pytest.raises(LeaflightError, match="allow it more"):
        box_bake.surface(47.0, settle=0.0)


def test_a_cancelled_surface(box_bake):
    progress = leaflight.Progress()
    progress.cancel()
    with pytest.raises(leaflight.Cancelled):
        box_bake.surface(47.0, settle=True, progress=progress)


@pytest.mark.slow
def test_the_inner_side_settles_without_having_been_baked(root):
    scene = leaflight.load_scene(root / "scenes" / "both_sides.json")
    bake = leaflight.bake(
        leaflight.bump_box(20), scene, samples=4, photons=20_000, isovalues=(30.0, 70.0)
    )
    back = bake.surface(47.0, back=True, settle=True)
    front = bake.surface(47.0, settle=True)
    np.testing.assert_array_equal(back.normals, -front.normals)
    shown, truth = _between_vertices(bake, back, 47.0, back=True)
    assert truth.mean() > 0.01
    assert abs(shown.mean() / truth.mean() - 1) < 0.05


@pytest.mark.slow
@pytest.mark.parametrize("volume", [0, 1])
@pytest.mark.parametrize("back", [False, True])
def test_several_volumes_settle_each_by_itself(lapr_bake, volume, back):
    settled = lapr_bake.surface(0.5, volume, back, settle=True)
    shown, truth = _between_vertices(lapr_bake, settled, 0.5, volume, back, step=5)
    assert truth.mean() > 0.004  # little light gets inside
    assert abs(shown.mean() / truth.mean() - 1) < (0.15 if back else 0.05)


@pytest.mark.slow
def test_compare_measures_what_is_shown(box_bake):
    baked = leaflight.compare(box_bake, 47.0, points=1500, spp=128)
    settled = leaflight.compare(box_bake, 47.0, points=1500, spp=128, settle=True)
    assert baked["settle_seconds"] is None and settled["settle_seconds"] > 0
    # Direct light is exact in both; paths mend indirect light.
    assert settled["rms_percent"] < baked["rms_percent"]
    assert abs(settled["mean_ratio"] - 1) < 0.03
    assert settled["parts"]["noise_percent"] > 0
    with pytest.raises(LeaflightError, match="Only isosurfaces settle"):
        leaflight.compare(box_bake, 47.0, mesh="left wall", settle=True)


def _last_json(outcome):
    assert outcome.status == 0, outcome.err
    return json.loads(outcome.out.splitlines()[-1])


@pytest.mark.slow
def test_command_line(box_file, cli, tmp_path):
    arguments = [box_file, "--isovalue", 47, "--out", tmp_path / "x.ply", "--json"]
    baked = _last_json(cli("surface", *arguments))
    first = (tmp_path / "x.ply").read_bytes()
    settled = _last_json(cli("surface", *arguments, "--settle"))
    assert baked["settled"] is False and settled["settled"] is True
    assert settled["vertices"] > 10 * baked["vertices"]
    assert (tmp_path / "x.ply").read_bytes() != first
    points = ["--isovalue", 47, "--points", 100, "--spp", 32]
    result = _last_json(cli("compare", box_file, *points, "--settle", "--json"))
    assert result["settle_seconds"] > 0
    outcome = cli("compare", box_file, *points, "--settle", "--mesh", "left wall")
    assert outcome.status == 2 and "(--settle)" in outcome.err


def test_values_are_found_between_the_vertices_of_a_large_mesh(box_bake):
    surface = box_bake.surface(47.0)
    facets, coordinates = random_places(surface.vertices, surface.triangles, 400, 5)
    points = positions(surface.vertices, surface.triangles, facets, coordinates)
    a, b, c = (surface.radiance[surface.triangles[facets, k]] for k in range(3))
    expected = a + coordinates[:, :1] * (b - a) + coordinates[:, 1:] * (c - a)
    found = interpolated(surface.vertices, surface.triangles, surface.radiance, points)
    np.testing.assert_allclose(found, expected, atol=1e-4)
    # A point beside the mesh takes the nearest triangle.
    far = interpolated(surface.vertices, surface.triangles, surface.radiance, points[:1] + 9.0)
    assert np.isfinite(far).all()
