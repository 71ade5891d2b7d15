# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests bakes with fixed samples: estimators and strategies by their names."""

import gc
from dataclasses import asdict, fields
from typing import get_type_hints

import leaflight
import numpy as np
import pytest
from leaflight import _core
from leaflight.bake.statistics import outcome
from leaflight.flatland import bump_box_2d
from outcomes import refused

# No package contains them; the fixture `thesis` of other tests wants them in the build tree.
thesis = pytest.importorskip("thesis")
from thesis.settings import FixedSamples, PhotonMap, SampleOptions, Scattered  # noqa: E402

STRATEGIES = ("uniform", "stratified", "importance", "level_set", "letters", "slabs", "regular")


@pytest.fixture
def bake_box(bump_scene, fixed_work):
    def bake(**arguments):
        return thesis.bake(leaflight.bump_box(16), bump_scene, **{**fixed_work, **arguments})

    return bake


@pytest.fixture
def bake_flat():
    def bake(**arguments):
        settings = {"samples": 8, "photons": 20_000, **arguments}
        return thesis.bake_flatland(bump_box_2d(24), **settings)

    return bake


def brightness(baked):
    radiance, mask = baked.grid.dense("radiance"), baked.grid.mask().astype(bool)
    assert np.isfinite(radiance).all() and (radiance >= 0).all()
    return radiance[mask].mean()


@pytest.mark.parametrize("region", ["sphere", "clipped_sphere", "box", "cylinder", "graph"])
def test_thesis_estimator(bake_box, bake_flat, region):
    """Checks for the same light, except for the blur of few photons."""
    photon_map = PhotonMap(k=50, region=region)
    for bake in (bake_box, bake_flat):
        baked = bake(estimator="thesis", photon_map=photon_map)
        assert brightness(baked) == pytest.approx(brightness(bake()), rel=0.3)


def test_photon_map_settings_matter(bake_box):
    """Checks that the weight of the range and the radius change the result."""
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
    """Checks that samples on one isoline light only texels near it."""
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
    refused("500.*range", bake_flat, scattered=Scattered("level_set", 10, isovalues=[50.0, 500.0]))


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
    record = baked.provenance.fixed
    assert record["photon_map"] == asdict(PhotonMap()) and record["scattered"] == asdict(scattered)
    assert record["estimator"] == "thesis" and record["photons"] == record["caustic_photons"]
    baked.save(tmp_path / "x.vdb")
    assert leaflight.load_bake(tmp_path / "x.vdb").provenance == baked.provenance
    plain = bake_box()
    record = plain.provenance.fixed
    assert record["photon_map"] is None and record["scattered"] is None
    assert plain.id != baked.id != bake_box(samples=3).id
    assert plain.provenance.error is None and plain.provenance.passes == 0
    assert outcome(plain) == ""
    assert plain.statistics.estimated_error_percent is None


def test_only_some_texels(bump_scene, fixed_work):
    """Checks that a bake only for lookups at some points gives the same light there."""
    volume, settings = leaflight.bump_box(12), {**fixed_work, "estimator": "path"}
    points = np.random.default_rng(1).uniform(0.2, 0.8, (5, 3)) @ np.diag([11.0] * 3)
    points = (np.c_[points, np.ones(5)] @ volume.index_to_world.T)[:, :3]
    whole = thesis.bake(volume, bump_scene, **settings)
    some = thesis.bake(volume, bump_scene, only_at=points, **settings)
    np.testing.assert_array_equal(some.radiance(points), whole.radiance(points))
    assert whole.radiance(points).min() > 0
    assert 8 <= some.grid.texels <= 40 < whole.grid.texels
    assert some.provenance.fixed["only_at_sha256"]
    assert not whole.provenance.fixed["only_at_sha256"]
    refused("only_at is empty", thesis.bake, volume, bump_scene, only_at=points[:0], **settings)
    refused("all texels", thesis.bake, volume, bump_scene, only_at=points, **fixed_work)


@pytest.mark.parametrize("far", [np.nan, np.inf, 1e19, -1e308])
def test_points_are_in_bounds(bump_scene, fixed_work, far):
    points = np.full((3, 3), 0.5)
    points[1, 2] = far
    settings = {**fixed_work, "estimator": "path", "only_at": points}
    refused("1e18", thesis.bake, leaflight.bump_box(8), bump_scene, **settings)


def test_a_fixed_amount_of_work_is_neither_continued_nor_relit_nor_moved(bump_scene, fixed_work):
    volume = leaflight.bump_box(8)
    baked = thesis.bake(volume, bump_scene, **fixed_work)
    refused("fixed amount", leaflight.refine, baked, error=0.1)
    refused("no exact direct light", baked.relit, {bump_scene.lights[0].name: 2})
    refused("no exact direct light", baked.moved, volume, bump_scene)


def test_large_arrays_are_counted_right(bump_scene, fixed_work):
    """Checks that no array of one compiled module ends in the other."""
    volume, before = leaflight.bump_box(100), _core.large_memory()
    thesis.bake(volume, bump_scene, **{**fixed_work, "samples": 1, "resolution": 8})
    del volume
    gc.collect()
    assert _core.large_memory() == before


def test_options_are_the_settings_by_their_names():
    types = {one.name: one.type for one in fields(FixedSamples)}
    assert types == get_type_hints(SampleOptions)


@pytest.mark.parametrize(
    "arguments, sentence",
    [
        ({"samples": 0}, "samples"),
        ({"samples": 2.5}, "samples"),
        ({"photons": -1}, "photons"),
        ({"estimator": "magic"}, "magic"),
        ({"photon_map": PhotonMap()}, 'not to "gather"'),
        ({"estimator": "thesis", "photon_map": PhotonMap(k=1)}, "k must"),
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
        refused(sentence, bake, **arguments)
