# SPDX-License-Identifier: GPL-3.0-or-later
"""The thesis's estimator and its sampling strategies, by the names that Python and the CLI have."""

import json
from dataclasses import asdict

import leaflight
import numpy as np
import pytest
from leaflight import LeaflightError, PhotonMap, Scattered
from leaflight.flatland import bake_flatland, bump_box_2d

STRATEGIES = ("uniform", "stratified", "importance", "level_set", "letters", "slabs", "regular")


@pytest.fixture
def bake_box(bump_scene, fixed_work):
    def bake(**arguments):
        return leaflight.bake(leaflight.bump_box(16), bump_scene, **{**fixed_work, **arguments})

    return bake


@pytest.fixture
def bake_flat():
    def bake(**arguments):
        return bake_flatland(bump_box_2d(24), samples=8, photons=20_000, **arguments)

    return bake


def brightness(baked):
    radiance, mask = baked.grid.dense("radiance"), baked.grid.mask().astype(bool)
    assert np.isfinite(radiance).all() and (radiance >= 0).all()
    return radiance[mask].mean()


@pytest.mark.parametrize("region", ["sphere", "clipped_sphere", "box", "cylinder", "graph"])
def test_thesis_estimator(bake_box, bake_flat, region):
    """It sees the same light, give or take the blur of so few photons."""
    photon_map = PhotonMap(k=50, region=region)
    for bake in (bake_box, bake_flat):
        baked = bake(estimator="thesis", photon_map=photon_map)
        assert brightness(baked) == pytest.approx(brightness(bake()), rel=0.3)


def test_photon_map_settings_matter(bake_box):
    """A wider reach in the range, and a nearer limit in space, count other photons."""
    results = [
        bake_box(estimator="thesis", photon_map=photon_map).grid.dense("radiance")
        for photon_map in (PhotonMap(), PhotonMap(g=1.0), PhotonMap(k=20), PhotonMap(radius=0.05))
    ]
    for i, result in enumerate(results):
        assert not any(np.array_equal(result, other) for other in results[:i])


@pytest.mark.slow
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_scattered_samples(bake_box, bake_flat, strategy):
    for bake in (bake_box, bake_flat):
        baked = bake(scattered=Scattered(strategy, 4000, isovalues=5))
        truth = bake()
        np.testing.assert_array_equal(baked.grid.mask(), truth.grid.mask())
        assert brightness(baked) == pytest.approx(brightness(truth), rel=0.5)


def test_level_sets_of_given_isovalues(bake_flat):
    """Samples on one isoline tell nothing of others but what is next to it."""
    at_50, at_150 = (
        bake_flat(scattered=Scattered("level_set", 2000, isovalues=(c,), radius=50))
        for c in (50.0, 150)
    )
    truth = bake_flat()
    for isovalue, near, far in ((50.0, at_50, at_150), (150.0, at_150, at_50)):
        points = truth.isolines(isovalue).vertices
        near, far = (
            np.abs(b.radiance(points) - truth.radiance(points)).mean() for b in (near, far)
        )
        assert near < 0.5 * far
    with pytest.raises(LeaflightError, match="500.*not in the isovalue window"):
        bake_flat(scattered=Scattered("level_set", 10, isovalues=[50.0, 500.0]))


def test_filters(bake_flat):
    results = [
        bake_flat(scattered=Scattered("uniform", 300, filter=name, radius=radius)).texture()
        for name, radius in (("shepard", 3), ("tent", 3), ("box", 3), ("box", 1))
    ]
    for i, result in enumerate(results):
        assert not any(np.array_equal(result, other) for other in results[:i])


def test_metadata(bake_box, tmp_path):
    scattered = Scattered("importance", 500, filter="tent", radius=2)
    baked = bake_box(estimator="thesis", scattered=scattered)
    assert json.loads(baked.metadata["photon_map"]) == asdict(PhotonMap())
    assert json.loads(baked.metadata["scattered"]) == asdict(scattered)
    baked.save(tmp_path / "x.vdb")
    assert leaflight.load_bake(tmp_path / "x.vdb").metadata == baked.metadata
    plain = bake_box().metadata
    assert plain["photon_map"] == plain["scattered"] == "null"


@pytest.mark.parametrize(
    "arguments, sentence",
    [
        ({"photon_map": PhotonMap()}, 'not to "gather"'),
        ({"estimator": "thesis", "photon_map": PhotonMap(k=1)}, "k must be a whole number"),
        ({"estimator": "thesis", "photon_map": PhotonMap(g=0.0)}, "g, the weight"),
        ({"estimator": "thesis", "photon_map": PhotonMap(radius=-1.0)}, "radius"),
        ({"estimator": "thesis", "photon_map": PhotonMap(region="cube")}, "cube"),
        ({"scattered": Scattered("magic", 10)}, "magic"),
        ({"scattered": Scattered("uniform", 0)}, "count must be"),
        ({"scattered": Scattered("uniform", 10.5)}, "count must be"),
        ({"scattered": Scattered("level_set", 10, isovalues=0)}, "isovalues must be"),
        ({"scattered": Scattered("uniform", 10, filter="wavelet")}, "wavelet"),
        ({"scattered": Scattered("uniform", 10, radius=-1)}, "radius must be"),
        ({"scattered": Scattered("uniform", 10, filter="tent", radius=99)}, "radius"),
    ],
)
def test_bad_settings(bake_box, bake_flat, arguments, sentence):
    for bake in (bake_box, bake_flat):
        with pytest.raises(LeaflightError, match=sentence):
            bake(**arguments)


BAKE = ["--samples", "2", "--photons", "2000", "--dims", "8"]


def test_command_line(cli, tmp_path):
    out = tmp_path / "x.vdb"
    outcome = cli(
        *("bake", "bump_box", "--out", out, *BAKE, "--estimator", "thesis"),
        *("--k", "30", "--g", "5", "--region", "graph", "--photon-radius", "0.5"),
        *("--strategy", "level_set", "--count", "500", "--isovalue-count", "4"),
        *("--filter", "tent", "--filter-radius", "2"),
    )
    assert outcome.status == 0, outcome.err
    metadata = leaflight.load_bake(out).metadata
    assert json.loads(metadata["photon_map"]) == asdict(PhotonMap(30, 0.5, 5.0, "graph"))
    assert json.loads(metadata["scattered"]) == asdict(Scattered("level_set", 500, 4, "tent", 2))
    outcome = cli(
        *("flatland", "bump_box", "--out", tmp_path / "x.exr", *BAKE),
        *("--strategy", "letters", "--count", "500"),
    )
    assert outcome.status == 0, outcome.err


@pytest.mark.parametrize(
    "arguments, sentence",
    [
        (["--k", "50"], "estimator"),
        (["--strategy", "uniform"], "--count"),
        (["--filter", "tent"], "--strategy"),
        (["--strategy", "magic", "--count", "5"], "level_set"),
        (["--estimator", "thesis", "--region", "cube"], "clipped_sphere"),
    ],
)
def test_command_line_errors(cli, tmp_path, arguments, sentence):
    outcome = cli("bake", "bump_box", "--out", tmp_path / "x.vdb", *BAKE, *arguments)
    assert outcome.status == 2 and sentence in outcome.err
    assert list(tmp_path.iterdir()) == []
