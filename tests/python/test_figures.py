# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the computation of published figures: interpolation, judgment and reference."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from leaflight.bake.estimate import Estimate
from leaflight.bake.statistics import Statistics
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.cycles import VertexBakes
from leaflight.scene.scene import fit_scene, isovalue_at, match_isosurfaces
from leaflight.thesis import Scattered
from leaflight.volume.particles import nucleons
from measure.bench import cycles_peer
from measure.bench.bakes import break_even
from measure.bench.cycles_peer import CORNERS, FEWER, MORE, REFERENCE_PASSES, Peer, cost_at
from measure.judged_bakes import CASES, EXCEEDED, REACHED, REPORTED, TRUE_WITHIN, BakeRow, CyclesRow
from thesis.experiments import Row, Trial, judged
from thesis.isosurfaces import isosurfaces
from volume_recipes import generated


def test_between_two_points_a_power_law_is_exact():
    samples = np.array([1, 4, 16, 64])
    errors, costs = 8 * samples**-0.5, 0.1 * samples
    for wanted in (1, 1.5, 4, 7, 30, 64):
        cost, outside = cost_at(8 * wanted**-0.5, errors, costs)
        assert outside is None and cost == pytest.approx(0.1 * wanted)


@pytest.mark.parametrize(
    "error, found",
    [
        (8.0001, (None, FEWER)),
        (1.9999, (None, MORE)),
        (0.0, (None, MORE)),
        (math.nan, (None, MORE)),
        (8.0, (pytest.approx(0.1), None)),
        (2.0, (pytest.approx(1.6), None)),
    ],
)
def test_nothing_is_read_beyond_the_points(error, found):
    assert cost_at(error, [8.0, 4.0, 2.0], [0.1, 0.4, 1.6]) == found


def test_errors_that_rise_by_chance():
    """Checks that the first two neighbors that enclose the error count, with their seconds."""
    assert 2.0 < cost_at(3.5, [4.0, 5.0, 3.0], [1.0, 2.0, 4.0])[0] < 4.0
    assert 1.0 < cost_at(4.5, [4.0, 5.0, 3.0], [1.0, 2.0, 4.0])[0] < 2.0


def test_a_break_even_outside_is_a_bound():
    assert break_even(6.0, 3.0, None, [1.0, 4.0]) == 2.0
    assert break_even(6.0, None, FEWER, [1.0, 4.0]) == f"above 6: {FEWER}"
    assert break_even(6.0, None, MORE, [1.0, 4.0]) == f"below 1.5: {MORE}"


@pytest.fixture
def peer(monkeypatch):
    """Yields a Cycles whose error is 40 % / sqrt(paths per vertex), and the seeds of its passes."""
    seeds = []

    def noisy_cycles(scene, isovalue, mesh, passes):
        seeds.append({seed for _, seed in passes})
        noise = [np.random.default_rng([s, n]).normal(size=(len(mesh[0]), 3)) for n, s in passes]
        samples = np.array([samples for samples, _ in passes])
        radiance = 0.5 + 0.4 * np.array(noise) / np.sqrt(CORNERS * samples)[:, None, None]
        return VertexBakes(radiance, 1e-3 * samples, 2e-3 * samples, samples)

    monkeypatch.setattr(cycles_peer, "bake_vertices", noisy_cycles)
    mesh = np.zeros((20_000, 3)), None, np.zeros((40_000, 3), int)
    return Peer(SimpleNamespace(exposure=1.0), 1.0, mesh, 4096), seeds


def test_cycles_is_measured_around_the_error(peer):
    cycles, seeds = peer
    # An error of 1 % takes 1600 paths per vertex.
    samples = cycles.reference_samples(1.0, 40 / math.sqrt(1024), 1024)
    assert samples == pytest.approx(1600 / CORNERS, rel=0.01)
    truth, one_pass = cycles.reference(samples)
    assert one_pass == pytest.approx(1.0, rel=0.02)
    counts = cycles.counts(1.0, samples, one_pass)
    assert counts == pytest.approx([samples / 2, samples, 2 * samples], rel=0.05)
    errors, seconds = cycles.measured(counts, 0, truth)
    # The reference's noise is subtracted, and the warm-up pass does not count.
    assert errors == pytest.approx(np.sqrt([2, 1, 0.5]), rel=0.04)
    assert seconds == pytest.approx(1e-3 * np.array(counts))
    cycles.measured(counts, 1, truth)
    reference, first, second = seeds
    assert len(reference) == REFERENCE_PASSES
    assert not (reference & first or reference & second or first & second)


def row_of_cycles(rms, before=1.4, after=1.4, found=2.0):
    statistics = Statistics(2.5, 7, 9, 11, (), passes=3, estimated_error_percent=after)
    estimate = Estimate(2.0, 1, before, 3, 2, 1.0)
    baked = BakeRow(CASES[0], (8, 8, 8), estimate, statistics, found)
    return CyclesRow(baked, None, 47.0, 1024, {"rms_percent": rms}, {}, True)


def test_verdicts_against_cycles():
    """Only a bake that reported a larger error before and afterwards is excused."""
    assert row_of_cycles(1.5).verdict == REACHED
    assert row_of_cycles(1.51, 1.6, 1.6).verdict == REPORTED
    assert row_of_cycles(1.51, 1.4, 1.6).verdict == EXCEEDED
    assert row_of_cycles(1.51, 1.6, 1.4).verdict == EXCEEDED
    assert replace(row_of_cycles(9.0), judged=False).verdict is None
    for found, true in ((2.0, True), (2.0 / TRUE_WITHIN - 0.01, False), (3.01, False)):
        assert row_of_cycles(1.0, 2.0, 2.0, found).bake.true is true


def row_of_thesis(error, strategy="uniform", **options):
    scattered = Scattered(strategy, 100) if strategy else None
    return Row(Trial(strategy or "texels", 100, 1, scattered, **options), error, 1.0)


def test_verdicts_on_the_thesiss_tables():
    rows = judged(
        [
            row_of_thesis(1.2, printed=1.29),
            row_of_thesis(1.29, "importance"),
            row_of_thesis(1.3, "stratified"),
            row_of_thesis(1.3, None),
            row_of_thesis(3.6, "slabs", printed=9.55),
            row_of_thesis(3.5, "level_set"),
            row_of_thesis(9.0, "uniform", judged=False),
        ]
    )
    assert [row.passed for row in rows] == [True, True, False, False, True, False, None]


def test_hidden_vertices_are_not_judged():
    """Checks that no judged point lies inside the other volume's isosurface, without light."""
    volumes = generated(nucleons, 101)(None, 0.2)
    scene = packaged_scene("nucleons.json")
    scene = fit_scene(match_isosurfaces(scene, volumes), volumes)
    found = isosurfaces(volumes, scene, (0.0, 1.0), (0.2,), 400, 1, seed=0)
    for one, other in zip(found.surfaces, reversed(volumes), strict=True):
        own = isovalue_at(scene, 1 - one.volume, 0.2)
        assert (other.field().sample(one.points) < own).all()
        assert (other.field().sample(one.vertices) >= own).any()
