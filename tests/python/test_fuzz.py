# SPDX-License-Identifier: GPL-3.0-or-later
"""A few damaged files of every kind, the same in every run; scripts/fuzz tries many more."""

import json
import os
import subprocess
import sys
from pathlib import Path

import leaflight
import pytest

FUZZ = Path(__file__).resolve().parents[1] / "fuzz"
sys.path.append(str(FUZZ))

from targets import TARGETS, missing_library  # noqa: E402


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_damaged(tmp_path, target):
    why = missing_library(target)
    if why:
        pytest.skip(why)
    package = Path(leaflight.__file__).parents[1]
    count = 6 if target.slow else 150
    done = subprocess.run(
        [sys.executable, FUZZ / "worker.py", target.name, tmp_path, "1", "600", str(count)],
        env={**os.environ, "PYTHONPATH": f"{package}:{FUZZ}"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["tried"] == count and found["accepted"] < count
