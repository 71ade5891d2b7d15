# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the start of the program: its time, and which modules it does not import."""

import subprocess
import sys
from pathlib import Path

import leaflight
import pytest
from leaflight.io.readers import raw
from leaflight.io.sources import GENERATED
from leaflight_command import parser, shared_options
from waiting import HANG

# Program that compares the processor time of main() with that of an empty interpreter.
MEASURE = """
import sys, time
sys.path.insert(0, sys.argv.pop(1))
empty = time.process_time()
import leaflight_command
try:
    leaflight_command.main()
except SystemExit:
    pass
print(empty, time.process_time(), "leaflight" in sys.modules, "numpy" in sys.modules)
"""


def measured(*arguments):
    """Returns (seconds of an empty interpreter, of the program, True if it loaded modules)."""
    folder = Path(leaflight.__file__).parents[1]
    command = [sys.executable, "-c", MEASURE, str(folder), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, check=True)
    empty, whole, *loaded = done.stdout.splitlines()[-1].split()
    return float(empty), float(whole), "True" in loaded


HELP = pytest.mark.parametrize("arguments", [["--help"], ["bake", "--help"], ["bake", "--no-such"]])


@HELP
def test_help_loads_nothing_that_only_the_work_needs(arguments):
    assert not measured(*arguments)[2]


@pytest.mark.machine
@HELP
def test_help_is_soon_there(arguments):
    # Use the fastest of three runs, because other work on the machine only adds time.
    runs = [measured(*arguments) for _ in range(3)]
    empty, whole = min(empty for empty, _, _ in runs), min(whole for _, whole, _ in runs)
    # Importing NumPy and the compiled module takes ten times as long as an empty interpreter.
    assert whole < 6 * empty


def test_commands_load_what_they_need():
    """Checks that other commands do import these modules, so that the test above can fail."""
    assert measured("info", "bump_box", "--dims", "4")[2]


def test_the_parser_knows_what_the_package_knows():
    assert shared_options.TYPES == raw.TYPES and shared_options.ENDIANS == tuple(raw.ENDIANS)
    assert parser.GENERATED == GENERATED


def test_version(script):
    assert script("--version").out == f"leaflight {leaflight.__version__}\n"
