# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests a few damaged files of each kind, the same in every run. validation/run fuzz tests many
more.
"""

import json
import sys
from pathlib import Path

import pytest
from waiting import package_folder, run_python

FUZZ = Path(__file__).resolve().parents[1] / "fuzz"
sys.path.append(str(FUZZ))

from targets import TARGETS, missing_library  # noqa: E402

ALL = pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
UNLIMITED = """
import math, sys
import worker
from leaflight import progress_bar
worker.MOST_SECONDS, worker.MOST_MEMORY, progress_bar.PATIENCE_SECONDS = 0, math.inf, math.inf
worker.main(*sys.argv[1:])
"""


@ALL
def test_damaged(tmp_path, target):
    try_files(tmp_path, target, 6 if target.slow else 60, "-c", UNLIMITED)


@pytest.mark.machine
@ALL
def test_damaged_takes_little_time_and_memory(tmp_path, target):
    try_files(tmp_path, target, 6 if target.slow else 150, FUZZ / "worker.py")


INPUTS = sorted((FUZZ / "inputs").iterdir())


@pytest.mark.parametrize("path", INPUTS, ids=lambda path: path.stem)
def test_files_that_broke_the_program(script, tmp_path, path):
    """Checks files found by fuzzing: crashes, and a good file whose bake could not be written."""
    out = tmp_path / "x.vdb"
    volume = ["bump_box", "--dims", 8, "--scene", path] if path.suffix == ".json" else [path]
    outcome = script("bake", *volume, "--error", 50, "--out", out)
    if path.stem == "save_fails_10um_in_metres":
        # A good file, whose bake could not be written.
        assert outcome.status == 0 and out.exists()
    else:
        assert outcome.status == 2 and outcome.err.count("\n") == 1 and not out.exists()


def try_files(folder, target, count, *worker):
    why = missing_library(target)
    if why:
        pytest.skip(why)
    arguments = (*worker, target.name, folder, "1", "inf", count)
    done = run_python(*arguments, paths=(package_folder(), FUZZ))
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["tried"] == count and found["accepted"] < count
