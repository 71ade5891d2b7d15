# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests refine(): it continues a stopped bake, or lowers the error of a bake."""

import json

import leaflight
import numpy as np
import pytest
from cone import FINE, cone, stopping
from leaflight import load_bake, refine
from leaflight.volume.setting_error import SettingError
from same_bytes import assert_same_light


@pytest.fixture
def previous(box):
    """Returns a bake that was stopped after its first pass."""
    return box(error=0.3, **stopping(1)[0])


def blocks(baked):
    return baked.provenance.blocks


@pytest.mark.slow
def test_a_stopped_bake_goes_on_to_its_error(box, previous):
    more = refine(previous)
    assert more.statistics.estimated_error_percent < previous.statistics.estimated_error_percent
    assert not more.statistics.stopped and previous.statistics.stopped
    assert more.provenance.error == 0.3 and more.provenance.continued == previous.id != more.id
    assert more.provenance.passes == more.statistics.passes > 1
    assert blocks(more) > blocks(previous)
    for name in ("rays", "seconds"):
        assert getattr(more.statistics, name) > getattr(previous.statistics, name) > 0
    # The result is as close to the truth as an uninterrupted bake.
    truth = np.mean([box(error=0.05, seed=seed).grid.dense("radiance") for seed in (1, 2, 3)], 0)
    never_stopped = box(error=0.3)
    errors = [
        np.abs(b.grid.dense("radiance") - truth).mean() for b in (previous, more, never_stopped)
    ]
    assert errors[1] < 0.8 * errors[0] and errors[1] < 1.25 * errors[2]


def test_a_finished_bake_goes_on_to_a_smaller_error(box):
    rough = box(resolution=FINE, error=1.0)
    assert not rough.statistics.stopped
    fine = refine(rough, error=0.5)
    assert fine.provenance.error == 0.5
    assert fine.statistics.estimated_error_percent <= 0.5
    noise = [one.statistics.estimated_noise_percent for one in (rough, fine)]
    assert noise[1] < 0.85 * noise[0]
    points = fine.surface(47.0).vertices
    assert fine.radiance_error(points).mean() < 0.85 * rough.radiance_error(points).mean()


@pytest.mark.slow
@pytest.mark.parametrize("both_sides", [False, True])
def test_from_memory_and_from_its_file_alike(box, tmp_path, both_sides):
    previous = box(error=0.3, both_sides=both_sides, seed=5, **stopping(1)[0])
    previous.save(tmp_path / "previous.vdb")
    loaded = load_bake(tmp_path / "previous.vdb")
    one, two = refine(previous, threads=1), refine(loaded, threads=2)
    assert_same_light(one, two)
    assert one.grid.has_back == both_sides
    # The result is a bake like any other: it can be saved and continued.
    two.save(tmp_path / "more.vdb")
    again = refine(load_bake(tmp_path / "more.vdb"), error=0.2)
    assert again.provenance.continued == one.id
    for key in ("seed", "scene", "isovalues", "both_sides"):
        assert getattr(again.provenance, key) == getattr(previous.provenance, key)


@pytest.mark.slow
def test_passes_are_shown_and_stopped_as_those_of_a_bake(previous):
    more = refine(previous, error=0.01, **stopping(2)[0])
    assert more.statistics.stopped and more.statistics.passes == 3
    same = refine(previous, error=0.01, **stopping(2)[0])
    assert_same_light(more, same)
    # The time ends before the first pass.
    limited = refine(previous, error=0.01, time=1e-9)
    assert limited.statistics.stopped and limited.statistics.passes == 2
    progress = leaflight.Progress()
    progress.cancel()
    with pytest.raises(leaflight.Cancelled):
        refine(previous, progress=progress)


@pytest.mark.slow
def test_walls_are_lit_anew(box):
    previous = box(error=0.3, walls=True, **stopping(1)[0])
    more = refine(previous)
    before, after = (b.walls.radiance(0, 50.0) for b in (previous, more))
    assert before.shape == after.shape and not np.array_equal(before, after)
    assert after.mean() == pytest.approx(before.mean(), rel=0.05)
    without = refine(previous, walls=False)
    assert without.walls is None and without.provenance.walls is False


@pytest.mark.slow
def test_a_first_picture_begins_anew(bump_scene, tmp_path):
    """Checks that refine() starts again from a first picture, which has other texels.

    A bake that is stopped early keeps its first picture.
    """
    volume = leaflight.bump_box(20)
    previous = leaflight.bake(volume, bump_scene, error=3.0, **stopping(1)[0])
    whole = leaflight.bake(volume, bump_scene, error=3.0)
    assert previous.grid.resolution != whole.grid.resolution
    previous.save(tmp_path / "previous.vdb")
    for first in (previous, load_bake(tmp_path / "previous.vdb")):
        assert_same_light(refine(first), whole)


def test_a_first_picture_is_not_continued(box):
    first = box(time=1e-3)
    again = refine(first, time=1e-3)
    assert again.provenance.continued == "" and again.id == first.id
    assert again.statistics.rays == first.statistics.rays


def test_what_is_good_enough_is_not_continued(box):
    baked = box(error=8.0)
    with pytest.raises(SettingError, match="already") as caught:
        refine(baked)
    assert caught.value.settings == ("error",)


def test_the_command_line(cli, root, tmp_path):
    previous, more = tmp_path / "previous.vdb", tmp_path / "more.vdb"
    scene = root / "scenes" / "bump_box.json"
    volume, spacing = tmp_path / "cone.npy", str(1 / 15)
    np.save(volume, cone(16).values)
    given = [volume, "--spacing", spacing, "--scene", scene, "--isovalues", "30", "70"]
    texels = ["--resolution", str(FINE)]
    before = cli.json("bake", *given, *texels, "--error", "1", "--out", previous)
    continued = ["bake", "--continue", previous, "--out", more]
    printed = cli.runs(*continued, "--error", "0.5", "--json")
    assert "(target 0.5 %)" in printed
    after = json.loads(printed.splitlines()[-1])
    name = "estimated_noise_percent"
    assert after[name] < 0.85 * before[name]
    name = "estimated_error_percent"
    assert after[name] <= 0.5 < before[name]
    assert after["passes"] > before["passes"] and after["rays"] > before["rays"]
    assert load_bake(more).provenance.continued == load_bake(previous).id
    cli.runs("bake", "--continue", more, "--out", more, "--error", "0.4")
    cli.refuses("(--error).", *continued)
    others = ("--isovalues", "30", "60", "--seed", "2", "--both-sides")
    cli.refuses("leave out --isovalues, --seed, --both-sides.", *continued, *others)
    cli.refuses("leave out --level, --both-sides.", *continued, "--no-both-sides", "--level", "0")
    both = ("bump_box", "--continue", previous, "--estimate")
    cli.refuses("leave out VOLUME, --estimate.", "bake", *both)
