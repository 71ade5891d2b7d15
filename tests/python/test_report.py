# SPDX-License-Identifier: GPL-3.0-or-later
"""The report: the thesis's tables with little work, their verdicts, and the files written."""

import csv
import json
from dataclasses import replace

import reports.command as command_line
import numpy as np
import pytest
from leaflight import LeaflightError, Progress
from reports.experiments import QUICK, Effort, Row, Trial, judged, table_3_1
from reports.pictures import side_by_side, slice_picture, surface_picture, texture_picture
from reports.report import COLUMNS, report_tables
from leaflight.thesis import Scattered
from PIL import Image

pytestmark = pytest.mark.slow

TINY = Effort(
    photons=20_000,
    flat_texels=40,
    flat_samples=2000,
    flat_rays=32,
    flat_reference_samples=40_000,
    flat_reference_rays=32,
    texels=16,
    samples_and_rays=((20_000, 32), (40_000, 8)),
    repetitions=1,
    vertices=200,
    paths=128,
    picture_paths=4,
    neuron_texels=20,
    neuron_samples=2000,
    neuron_rays=4,
    neuron_factors=(1, 2),
)
# Further columns of errors.
OTHERS = {
    "table_3_1": {"averaged reference"},
    "table_4_2": {"isosurface 20", "isosurface 100"},
    "figure_4_9": set(),
}


def quietly(work, label):
    assert label
    return work(Progress())


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report") / "new" / "folder"
    return folder, report_tables(folder, TINY, quietly)


def rows_of(result, table):
    return {
        (row["strategy"], row["samples"]): row for row in result["rows"] if row["table"] == table
    }


def test_bad_strategies_are_worse(written):
    _, result = written
    flat = rows_of(result, "table_3_1")
    uniform = flat["uniform", 2000]
    assert uniform["ours"] < 6 and uniform["printed"] == 2.2
    assert flat["non-uniform (letters)", 2000]["ours"] > 3 * uniform["ours"]
    space = rows_of(result, "table_4_2")
    assert space["non-uniform (slabs)", 20_000]["ours"] > 1.5 * space["uniform", 20_000]["ours"]
    assert {row["printed"] for row in space.values()} == {1.29, 1.08, 9.55, 9.57, 3.59, 3.47, None}
    assert all(row["seconds"] > 0 for row in result["rows"])
    # Another seed, another error, but of the same size.
    again = space["uniform, seed 1", 20_000]
    assert again["printed"] == 1.29 and again["ours"] != space["uniform", 20_000]["ours"]
    assert again["ours"] == pytest.approx(space["uniform", 20_000]["ours"], rel=0.2)
    assert all(0 < row["isosurface 20"] < 40 for row in space.values())


def test_every_row_is_judged(written):
    """Nothing that errs more than the thesis's samples is passed over, whatever its filter."""
    _, result = written
    unjudged = {row["strategy"] for row in result["rows"] if row["passed"] is None}
    assert unjudged == {"uniform, the thesis's estimator", "importance"}
    space = rows_of(result, "table_4_2")
    assert space["importance", 20_000]["passed"] is not None


def test_files(written):
    folder, result = written
    assert result["out"] == str(folder) and result["seed"] == 0
    text = (folder / "tables.md").read_text()
    for row in result["rows"]:
        assert f"| {row['strategy']} |" in text and f" {row['ours']:.2f} |" in text
    for name in ("table_3_1", "table_4_2", "figure_4_9"):
        with open(folder / "csv" / f"{name}.csv", newline="") as file:
            lines = list(csv.DictReader(file))
        own = [row for row in result["rows"] if row["table"] == name]
        assert [line["strategy"] for line in lines] == [row["strategy"] for row in own]
        assert [float(line["ours"]) for line in lines] == [row["ours"] for row in own]
        assert set(lines[0]) - {*COLUMNS, "passed", "seed"} == OTHERS[name]
    images = {path.name for path in (folder / "images").iterdir()}
    for line in text.splitlines():
        if line.startswith("!["):
            assert line.split("images/")[1].rstrip(")") in images
    with Image.open(folder / "images" / "table_3_1_textures_uniform.png") as picture:
        assert picture.size == (40, 40) and np.asarray(picture).std() > 10


def test_same_every_time(written):
    _, result = written
    table = table_3_1(replace(TINY, threads=1), quietly)
    flat = [row["ours"] for row in result["rows"] if row["table"] == "table_3_1"]
    assert [row.error for row in table.rows] == flat


def row(error, strategy="uniform", **options):
    scattered = Scattered(strategy, 100) if strategy else None
    return Row(Trial(strategy or "texels", 100, 1, scattered, **options), error, 1.0)


def test_verdicts():
    rows = judged(
        [
            row(1.2, printed=1.29),
            row(1.29, "importance"),
            row(1.3, "stratified"),
            row(1.3, None),
            row(3.6, "slabs", printed=9.55),
            row(3.5, "level_set"),
            row(9.0, "uniform", judged=False),
        ]
    )
    assert [row.passed for row in rows] == [True, True, False, False, True, False, None]
    assert [row.verdict for row in rows] == [
        "at or below 1.29",
        "at or below 1.29",
        "above 1.29",
        "above 1.29",
        "3.0 times uniform",
        "2.9 times uniform, too good",
        "for comparison",
    ]
    assert judged([row(2.0, printed=1.29)])[0].passed is False


def test_efforts():
    """The quick report differs in its effort alone: less of everything."""
    full = Effort()
    assert QUICK.flat_samples == full.flat_samples == 20_000
    assert full.flat_reference_samples == QUICK.flat_reference_samples == 10_000_000
    assert [samples for samples, _ in full.samples_and_rays] == [1_000_000, 10_000_000]
    assert [samples for samples, _ in QUICK.samples_and_rays] == [1_000_000]
    assert full.flat_texels == 800 and full.texels == 100


def test_pictures():
    texture = np.zeros((3, 4, 5, 3), dtype=np.float32)
    texture[1, 0, 0] = 1
    flat = texture_picture(texture[1], 1.0)
    assert flat.shape == (4, 5, 3) and (flat[-1, 0] == 255).all() and flat.sum() == 3 * 255
    cut = slice_picture(texture, 1.0, zoom=2)
    assert cut.shape == (8, 10, 3) and (cut[-2:, :2] == 255).all() and cut.sum() == 12 * 255
    row = side_by_side([cut, cut[:, :6]], reduction=2)
    assert row.shape == (4, 5 + 8 + 3, 3) and (row[:, 5:13] == 255).all()
    # Two squares facing the viewer; the red one is behind the green one and larger.
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=np.float32)
    vertices = np.concatenate([2 * square - 0.5, square + [0, 0, 0.1]]).astype(np.float32)
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    radiance = np.repeat(np.eye(3)[[0, 1]], 4, axis=0).astype(np.float32)
    for order in ([0, 1, 2, 3], [2, 3, 0, 1]):
        seen = surface_picture(vertices, triangles[order], radiance, 1.0)
        size = len(seen)
        assert seen.shape == (size, size, 3)
        assert (seen[size // 2, size // 2] == (0, 255, 0)).all()
        assert (seen == (255, 0, 0)).all(axis=2).mean() > 0.2


def test_command_line(report_program, monkeypatch, tmp_path):
    """The exit status says whether all errors are what they must be; these cannot."""

    def one_table(folder, effort, run):
        return report_tables(folder, effort, run, tables=(table_3_1,))

    monkeypatch.setattr(command_line, "QUICK", TINY)
    monkeypatch.setattr(command_line, "report_tables", one_table)
    outcome = report_program("--tables", "--quick", "--out", tmp_path, "--seed", 3, "--json")
    assert outcome.status == 1, outcome.err
    result = json.loads(outcome.out.splitlines()[-1])
    assert result["passed"] is False and result["seed"] == 3 and len(result["rows"]) == 6
    assert {"ours", "printed", "verdict"} <= set(result["rows"][0])
    assert "thesis 2.2 %" in outcome.out and "not what they must be" in outcome.out
    good = {**result, "passed": True}
    monkeypatch.setattr(command_line, "report_tables", lambda *_: good)
    assert report_program("--tables").status == 0


def test_bad_command_lines(report_program, tmp_path):
    blocked = tmp_path / "file"
    blocked.touch()
    outcome = report_program("--tables", "--out", blocked / "folder")
    assert outcome.status == 2 and "cannot make this folder" in outcome.err
    with pytest.raises(LeaflightError, match="folder"):
        report_tables(blocked, TINY, quietly)
