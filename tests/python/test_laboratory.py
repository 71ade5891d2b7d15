# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that each program of validation/ runs, with little work, or is a part of scripts/test."""

import importlib
import json
import re
import runpy
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import leaflight
import pytest
from waiting import HANG

ROOT = Path(__file__).resolve().parents[2]
RUN = ROOT / "validation" / "run"
RAYS = ROOT / "build" / "release" / "core" / "bench" / "rays_against_embree"
GOOD_FILE = ROOT / "tests" / "fuzz" / "inputs" / "save_fails_10um_in_metres.nrrd"
FOLDERS = runpy.run_path(str(RUN))["PROGRAMS"]
# Program or part of one, arguments for little work, and the start of a line that it prints.
RUNS = [
    ("bench bake --quick", "| bump box, 16^3 at 47 |"),
    ("bench scale --quick", "| bump box, 12^3 |"),
    ("bench rays --quick", "| bump box, 16^3 at 100 |"),
    ("bench scrub --quick", "| bump box, 24^3 at 100 |"),
    ("bench stage --quick", "| bump box, 24^3 | bake, last pass |"),
    ("check_cycles texture --points 30 --spp 8", "| texture | far wall |"),
    ("edits_against_cycles cuts bump --points 30 --spp 8", "| bump box | 100 |"),
    ("workers --dims 12 --workers 2", "| 2 |"),
    (f"unwritten_memory {GOOD_FILE}", "1 files, 1 read, 0 with memory that was not written"),
]
NEEDS_BLENDER = ("bench bake", "bench scrub", "bench stage", "check_cycles", "edits_against_cycles")


@pytest.fixture(autouse=True)
def build_tree():
    if not Path(leaflight.__file__).is_relative_to(ROOT / "build" / "release"):
        pytest.skip("validation/ runs the build tree")


def run(*arguments):
    command = [str(argument) for argument in (RUN, *arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=HANG)


@pytest.mark.slow
@pytest.mark.parametrize("arguments, line", RUNS, ids=lambda text: text.split(" --")[0])
def test_it_runs(arguments, line):
    if arguments.startswith(NEEDS_BLENDER) and shutil.which("blender") is None:
        pytest.skip("Blender is not installed")
    if "scrub" in arguments and find_spec("vtkmodules") is None:
        pytest.skip("there is no VTK: install the Debian package python3-vtk9")
    if "workers" in arguments and find_spec("distributed") is None:
        pytest.skip("there is no Dask: install the Debian package python3-distributed")
    if "rays" in arguments and not RAYS.exists():
        pytest.skip("it is not built: cmake --build --preset bench")
    done = run(*arguments.split())
    assert done.returncode == 0, done.stderr
    assert any(one.startswith(line) for one in done.stdout.splitlines()), done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for programs in FOLDERS.values() for name in programs])
def test_it_is_there(name):
    (folder,) = (folder for folder, programs in FOLDERS.items() if name in programs)
    if (ROOT / "validation" / folder / f"{name}.py").exists() or name == "bench":
        assert run(name, "--help").stdout.startswith("usage: ")
    else:
        script = ROOT / "validation" / folder / f"{name}.sh"
        assert subprocess.run(["bash", "-n", script]).returncode == 0


def test_another_name_is_refused():
    assert run("sing").returncode == 2
    assert all(name in run("--list").stdout for programs in FOLDERS.values() for name in programs)


@pytest.mark.slow
def test_what_is_absent_is_one_sentence(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    for program in ("against_cycles", "bench bake"):
        done = run(*program.split(), "--quick")
        assert done.returncode == 2 and "blender" in done.stderr
        assert done.stdout == "" and done.stderr.count("\n") == 1


def test_the_table_of_blenders(tmp_path):
    """Checks that incomplete sets of checks are left out."""
    compatibility = importlib.import_module("measure.compatibility")
    about = {"blender": "3.4.1", "version": [3, 4, 1], "module": False, "python": "3.11"}
    about |= {"numpy": "1.24", "system": "Debian", "checks": ["check_lights"]}
    checks = {"check_lights.py::check_a_sun": {"outcome": "passed", "cycles_over_bake": [1.01]}}
    for folder, has_results in (("whole", True), ("part", False)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "about.json").write_text(json.dumps(about))
        if has_results:
            (tmp_path / folder / "check_lights.json").write_text(json.dumps(checks))
    table = compatibility.table(tmp_path)
    assert table.splitlines()[2:] == [
        "| 3.4.1 (program) | 3.11 | 1.24 | Debian | legacy zip | 1 | 0 | - | - | - | 1.0100 |"
    ]


def test_the_bugs_of_mutations_fit_the_sources():
    """Checks that each bug's text occurs once in the core, and that its test exists."""
    mutations = importlib.import_module("break.mutations").MUTATIONS
    tests = "".join(path.read_text() for path in (ROOT / "tests/core").glob("*.cpp"))
    for mutation in mutations:
        assert (ROOT / "core" / mutation.file).read_text().count(mutation.right) == 1, mutation
        suite, test = mutation.test.split(".")
        assert re.search(rf"TEST(_\w)?\({suite}, {test}\)", tests), mutation


def test_the_page_of_bench_has_its_places():
    from measure.bench.page import check_page

    for name in ("bake", "scale", "rays", "scrub"):
        check_page(ROOT / "docs" / "validation" / "performance.md", name)
