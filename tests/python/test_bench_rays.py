# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench rays`: both trace the same rays; what is absent is named; times are not judged."""

import json

import benchmarks.rays as rays_module
import pytest
from leaflight import Cancelled, LeaflightError, Progress
from benchmarks.page import write_page
from benchmarks.rays import KINDS, QUICK_RAYS, RayCase, measure_rays


def is_built():
    try:
        return rays_module.program().exists()
    except LeaflightError:
        return False


needs_program = pytest.mark.skipif(not is_built(), reason="a wheel has no benchmarks of the core")


def quietly(work, label):
    assert label.startswith("bench: ")
    return work(Progress())


@pytest.mark.slow
@needs_program
def test_quick_rays(bench_program, tmp_path):
    outcome = bench_program("rays", "--quick", "--json")
    assert outcome.status == 0, outcome.err
    result = json.loads(outcome.out.splitlines()[-1])
    assert [row["isovalue"] for row in result["cases"]] == [20.0, 47.0, 100.0]
    for row in result["cases"]:
        for kind in KINDS:
            speed, peer = (row[f"{by}rays_per_second_{kind}"] for by in ("", "embree_"))
            assert row[f"ratio_{kind}"] == pytest.approx(speed / peer) and speed > 0
        # The same rays, but for the few that start beneath a triangle of the mesh.
        hits, peer = row["hits_intersect"], row["embree_hits_intersect"]
        assert hits == row["hits_occluded"] and peer == row["embree_hits_occluded"]
        assert abs(hits - peer) < 0.1 * row["rays"] and row["triangles"] > 100
    assert max(row["hits_intersect"] for row in result["cases"]) > 0
    ratios = [row[f"ratio_{kind}"] for row in result["cases"] for kind in KINDS]
    assert result["min_ratio"] == min(ratios)
    page = tmp_path / "page.md"
    write_page(page, "rays", result)
    assert page.read_text().count("| bump box, 16^3 at ") == 3


@pytest.mark.slow
@needs_program
def test_an_isovalue_without_a_surface_has_no_row():
    case = RayCase("bump box", QUICK_RAYS.cases[0].volumes, (47.0, 1e6))
    effort = rays_module.RayEffort((case, RayCase("none", lambda *_: None, (1.0,))), 100, 1)
    rows, absent = measure_rays(effort, quietly)
    assert [row["isovalue"] for row in rows] == [47.0] and absent == ["none"]


@pytest.mark.slow
@needs_program
def test_it_can_be_cancelled():
    progress = Progress()
    progress.cancel()
    # 500 million rays.
    effort = rays_module.RayEffort(QUICK_RAYS.cases, 500_000, 1000)
    with pytest.raises(Cancelled):
        measure_rays(effort, lambda work, _: work(progress))


def test_without_the_program(monkeypatch, bench_program):
    monkeypatch.setattr(rays_module, "PROGRAM", "absent")
    with pytest.raises(LeaflightError, match="cmake --build --preset bench"):
        rays_module.program()
    outcome = bench_program("rays", "--only", "bump")
    assert outcome.status == 2 and "leave it out (--only)" in outcome.err
