# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the tables of `bench` into docs/validation/performance.md, each between its marks.

Each section begins with the machine and the source that were measured.
"""

import math
import os
import platform
import shutil
import subprocess
from pathlib import Path

from leaflight import LeaflightError
from leaflight.io.output import check_writable, replaced
from leaflight.version import __version__

HERE = Path(__file__).resolve()
REPETITIONS = 5
PATIENCE_SECONDS = 300.0


def repetitions(seconds):
    """Returns how often to measure work of this many seconds, at least once."""
    return max(1, min(REPETITIONS, math.ceil(PATIENCE_SECONDS / max(seconds, 1e-9))))


def check_page(path, name):
    """Raises LeaflightError unless this document has a place for the tables of `bench NAME`."""
    check_writable(path, ".md")
    _split(path, name)


def write_page(path, name, lines):
    """Writes the tables of `bench NAME` into a document, completely or not at all."""
    before, after = _split(path, name)
    with replaced(path) as temporary:
        temporary.write_text(before + "\n\n" + "\n".join(lines) + "\n\n" + after)


def _split(path, name):
    """Returns the text before the tables of `bench NAME` and the text after, with the marks."""
    begin, end = f"<!-- bench {name} -->", f"<!-- /bench {name} -->"
    before, found, rest = path.read_text().partition(begin)
    _, ended, after = rest.partition(end)
    if not (found and ended):
        raise LeaflightError(
            f"{path}: there is no place for the tables of bench {name}: write a line {begin} and "
            f"below it a line {end}."
        )
    return before + begin, end + after


def measured_on():
    """Returns a sentence about this machine and the commit of the source."""
    blender = _output("blender", "--version").partition("\n")[0]
    return (
        f"Measured at {_commit()} on {os.cpu_count()} cores of {_processor()}, "
        f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"
        f"{blender and ', '}{blender}, load {os.getloadavg()[0]:.1f} before."
    )


def _commit():
    """Returns the commit of the source, followed by "-dirty" if files differ; else the version."""
    commit = _output("git", "describe", "--always", "--dirty", "--exclude", "*")
    return f"commit {commit}" if commit else f"version {__version__}"


def _processor():
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(names, "an unknown processor")


def _output(program, *arguments):
    """Returns the output of a program; empty if it is missing or fails."""
    if shutil.which(program) is None:
        return ""
    done = subprocess.run([program, *arguments], cwd=HERE.parent, capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else ""
