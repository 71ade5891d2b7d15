# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the core's tests of the short suite, compiled for Windows, in Wine."""

import subprocess
import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "scripts"))
from packing.windows import libraries, wheel  # noqa: E402


def test_core():
    wine = ("env", f"WINEPREFIX={libraries.WORK / 'wine'}", "WINEDEBUG=-all", "wine")
    options = ("LEAFLIGHT_TESTS=ON", f"CMAKE_CROSSCOMPILING_EMULATOR={';'.join(wine)}")
    folder = wheel.build_folder("3.11", *options)
    # No time limit, because a compiler does not hang, and ctest limits each test.
    subprocess.run(["cmake", "--build", folder, "--target", "core_tests"], check=True)
    command = ["ctest", "--test-dir", folder, "--output-on-failure", "-LE", "slow|machine"]
    # Wine's services keep the output of the program that starts them open. So a first program
    # without output starts them, and a second ends once they run.
    nowhere = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([*wine, "cmd"], stdin=subprocess.PIPE, **nowhere):
        subprocess.run([*wine, "cmd", "/c", "rem"], stdin=subprocess.DEVNULL, check=True, **nowhere)
        done = subprocess.run(
            [*command, "--no-tests=error", "--parallel", "2"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
    print(done.stdout)
    if done.returncode != 0:
        pytest.fail(f"The core's tests failed by Wine:\n{done.stdout}", pytrace=False)
