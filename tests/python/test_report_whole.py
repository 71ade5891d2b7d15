# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole report with little work: its curves, data sets, advice, plots and files."""

import builtins
import csv
import json
import os
import shutil
import zipfile
from dataclasses import replace

import leaflight
import reports.command as command_line
import reports.curves as curves_module
import reports.report as report_module
import numpy as np
import pytest
from leaflight import Cancelled, LeaflightError, Progress
from leaflight.bake.estimate import Estimate
from leaflight.bake.statistics import Statistics
from leaflight.io.scene_file import packaged_scene
from leaflight.progress_bar import run_with_progress
from leaflight.scene.scene import fit_scene, isovalue_at, match_isosurfaces
from leaflight.volume.particles import nucleons
from reports.advice import advice, budget_rows
from reports.against_cycles import CASES, BakeRow, CyclesRow
from reports.curves import BAKE, CYCLES, KINDS, Curve, CurveEffort, Curves, Point, measure_curves
from reports.data_sets import DATA_SETS, QUICK_DATA, DataEffort, measure_data_sets
from reports.experiments import QUICK, Row, Table, Trial
from reports.isosurfaces import isosurfaces
from reports.memory import Cost, measured
from reports.plots import check_plotting
from reports.report import QUICK_REPORT, ReportEffort, report
from reports.sections import analysed, slope_rows
from PIL import Image
from volume_recipes import generated

pytestmark = pytest.mark.slow

TINY_CURVES = CurveEffort(
    texels=16,
    resolutions=(4, 16),
    rays=(1, 2, 4, 8),
    slow_rays=(1, 2, 4),
    cycles=(1, 2, 4),
    repetitions=2,
    vertices=120,
    paths=512,
)
TINY_DATA = DataEffort(fineness=0.15, vertices=90, paths=64)
TINY = ReportEffort(QUICK, TINY_CURVES, TINY_DATA)
HAS_BLENDER = shutil.which("blender") is not None


def quietly(work, label):
    assert label
    return work(Progress())


def one_table(effort, run):
    row = Row(Trial("samples in each texel", 10, 4), 1.5, 0.25, {}, "for comparison", True)
    picture = np.zeros((4, 4, 3), np.uint8)
    return Table("table", "Table", [row], ["A note."], {"slices": {"ours": picture}})


# Estimators without a cache of the walls, whose bakes are short.
SHORT = tuple(kind for kind in KINDS if kind.name in ("path", "volumetric", "thesis"))


@pytest.fixture(scope="module")
def short():
    """Measured curves."""
    return measure_curves(TINY_CURVES, quietly, cycles=False, kinds=SHORT)


@pytest.fixture(scope="module")
def curves(short):
    """All curves as if they had been measured: error^2 = 1 + 100 / rays, the path's without 1."""

    def point(kind, rays):
        own = Cost(0.5 + 0.1 * rays, 1000 * rays, 2**27, 2**20)
        floor = 0.0 if kind.name == "path" else 1.0
        return Point(rays, [own, own], np.sqrt(floor + 100 / rays), np.sqrt(90 / rays))

    made = [Curve(kind.name, kind.group, [point(kind, n) for n in (1, 2, 4, 8)]) for kind in KINDS]
    return Curves(made, short.reference, TINY_CURVES)


@pytest.fixture
def with_cycles(curves):
    """Returns the same with Cycles, which takes a tenth of the seconds for one isosurface."""
    points = [
        Point(n, [Cost(0.05 + 0.01 * n, None, 2**28, None)] * 2, np.sqrt(1 + 100 / n), 10 / n**0.5)
        for n in (1, 2, 4, 8, 16)
    ]
    return replace(curves, curves=[*curves.curves, Curve(CYCLES, "Cycles", points)])


@pytest.fixture(scope="module")
def data():
    return measure_data_sets(TINY_DATA, quietly, data_sets=DATA_SETS[:3] + DATA_SETS[4:])


@pytest.fixture(scope="module")
def written(curves, data, tmp_path_factory):
    """Returns the report's files from what the other fixtures measured."""
    folder = tmp_path_factory.mktemp("report") / "new"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_module, "measure_curves", lambda *_, **__: curves)
        patch.setattr(report_module, "measure_data_sets", lambda *_, **__: data)
        patch.setattr(report_module.shutil, "which", lambda _: None)
        return folder, report(folder, TINY, quietly, tables=(one_table,))


def test_curves_fall(short):
    assert [curve.name for curve in short.curves] == [kind.name for kind in SHORT]
    for curve in short.curves:
        points = curve.points
        wanted = TINY_CURVES.slow_rays if curve.name == "thesis" else TINY_CURVES.rays
        assert tuple(point.samples for point in points) == wanted
        assert points[-1].error < points[0].error and points[-1].noise < points[0].noise
        for point in points:
            # Noise is part of the error; the noise of the reference is another part.
            assert 0 < point.noise < 1.1 * point.error < 60
            assert len(point.costs) == 2 and 0 < point.seconds
            assert all(cost.rays > 0 and cost.file > 10_000 < cost.peak for cost in point.costs)
    assert 0 < short.reference.noise < 5 and short.of("moon") is None


def test_noise_of_paths_falls_as_it_must(short):
    """From seed to seed the noise of the estimator `path` halves with four times the rays."""
    noise = [point.noise for point in short.of("path").points]
    slope = np.polyfit(np.log(TINY_CURVES.rays), np.log(noise), 1)[0]
    assert -0.75 < slope < -0.3


def test_errors_are_the_same_in_every_run(short):
    effort = replace(TINY_CURVES, rays=(4,))
    again = measure_curves(effort, quietly, threads=1, cycles=False, kinds=SHORT[:2])
    for curve in again.curves:
        (point,), before = curve.points, short.of(curve.name).points[2]
        assert (point.error, point.noise) == (before.error, before.noise)


@pytest.mark.parametrize("name", ["gather", "importance", BAKE])
def test_kinds_with_caches_are_baked(name):
    kinds = tuple(kind for kind in KINDS if kind.name == name)
    effort = replace(TINY_CURVES, texels=8, resolutions=(8,), rays=(2,), vertices=30, paths=16)
    (curve,) = measure_curves(effort, quietly, cycles=False, kinds=kinds).curves
    assert 0 < curve.points[0].error < 60
    assert (curve.points[0].samples, curve.unit) == (
        (8, "texels a side") if name == BAKE else (2, "rays a texel")
    )


@pytest.mark.skipif(not HAS_BLENDER, reason="Blender is not installed")
def test_cycles_bakes_the_same_light(monkeypatch):
    # Blender starts for each isosurface and seed.
    monkeypatch.setattr(curves_module, "ISOVALUES", (47.0,))
    effort = replace(TINY_CURVES, cycles=(16, 64))
    found = measure_curves(effort, quietly, kinds=())
    assert [curve.name for curve in found.curves] == [CYCLES]
    few, many = found.of(CYCLES).points
    # 6 * 16 and 6 * 64 paths a vertex: noise of some percent that halves, and little else.
    assert many.noise == pytest.approx(0.5 * few.noise, rel=0.3)
    assert many.error < 8 and 0 < many.seconds and many.peak > 2**24


def test_data_sets(data):
    rows, absent = data
    assert [row.data_set.name for row in rows] == [one.name for one in DATA_SETS[:3]]
    assert absent == [one.name for one in DATA_SETS[4:]]
    for row in rows:
        assert 0 < row.noise and 0 < row.error < 60 and row.direct > 0 and row.vertices > 0
        # With a tenth of the nodes, errors are a few percent, and the bake estimates them.
        assert row.texels > 0 and 0 < row.estimated < 60
        assert row.break_even == row.cost.seconds / row.direct


def test_hidden_vertices_are_not_judged():
    """Checks that no judged point lies inside the other volume's isosurface, without light."""
    volumes = generated(nucleons, 101)(None, 0.2)
    scene = packaged_scene("nucleons.json")
    scene = fit_scene(match_isosurfaces(scene, volumes), volumes)
    found = isosurfaces(volumes, scene, (0.0, 1.0), (0.2,), 400, 1, 0, 0, quietly, "label")
    for one, other in zip(found.surfaces, reversed(volumes), strict=True):
        own = isovalue_at(scene, 1 - one.volume, 0.2)
        assert (other.field().sample(one.points) < own).all()
        assert (other.field().sample(one.vertices) >= own).any()


def test_real_data_sets(tmp_path):
    """Files are found by their names, in a zip as well."""
    import tifffile

    ball = np.linspace(-1, 1, 41)
    values = np.uint8(200 * np.exp(-sum(axis**2 for axis in np.meshgrid(ball, ball, ball))))
    (tmp_path / "nucleon.raw").write_bytes(values.tobytes())
    tifffile.imwrite(tmp_path / "stack.tif", values[:20], photometric="minisblack")
    with zipfile.ZipFile(tmp_path / "rivulet_neuron.tif.zip", "w") as archive:
        archive.write(tmp_path / "stack.tif", "stack.tif")
    rows, absent = measure_data_sets(TINY_DATA, quietly, folder=tmp_path, data_sets=DATA_SETS[4:])
    assert [row.data_set.name for row in rows] == [one.name for one in DATA_SETS[4:6]]
    assert absent == ["bunny (bunny_ct_half.nrrd)"]


def test_the_thesis_prints():
    printed = [one.printed for one in DATA_SETS if one.printed]
    break_even = [one.bake / one.direct for one in printed]
    assert len(printed) == 4 and 2.9 < min(break_even) < max(break_even) < 11


def test_slopes(curves, with_cycles):
    rows = {row["curve"]: row for row in slope_rows(curves, analysed(curves, 0))}
    # A bake in passes has as many as its error needs, so that nothing grows along its curve.
    assert BAKE not in rows
    assert rows["gather"]["floor, %"].value == pytest.approx(1)
    assert rows["gather"]["samples for noise = floor"] == pytest.approx(100)
    assert rows["path"]["slope of the error"].value == pytest.approx(-0.5)
    assert rows["path"]["floor, %"].value == pytest.approx(0, abs=1e-3)
    assert all(row["slope of the noise"].value == pytest.approx(-0.5) for row in rows.values())
    assert analysed(curves, 0).break_even == []
    rows = analysed(with_cycles, 0).break_even
    assert {row["bake"] for row in rows} == {BAKE, "gather"}
    for row in rows:
        assert row["isosurfaces"].value == pytest.approx(10)


def test_budgets(curves):
    rows = budget_rows(curves)
    assert rows and all(row["RMS %"] <= row["its RMS %"] for row in rows)
    # More seconds never buy more error.
    errors = [row["RMS %"] for row in rows]
    assert errors == sorted(errors, reverse=True)


def test_advice_without_data(curves):
    text = "\n".join(advice(curves, analysed(curves, 0), []))
    assert "**Bake.**" in text and "**Samples.**" in text and "nan" not in text
    assert "**Data.**" not in text and "Cycles" not in text


def test_with_cycles(with_cycles, data, tmp_path, monkeypatch):
    monkeypatch.setattr(report_module, "measure_curves", lambda *_, **__: with_cycles)
    monkeypatch.setattr(report_module, "measure_data_sets", lambda *_, **__: data)
    errors = {"rms_percent": 2.5, "reference_noise_percent": 0.4}
    errors |= {"mean_radiance": 0.3, "mean_ratio": 1.0}
    parts = {"noise_percent": 1.0, "texture_percent": 2.0, "mesh_percent": 0.5}
    statistics = Statistics(2.5, 7, 9, 11, (), passes=3, estimated_error_percent=1.25)
    of_bake = BakeRow(CASES[0], (40, 40, 40), Estimate(2.0, 1, 1.4, 3, 2, 1.0), statistics, 2.47)
    judged = CyclesRow(of_bake, None, 47.0, 1024, errors, parts, True)
    found = [judged], ["tooth"]
    monkeypatch.setattr(report_module, "measure_against_cycles", lambda *_, **__: found)
    monkeypatch.setattr(report_module.shutil, "which", lambda _: "blender")
    result = report(tmp_path, TINY, quietly, tables=(one_table,))
    assert len(json.loads(json.dumps(result, allow_nan=False))["break_even"]) == 8
    # The tables are as they must be, and the target error is exceeded.
    assert result["passed"] is False and result["against_cycles"][0]["verdict"] == "exceeded"
    assert (tmp_path / "csv" / "against_cycles.csv").exists()
    assert (tmp_path / "csv" / "bakes_against_cycles.csv").exists()
    text = (tmp_path / "report.md").read_text()
    assert "| 0.40 | exceeded |" in text and "left out: tooth." in text
    # Fits are exact, but seconds vary by 10 % on both sides.
    assert "10.0 (8.7 .. 11.6)" in text and "as long as 10.0 of them in Cycles" in text
    assert (tmp_path / "images" / "break_even.png").exists()
    assert (tmp_path / "csv" / "break_even.csv").exists()


def test_files(written):
    folder, result = written
    text = (folder / "report.md").read_text()
    assert result["passed"] is True and result["out"] == str(folder)
    images = {path.name for path in (folder / "images").iterdir()}
    shown = {line.split("images/")[1][:-1] for line in text.splitlines() if line.startswith("![")}
    # The table's own picture, and the plots; nothing of Cycles, which was not asked.
    assert shown == images == {"curves.png", "convergence.png", "table_slices.png"}
    for name in ("curves.png", "convergence.png"):
        with Image.open(folder / "images" / name) as picture:
            assert picture.width > 600 and np.asarray(picture.convert("L")).std() > 10
    sheets = {path.stem for path in (folder / "csv").iterdir()}
    assert sheets == {"curves", "slopes", "data_sets", "memory", "table"}
    with open(folder / "csv" / "curves.csv", newline="") as file:
        lines = list(csv.DictReader(file))
    assert [float(line["RMS %"]) for line in lines] == [row["RMS %"] for row in result["curves"]]
    for row in result["data_sets"]:
        assert f"| {row['data set']} |" in text and f" {row['RMS %']:.2f} |" in text
    assert "5.61" in text and "Name the folder" in text and "There is no Blender" in text
    assert "## Against Cycles\n\nThere is no Blender" in text
    assert "Reduced (`--quick`)" in text and "texels 16 instead of 100" in text
    assert "| samples in each texel |" in text and str(folder) not in text


def test_interrupted(tmp_path, curves, monkeypatch):
    """Checks that a report cancelled after hours of work leaves no file behind."""

    def cancelled(*_, **__):
        raise Cancelled("data sets cancelled")

    monkeypatch.setattr(report_module, "measure_curves", lambda *_, **__: curves)
    monkeypatch.setattr(report_module, "measure_data_sets", cancelled)
    with pytest.raises(Cancelled):
        report(tmp_path, TINY, quietly, tables=(one_table,))
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_without_matplotlib(tmp_path, monkeypatch):
    imported = builtins.__import__

    def without(name, *rest):
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return imported(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(
        LeaflightError,
        match="pip install matplotlib, or install the Debian package python3-matplotlib",
    ):
        check_plotting()
    with pytest.raises(LeaflightError, match="--tables"):
        report(tmp_path, TINY, quietly)


@pytest.mark.machine
@pytest.mark.skipif(
    not os.access("/proc/self/clear_refs", os.W_OK), reason="peaks last as long as the process"
)
def test_peak_of_one_bake(bump_scene, small):
    """Checks that an earlier peak does not count."""
    ballast = np.ones(300 * 2**20, np.uint8)
    size = ballast.nbytes
    del ballast
    _, before = measured(lambda: leaflight.bake(leaflight.bump_box(10), bump_scene, **small))
    ballast = np.ones(size, np.uint8)
    _, during = measured(lambda: leaflight.bake(leaflight.bump_box(10), bump_scene, **small))
    assert during.peak > before.peak + 0.9 * ballast.nbytes
    assert before.file > 1000 and before.seconds > 0 and before.rays > 0


def test_efforts():
    """The quick report is the full one with less of everything."""
    full = ReportEffort()
    assert QUICK_REPORT.curves.texels < full.curves.texels
    assert set(QUICK_REPORT.curves.rays) < set(full.curves.rays)
    assert max(QUICK_REPORT.curves.resolutions) < max(full.curves.resolutions)
    assert QUICK_REPORT.data.paths < full.data.paths
    assert QUICK_DATA.fineness == 1 == full.data.fineness
    assert (
        "against Cycles: cases (bump box, 48^3, hydrogen, 32^3) instead of ("
        in (report_module._reductions(QUICK_REPORT)[1])
    )


def test_command_line(report_program, tmp_path, monkeypatch):
    asked = []

    def fake(*arguments):
        asked.append(arguments)
        rows = [{"data set": "a", "RMS %": 2.0, "bake s": 3.0}]
        return {"out": "x", "seed": 0, "passed": True, "rows": [], "data_sets": rows}

    monkeypatch.setattr(command_line, "report", fake)
    outcome = report_program(
        "--quick", "--out", tmp_path, "--data", tmp_path, "--seed", 3, "--json"
    )
    assert outcome.status == 0, outcome.err
    assert json.loads(outcome.out.splitlines()[-1])["passed"] and "a: 2.00 %, 3.0 s" in outcome.out
    (folder, effort, run, data), *_ = asked
    assert folder == data == str(tmp_path) and effort.tables.seed == 3
    assert effort.curves == QUICK_REPORT.curves and run is run_with_progress
    outcome = report_program("--data", tmp_path / "none")
    assert outcome.status == 2 and "there is no such folder" in outcome.err
    outcome = report_program("--tables", "--data", tmp_path)
    assert outcome.status == 2 and "leave one out" in outcome.err
