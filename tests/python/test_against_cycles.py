# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes against Cycles, and the section of the report on them, with little work."""

import csv
import json
import shutil
from dataclasses import replace

import leaflight.report.command as command_line
import leaflight.report.report as report_module
import numpy as np
import pytest
from leaflight import Cancelled, LeaflightError, Progress
from leaflight.cli.progress import run_with_progress
from leaflight.measure.sides import LeafSide
from leaflight.measure.truth import Truth
from leaflight.measure.volume_recipes import generated, tooth
from leaflight.report.against_cycles import (
    BUMP_BOX,
    CASES,
    OF_FLOOR,
    QUICK_CYCLES,
    Case,
    CyclesEffort,
    CyclesRow,
    floor_percent,
    measure_against_cycles,
)
from leaflight.report.cycles_section import cycles_rows, cycles_text
from leaflight.report.report import report_cycles
from leaflight.volume.volume import bump_box

BOX = replace(BUMP_BOX, name="box", volumes=generated(bump_box, 16), goals=(9.0, 8.0, 0.1))
TINY = CyclesEffort(
    cases=(BOX, Case("tooth", tooth, (500.5,))),
    rays=8,
    photons=100_000,
    points=150,
    paths=256,
    floor_samples=64,
)
needs_blender = pytest.mark.skipif(
    shutil.which("blender") is None, reason="Blender is not installed"
)


def quietly(work, label):
    assert label.startswith("against Cycles: box, ")
    return work(Progress())


@pytest.fixture
def by_paths(monkeypatch):
    """The path tracer in place of Cycles, which takes seconds to start."""
    monkeypatch.setattr(LeafSide, "by_cycles", LeafSide.path_traced)


def errors(rms, ratio=1.0, ratio_error=0.01):
    return {
        "points": 100,
        "rms_percent": rms,
        "relative_rms": 0.05,
        "reference_noise_percent": 0.4,
        "mean_ratio": ratio,
        "mean_ratio_error": ratio_error,
    }


PARTS = {"noise_percent": 1.0, "texture_percent": 2.0, "mesh_percent": 0.5}


def row(case, isovalue, rms, floor, **options):
    goal = case.goal(isovalue, floor)
    found = errors(rms, **options)
    return CyclesRow(case, isovalue, 32, 1024, 1000, 2.5, found, PARTS, floor, goal)


def test_verdicts():
    several = replace(BOX, goals=(3.0, 3.0, 4.0))
    assert [row(several, c, 3.5, 1.0).passed for c in (20.0, 47.0, 100.0)] == [False, False, True]
    of_floor = replace(BOX, goals=None)
    assert row(of_floor, 20.0, OF_FLOOR * 3.0, 3.0).passed
    assert not row(of_floor, 20.0, OF_FLOOR * 3.0 + 0.01, 3.0).passed
    unjudged = replace(row(several, 20.0, 3.5, 1.0), goal=None)
    assert unjudged.passed is None
    rows = [row(several, 20.0, 2.9, 1.0), row(several, 47.0, 3.1, 1.0), unjudged]
    assert [cells["verdict"] for cells in cycles_rows(rows)] == ["met", "missed", ""]


def test_goals_are_of_the_isovalues():
    assert all(len(case.isovalues) == len(case.goals) for case in CASES if case.goals)
    assert {case.goals for case in CASES if case.texels > 1 and "fine" in case.name} == {
        (3.0, 3.0, 4.0)
    }


def test_bias():
    bias = row(BOX, 20.0, 1.0, 1.0, ratio=0.98, ratio_error=0.01).bias
    assert (bias.value, bias.low, bias.high) == pytest.approx((-2.0, -3.96, -0.04))
    dark = replace(row(BOX, 20.0, 1.0, 1.0), errors={**errors(1.0, None), "relative_rms": None})
    assert np.isnan(dark.bias.value) and cycles_rows([dark])[0]["RMS of the mean %"] is None


def test_floor_is_what_noise_does_not_explain(box_bake, monkeypatch):
    """A difference of known size is found again below the noise of the bake and of the judge."""
    rng = np.random.default_rng(4)
    n, exposure = 100_000, box_bake.scene.exposure
    true = np.full((n, 3), 0.4 / exposure)

    def off_by(percent, shape):
        return percent / 100 / exposure * rng.normal(size=shape)

    points = np.zeros((n, 3))
    judged = true + off_by(2.0, (n, 3))
    truth = Truth(points, np.ones(n), judged, np.full((n, 3), 0.02 / exposure), None)
    baked = true + off_by(3.0, (n, 3)) + off_by(1.0, (n, 1))
    monkeypatch.setattr(type(box_bake), "radiance", lambda *_: baked)
    monkeypatch.setattr(type(box_bake), "radiance_error", lambda *_: np.full(n, 0.01 / exposure))
    assert floor_percent(box_bake, truth) == pytest.approx(3.0, rel=0.01)


def test_measured(by_paths):
    rows, absent = measure_against_cycles(TINY, quietly)
    assert absent == ["tooth"] and [row.isovalue for row in rows] == [20.0, 47.0, 100.0]
    for one in rows:
        # Figures add up in squares: the one Truth stands for both references here.
        parts = [*one.parts.values(), one.errors["reference_noise_percent"]]
        assert one.parts["mesh_percent"] == 0 < one.parts["noise_percent"]
        known = max(one.error, np.linalg.norm([parts[0], parts[-1]]))
        assert np.linalg.norm(parts) == pytest.approx(known, rel=1e-6)
        assert one.floor < one.error < 15 and one.errors["points"] == 150
        assert one.texels == 16**3 and abs(one.bias.value) < 10
    # The floor is not nothing: 16^3 texels do not follow the light.
    assert max(one.floor for one in rows) > 0.3
    assert [one.goal for one in rows] == [9.0, 8.0, 0.1] and not rows[2].passed
    again, _ = measure_against_cycles(replace(TINY, judged=False), quietly, threads=1)
    assert [one.error for one in again] == [one.error for one in rows]
    assert [one.floor for one in again] == [one.floor for one in rows]
    assert {one.goal for one in again} == {None}


@needs_blender
def test_cycles_is_the_judge():
    effort = replace(TINY, cases=(replace(BOX, isovalues=(47.0,), goals=(9.0,)),))
    (one,), absent = measure_against_cycles(effort, quietly)
    assert absent == [] and one.passed and one.parts["mesh_percent"] < 5
    # Another noise than the path tracer's, and as many paths.
    assert 0.3 < one.errors["reference_noise_percent"] < 4 and abs(one.bias.value) < 5


def test_files(by_paths, tmp_path, monkeypatch):
    monkeypatch.setattr(report_module, "find_blender", lambda: "blender")
    result = report_cycles(tmp_path, TINY, quietly)
    assert result["passed"] is False and result["rows"] == []
    found = json.loads(json.dumps(result, allow_nan=False))["against_cycles"]
    with open(tmp_path / "csv" / "against_cycles.csv", newline="") as file:
        lines = list(csv.DictReader(file))
    for name in ("RMS %", "noise %", "texture %", "floor %", "mean off by %, low", "isovalue"):
        assert [float(line[name]) for line in lines] == [row[name] for row in found]
    text = (tmp_path / "cycles.md").read_text()
    assert text.count("| box |") == 3 and text.count("| missed |") == 1
    assert "Absent, hence left out: tooth." in text and "1.15 times the floor" in text
    assert str(tmp_path) not in text


def test_nothing_is_judged_quickly():
    text = "\n".join(cycles_text([], [], QUICK_CYCLES))
    assert "goal" not in text and "Absent" not in text and "64 paths instead" in text
    full = CyclesEffort()
    assert full.judged and not QUICK_CYCLES.judged and QUICK_CYCLES.points < full.points == 1500


def test_interrupted(by_paths, tmp_path, monkeypatch):
    """Each step can be cancelled, and then nothing is written."""
    monkeypatch.setattr(report_module, "find_blender", lambda: "blender")
    effort = replace(TINY, cases=(BOX,), photons=10_000, points=10, paths=8, floor_samples=2)
    labels = []

    def note(work, label):
        labels.append(label.removeprefix("against Cycles: box, "))
        return work(Progress())

    report_cycles(tmp_path / "whole", effort, note)
    at = [f"{who} at {c}" for c in (20, 47, 100) for who in ("Cycles", "paths")]
    assert labels == ["bake", *at, "floor"]
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


def test_command_line(cli, tmp_path, monkeypatch):
    asked = []

    def fake(*arguments, **work):
        asked.append((arguments, work))
        rows = [{"bake": "a", "isovalue": 2.5, "RMS %": 3.0, "goal %": 2.0, "verdict": "missed"}]
        return {"out": "x", "seed": 3, "passed": False, "rows": [], "against_cycles": rows}

    monkeypatch.setattr(command_line, "report_cycles", fake)
    outcome = cli("report", "--cycles", "--out", tmp_path, "--data", tmp_path, "--seed", 3)
    assert outcome.status == 1 and "cycles.md: some errors" in outcome.out
    assert "a at 2.5 against Cycles: 3.00 %, goal 2.00 % missed" in outcome.out
    cli("report", "--cycles", "--quick", "--out", tmp_path)
    run = run_with_progress
    assert asked == [
        ((str(tmp_path), CyclesEffort(), run, str(tmp_path)), {"seed": 3, "threads": 0}),
        ((str(tmp_path), QUICK_CYCLES, run, None), {"seed": 0, "threads": 0}),
    ]
    assert cli("report", "--cycles", "--tables").status == 2
    outcome = cli("report", "--cycles", "--data", tmp_path / "none")
    assert outcome.status == 2 and "there is no such folder" in outcome.err
