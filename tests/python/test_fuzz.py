# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests a few damaged files of each kind, and that no reader returns memory it has not filled."""

import json
import platform
import shutil
import sys
from pathlib import Path

import pytest
from leaflight.io.readers.reading import OPTIONS
from leaflight_command.parser import make_parser
from poisoned import PATTERNS, UNWRITTEN, answers
from waiting import package_folder, run_python

FUZZ = Path(__file__).resolve().parents[1] / "fuzz"
sys.path.append(str(FUZZ))

from targets import TARGETS, missing_library, seeds_of  # noqa: E402

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


# Targets of the fuzzer: at least one for each reader.
READ = [target for target in TARGETS if target.arguments[0] == "info"]


@pytest.mark.skipif(
    platform.libc_ver()[0] != "glibc", reason="the GNU C library fills what it allocates"
)
def test_what_is_read_is_the_same_whatever_the_memory_held(tmp_path):
    files, names = [(UNWRITTEN, {})], [UNWRITTEN]
    for target in READ:
        if missing_library(target):
            continue
        made = tmp_path / target.name
        for number, data in enumerate(seeds_of(target, made)):
            names.append(f"{target.name} {number}")
            # Copy the folder, because the file refers to others.
            path = shutil.copytree(made, tmp_path / names[-1]) / f"input{target.suffix}"
            (path / target.within).write_bytes(data)
            files.append((path, _options(target)))
    first, second = answers(files)
    # An unfilled array must show the patterns.
    assert [first.pop(0), second.pop(0)] == [[[hex(pattern)]] * 6 for pattern in PATTERNS]
    refused = [text for text in first if not text.startswith("read ")]
    assert [text for text in refused if "needs the Python package" not in text] == []
    assert [name for name, one, two in zip(names[1:], first, second) if one != two] == []


def _options(target):
    """Returns the options of read_volume() among the arguments of a target."""
    given = vars(make_parser().parse_args(target.arguments))
    return {name: given[name] for name in OPTIONS if given[name] is not None}
