# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes against Cycles, and the section of the report on them, with little work."""

import csv
import functools
import json
import shutil
from dataclasses import replace

import reports.against_cycles as against_cycles
import reports.command as command_line
import reports.report as report_module
import numpy as np
import pytest
from leaflight import Cancelled, LeaflightError, Progress, bake
from leaflight.bake.estimate import Estimate
from leaflight.bake.statistics import Statistics
from leaflight.progress_bar import run_with_progress
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.sides import IsosurfaceSide
from volume_recipes import generated, tooth
from reports.against_cycles import (
    CASES,
    REACHED,
    EXCEEDED,
    QUICK_CYCLES,
    REPORTED,
    TRUE_WITHIN,
    BakeRow,
    Case,
    CyclesEffort,
    CyclesRow,
    measure_against_cycles,
)
from reports.cycles_section import bake_rows, cycles_rows, cycles_text
from reports.report import report_cycles
from leaflight.volume.volume import bump_box

pytestmark = pytest.mark.slow

BOX = Case("box", generated(bump_box, 8), (20.0, 47.0), "bump_box.json")
TINY = CyclesEffort((BOX, Case("tooth", tooth, (500.5,))), points=150, paths=256, noise=np.inf)
BY_CYCLES = IsosurfaceSide.by_cycles
needs_blender = pytest.mark.skipif(
    shutil.which("blender") is None, reason="Blender is not installed"
)


def quietly(work, label):
    assert label.startswith("against Cycles: box, ")
    return work(Progress())


@pytest.fixture(scope="module")
def by_paths():
    """Yields the path tracer in place of Cycles, which takes seconds to start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(IsosurfaceSide, "by_cycles", IsosurfaceSide.path_traced)
        yield


@pytest.fixture
def coarsely(by_paths, monkeypatch):
    """Bakes that are soon done."""
    for name in ("bake", "estimate"):
        work = functools.partial(getattr(against_cycles, name), error=20.0)
        monkeypatch.setattr(against_cycles, name, work)


@pytest.fixture(scope="module")
def found(by_paths):
    return measure_against_cycles(TINY, quietly)


def of_bake(before, after, found=2.0):
    statistics = Statistics(2.5, 7, 9, 11, (), passes=3, estimated_error_percent=after)
    return BakeRow(BOX, (8, 8, 8), Estimate(2.0, 1, before, 3, 2, 1.0), statistics, found)


def row(rms, before=1.4, after=1.4, colour=0.3):
    errors = {
        "rms_percent": rms,
        "reference_noise_percent": 0.4,
        "mean_radiance": colour,
        "mean_ratio": 0.98,
    }
    parts = {"noise_percent": 1.0, "texture_percent": 2.0, "mesh_percent": 0.5}
    return CyclesRow(of_bake(before, after), None, 47.0, 1024, errors, parts, True)


def test_verdicts():
    assert row(1.5).verdict == REACHED
    assert row(1.51, 1.6, 1.6).verdict == REPORTED
    # Both before and afterwards.
    exceeded = [row(1.51, 1.4, 1.6), row(1.51, 1.6, 1.4)]
    assert [one.verdict for one in exceeded] == [EXCEEDED, EXCEEDED]
    assert row(9.0, 1.6, 1.6).passed and not exceeded[0].passed
    unjudged = replace(exceeded[0], judged=False)
    assert unjudged.verdict is None and unjudged.passed


def test_true_is_what_is_found():
    for found, true in (
        (2.0, True),
        (2.0 / TRUE_WITHIN - 0.01, False),
        (2.99, True),
        (3.01, False),
    ):
        assert of_bake(2.0, 2.0, found).true is true
    assert not of_bake(2.0, 2.0, 0.0).true


def test_dark_isosurfaces_have_no_mean():
    (cells,) = cycles_rows([row(1.0, colour=0.001)])
    assert cells["mean off by %"] is None
    (cells,) = cycles_rows([row(1.0)])
    assert cells["mean off by %"] == pytest.approx(-2.0)


def test_cases():
    assert len({case.name for case in CASES}) == len(CASES)
    assert all(len(set(case.isovalues)) >= 3 for case in CASES)


def test_measured(found):
    rows, absent = found
    assert absent == ["tooth"] and [row.isovalue for row in rows] == [20.0, 47.0]
    plain = bake(bump_box(8), packaged_scene("bump_box.json"))
    for one in rows:
        # Figures add up in squares: the one Truth stands for both references here.
        parts = [*one.parts.values(), one.errors["reference_noise_percent"]]
        assert one.parts["mesh_percent"] == 0 < one.parts["noise_percent"]
        known = max(one.errors["rms_percent"], np.linalg.norm([parts[0], parts[-1]]))
        assert np.linalg.norm(parts) == pytest.approx(known, rel=1e-6)
        assert one.errors["points"] == 150 and one.volume is None
        # No setting was touched.
        assert one.bake is rows[0].bake and one.paths == 256
        for name in ("texels", "passes", "estimated_error_percent"):
            assert getattr(one.bake.statistics, name) == getattr(plain.statistics, name)
    own = [
        one.errors["rms_percent"] ** 2 - one.errors["reference_noise_percent"] ** 2 for one in rows
    ]
    assert rows[0].bake.found == pytest.approx(np.sqrt(max(np.mean(own), 0)), rel=1e-6)
    assert rows[0].bake.before.passes >= 1


def test_threads_do_not_matter(coarsely):
    rows, _ = measure_against_cycles(TINY, quietly)
    again, _ = measure_against_cycles(replace(TINY, judged=False), quietly, threads=1)
    for name in ("errors", "parts"):
        assert [getattr(one, name) for one in again] == [getattr(one, name) for one in rows]
    assert [one.verdict for one in again] == [None, None]


def test_more_paths_where_cycles_is_noisy(coarsely):
    effort = replace(TINY, cases=(replace(BOX, isovalues=(47.0,)),), paths=16, noise=3.0)
    (noisy,), _ = measure_against_cycles(replace(effort, noise=np.inf), quietly)
    (one,), _ = measure_against_cycles(effort, quietly)
    assert noisy.errors["reference_noise_percent"] > 3.5 and noisy.paths == 16
    assert one.errors["reference_noise_percent"] < 3.3 and one.paths > 16


def test_each_volume_is_judged(coarsely):
    def two(folder, fineness):
        box = bump_box(8)
        beside = box.index_to_world.copy()
        beside[0, 3] += 10 * beside[0, 0]
        return [box, replace(box, name="other", index_to_world=beside)]

    effort = replace(TINY, cases=(Case("box", two, (0.5,)),), points=20, paths=16)
    rows, _ = measure_against_cycles(effort, quietly)
    assert [row.volume for row in rows] == ["bump_box", "other"]
    assert [cells["bake"] for cells in cycles_rows(rows)] == ["box: bump_box", "box: other"]
    assert len(bake_rows(rows)) == 1


@needs_blender
def test_cycles_is_the_judge(monkeypatch):
    # As it is, whatever the tests above put in its place.
    monkeypatch.setattr(IsosurfaceSide, "by_cycles", BY_CYCLES)
    effort = replace(TINY, cases=(replace(BOX, isovalues=(47.0,)),))
    (one,), absent = measure_against_cycles(effort, quietly)
    assert absent == [] and one.errors["rms_percent"] < 9 and one.parts["mesh_percent"] < 5
    # Another noise than the path tracer's, and as many paths.
    assert 0.3 < one.errors["reference_noise_percent"] < 4
    assert one.errors["mean_ratio"] == pytest.approx(1, abs=0.05)


def test_files(found, tmp_path, monkeypatch):
    monkeypatch.setattr(report_module, "find_blender", lambda: "blender")
    monkeypatch.setattr(report_module, "measure_against_cycles", lambda *_, **__: found)
    result = report_cycles(tmp_path, TINY, quietly)
    assert result["rows"] == [] and isinstance(result["passed"], bool)
    result = json.loads(json.dumps(result, allow_nan=False))
    columns = {
        "against_cycles": ("RMS %", "texture %", "mean off by %", "isovalue"),
        "bakes_against_cycles": (
            "texels",
            "bake s",
            "estimated before %",
            "estimated after %",
            "found %",
        ),
    }
    files = {"against_cycles": "cycles_isosurfaces", "bakes_against_cycles": "cycles_bakes"}
    for table, names in columns.items():
        with open(tmp_path / "csv" / f"{files[table]}.csv", newline="") as file:
            lines = list(csv.DictReader(file))
        for name in names:
            assert [float(line[name]) for line in lines] == [row[name] for row in result[table]]
    text = (tmp_path / "cycles.md").read_text()
    assert text.count("| box |") == 3 and "Absent, hence left out: tooth." in text
    assert str(tmp_path) not in text


def test_what_is_missed_fails(tmp_path, monkeypatch):
    monkeypatch.setattr(report_module, "find_blender", lambda: "blender")
    for rows, passed in ([row(1.0), row(2.0)], False), ([row(1.0)], True):
        monkeypatch.setattr(
            report_module, "measure_against_cycles", lambda *_, rows=rows, **__: (rows, [])
        )
        assert report_cycles(tmp_path, TINY, quietly)["passed"] is passed
        text = (tmp_path / "cycles.md").read_text()
        assert text.count("| exceeded |") == (not passed) and text.count("| reached |") == 1


def test_nothing_is_judged_quickly():
    text = "\n".join(cycles_text([], [], QUICK_CYCLES))
    assert "The target" not in text and "Absent" not in text
    full = CyclesEffort()
    assert full.judged and not QUICK_CYCLES.judged and QUICK_CYCLES.points < full.points
    assert "The target of a default bake is 1.5 %" in "\n".join(cycles_text([], [], full))


def test_interrupted(coarsely, tmp_path, monkeypatch):
    """Each step can be cancelled, and then nothing is written."""
    monkeypatch.setattr(report_module, "find_blender", lambda: "blender")
    effort = replace(TINY, cases=(BOX,), points=10, paths=8)
    labels = []

    def note(work, label):
        labels.append(label.removeprefix("against Cycles: box, "))
        return work(Progress())

    report_cycles(tmp_path / "whole", effort, note)
    at = [f"{who} at {c}" for c in (20, 47) for who in ("Cycles", "paths")]
    assert labels == ["estimate", "bake", *at]
    for cancelled in labels:

        def cancel(work, label, cancelled=cancelled):
            progress = Progress()
            if label.endswith(f", {cancelled}"):
                progress.cancel()
            return work(progress)

        with pytest.raises(Cancelled):
            report_cycles(tmp_path / "part", effort, cancel)
    assert [path for path in (tmp_path / "part").rglob("*") if path.is_file()] == []


def test_without_blender(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(LeaflightError, match="install the Debian package blender"):
        report_cycles(tmp_path / "new", TINY, quietly)
    assert not (tmp_path / "new").exists()


def test_command_line(report_program, tmp_path, monkeypatch):
    asked = []

    def fake(*arguments, **work):
        asked.append((arguments, work))
        row = {"bake": "a", "isovalue": 2.5, "RMS %": 3.0}
        rows = [{**row, "verdict": "exceeded"}]
        return {"out": "x", "seed": 3, "passed": False, "rows": [], "against_cycles": rows}

    monkeypatch.setattr(command_line, "report_cycles", fake)
    outcome = report_program("--cycles", "--out", tmp_path, "--data", tmp_path, "--seed", 3)
    assert outcome.status == 1 and "cycles.md: some errors" in outcome.out
    assert "a at 2.5 against Cycles: 3.00 %: exceeded" in outcome.out
    report_program("--cycles", "--quick", "--out", tmp_path)
    run = run_with_progress
    assert asked == [
        ((str(tmp_path), CyclesEffort(), run, str(tmp_path)), {"seed": 3, "threads": 0}),
        ((str(tmp_path), QUICK_CYCLES, run, None), {"seed": 0, "threads": 0}),
    ]
    assert report_program("--cycles", "--tables").status == 2
    outcome = report_program("--cycles", "--data", tmp_path / "none")
    assert outcome.status == 2 and "there is no such folder" in outcome.err
