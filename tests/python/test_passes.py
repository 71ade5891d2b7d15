# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests bakes in passes. Each pass gives a complete bake. An error, a time or a stop ends it."""

import math
from dataclasses import replace

import leaflight
import numpy as np
import pytest
from cone import FINE, stopping
from leaflight import Cancelled, Progress, load_bake
from leaflight.bake.estimate import extrapolated
from leaflight.bake.statistics import Statistics, outcome
from leaflight.volume.setting_error import SettingError
from waiting import HANG

ISOVALUES = (30.0, 70.0)
# Error that needs more passes than any of these tests takes.
UNREACHED = 1e-3


def stopped_after(passes, box, **settings):
    """Returns (the bake that was stopped, the bakes of its passes)."""
    how, seen = stopping(passes)
    return box(error=UNREACHED, **how, **settings), seen


def test_each_pass_leaves_a_better_bake(box, tmp_path):
    seen = []
    last = box(resolution=FINE, error=0.5, on_pass=seen.append)
    assert [one.statistics.passes for one in seen] == list(range(1, len(seen) + 1))
    assert last.statistics.passes == len(seen) + 1 > 2
    assert not last.statistics.stopped
    noises = [one.statistics.estimated_noise_percent for one in [*seen, last]]
    assert noises == sorted(noises, reverse=True)
    errors = [one.statistics.estimated_error_percent for one in [*seen, last]]
    assert errors == sorted(errors, reverse=True) and errors[-1] <= 0.5 < errors[0]
    seconds = [one.statistics.seconds for one in [*seen, last]]
    assert seconds == sorted(seconds) and seconds[0] > 0
    assert len({one.id for one in [*seen, last]}) == len(seen) + 1
    points = last.surface(47.0).vertices
    noise = [one.radiance_error(points).mean() for one in (seen[0], last)]
    assert noise[1] < 0.8 * noise[0]
    seen[0].save(tmp_path / "first.vdb")
    first = load_bake(tmp_path / "first.vdb")
    assert first.id == seen[0].id and first.provenance.passes == 1
    light = [one.radiance(points) for one in (first, seen[0])]
    np.testing.assert_allclose(*light, rtol=2**-10, atol=1e-6)


@pytest.mark.slow
def test_a_smaller_error_is_nearer_to_the_truth(box):
    points = box(error=50.0).surface(47.0).vertices[::20]
    # The truth has texels of the same width, so that bakes differ only by noise.
    truth = np.mean([box(error=0.1, seed=seed).radiance(points) for seed in range(1, 9)], axis=0)
    rough, _ = stopped_after(1, box)
    fine = box(error=0.3)
    errors = [np.abs(one.radiance(points) - truth).mean() for one in (rough, fine)]
    assert errors[1] < 0.7 * errors[0]
    noise = [one.radiance_error(points).mean() for one in (rough, fine)]
    assert noise[1] < 0.65 * noise[0]


@pytest.mark.parametrize("passes", [1, 2])
def test_stopped_after_the_same_pass_bits_are_equal(box, passes):
    one, seen = stopped_after(passes, box, threads=1)
    two, _ = stopped_after(passes, box, threads=2)
    assert one.id == two.id and one.provenance == two.provenance
    assert one.statistics.passes == passes == len(seen) and one.statistics.stopped
    for name in ("radiance", "radiance_indirect", "radiance_error"):
        assert one.grid.dense(name).tobytes() == two.grid.dense(name).tobytes()
        # The last state that was shown equals the result.
        assert one.grid.dense(name).tobytes() == seen[-1].grid.dense(name).tobytes()


def test_a_stopped_bake_is_kept_like_any_other(box, tmp_path):
    baked, _ = stopped_after(2, box)
    baked.save(tmp_path / "kept.vdb")
    loaded = load_bake(tmp_path / "kept.vdb")
    assert loaded.id == baked.id and loaded.statistics == baked.statistics
    assert loaded.statistics.stopped and loaded.provenance.passes == 2
    assert loaded.provenance.error == UNREACHED and loaded.provenance.fixed is None
    assert "was not reached: it was stopped or reached its time limit" in outcome(loaded)


def test_the_time_ends_a_bake(box):
    # The time ends before the first pass, so the result is the first picture.
    baked = box(error=UNREACHED, time=1e-9)
    assert baked.statistics.stopped and baked.statistics.passes == 1
    assert baked.surface(47.0).radiance.mean() > 0.01
    assert "to end in time, there are only" in outcome(baked)
    unlimited, limited = box(error=0.3), box(error=0.3, time=HANG)
    assert not limited.statistics.stopped
    assert limited.statistics.passes == unlimited.statistics.passes > 1


@pytest.mark.machine
def test_a_bake_takes_the_time_that_it_has(box):
    baked = box(error=UNREACHED, time=0.3)
    assert baked.statistics.stopped and baked.statistics.passes >= 1
    assert baked.statistics.seconds < 5
    # No block begins that would end too late.
    assert box(error=UNREACHED, time=4.0).statistics.seconds < 1.1 * 4.0


def test_cancelled_after_a_pass(box):
    progress = Progress()
    with pytest.raises(Cancelled):
        box(error=UNREACHED, on_pass=lambda _: progress.cancel(), progress=progress)


def test_what_goes_wrong_in_on_pass_ends_the_bake(box):
    with pytest.raises(ZeroDivisionError):
        box(error=UNREACHED, on_pass=lambda baked: 1 // 0)


def test_what_to_do_where_the_error_was_not_reached(box):
    """Checks the advice after passes end by themselves, by the largest part of the error."""
    baked = box(error=20.0)
    provenance = replace(baked.provenance, error=1.0)
    for noise, sentence in ((1.2, "detail finer than the texels"), (4.0, "continue the bake")):
        parts = {"estimated_error_percent": 5.0, "estimated_noise_percent": noise}
        statistics = replace(baked.statistics, **parts)
        found = outcome(replace(baked, provenance=provenance, statistics=statistics))
        assert sentence in found and "\n" not in found


@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf")])
@pytest.mark.parametrize("limit", ["error", "time"])
def test_bad_limits(box, limit, value):
    with pytest.raises(SettingError, match=f"The {limit} must be a number of .* above 0"):
        box(**{limit: value})


@pytest.fixture
def estimated(bump_scene):
    """Returns (the Estimate of a bake, its statistics)."""
    volume = leaflight.bump_box(16)
    arguments = {"isovalues": ISOVALUES, "error": 1.0}
    expected = leaflight.estimate(volume, bump_scene, **arguments)
    return expected, leaflight.bake(volume, bump_scene, **arguments).statistics


@pytest.mark.slow
def test_an_estimate_is_of_the_error_that_the_bake_has(estimated):
    expected, statistics = estimated
    assert expected.pilot_passes < statistics.passes
    assert 0 < expected.pilot_seconds <= expected.seconds and expected.memory_bytes > 0
    assert 1 / 1.5 < expected.error / statistics.estimated_error_percent < 1.5


@pytest.mark.machine
def test_an_estimate_is_what_the_bake_takes(estimated):
    expected, statistics = estimated
    # The documented factor is 1.5; allow more for a busy machine.
    assert 1 / 2.5 < expected.seconds / statistics.seconds < 2.5
    assert 1 / 1.5 < expected.memory_bytes / statistics.peak_memory_bytes < 1.5


def passes_of(count, power, coarse=0, texture=0.0):
    """Returns (statistics of passes, statistics of the bake that was stopped after them).

    Setup takes 2 s and 5 million rays. The first pass takes a second and a million rays. Each
    pass doubles the sum. The end takes another second. coarse: number of first passes with few
    texels. texture: percent of the error that does not fall.
    """
    passes = [
        Statistics(
            seconds=2.0 + 2**number,
            rays=5e6 + 1e6 * 2**number,
            texels=100 if number < coarse else 100_000,
            peak_memory_bytes=1000,
            skipped_passes=(),
            passes=number + 1,
            estimated_noise_percent=8.0 * 2 ** (power * number),
            estimated_error_percent=math.hypot(texture, 8.0 * 2 ** (power * number)),
        )
        for number in range(count)
    ]
    end = replace(passes[-1], seconds=passes[-1].seconds + 1.0, stopped=True)
    return passes, end


@pytest.mark.parametrize("coarse", [0, 1])
def test_extrapolation_of_independent_samples_is_exact(coarse):
    # Noise may take 0.8 of the target error. A quarter of the first noise needs 16 times its work.
    expected = extrapolated(*passes_of(3, -0.5, coarse), error=2.5)
    assert expected.seconds == pytest.approx(2 + 16 + 1)
    assert expected.error == pytest.approx(2.0)
    assert expected.passes == 5 and expected.pilot_passes == 3
    assert expected.pilot_seconds == 2 + 4 + 1 and expected.memory_bytes == 1000


def test_extrapolation_knows_what_more_work_does_not_mend():
    expected = extrapolated(*passes_of(3, -0.5, texture=3.0), error=1.0)
    # The texture error is half of the target; the rest is the noise that remains.
    assert expected.error == pytest.approx(math.hypot(3.0, 2.0))
    assert expected.passes == 5


def test_extrapolation_ends_within_the_time():
    expected = extrapolated(*passes_of(2, -0.5), error=0.5, time=9.0)
    assert expected.seconds == pytest.approx(9.0)
    # The start takes 2 s and the last pass another, so 6 s remain for light.
    assert expected.error == pytest.approx(8.0 / math.sqrt(6))
    assert expected.passes == 4


@pytest.mark.parametrize("power", [-0.35, -0.8])
def test_extrapolation_follows_what_the_last_pass_showed(power):
    (first, last), end = passes_of(2, power)
    error = 8.0 * 2 ** (power * 3) / 0.8  # reached after eight times the work of the first pass
    seconds = extrapolated([first, last], end, error=error).seconds
    true = 2 + 2**3 + 1
    noise = last.estimated_noise_percent * 2**0.5
    as_independent = replace(first, estimated_noise_percent=noise)
    independent = extrapolated([as_independent, last], end, error=error).seconds
    assert abs(math.log(seconds / true)) < abs(math.log(independent / true))


def test_extrapolation_of_what_is_reached_already_is_what_was_measured():
    passes, end = passes_of(3, -0.5)
    end = replace(end, stopped=False, passes=4, estimated_error_percent=1.2)
    expected = extrapolated(passes, end, error=1.5)
    assert (expected.seconds, expected.passes, expected.error) == (7.0, 4, 1.2)


def test_extrapolation_ends_where_the_error_does_not_fall():
    assert math.isfinite(extrapolated(*passes_of(3, 0.0), error=UNREACHED).seconds)
