# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for the packages for macOS. There is no macOS here, so nothing of them runs."""

import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT / "scripts")]
# Apple's names of the processors, by Blender's names of the platforms.
PROCESSORS = {"macos-arm64": "arm64", "macos-x64": "x86_64"}
PYTHONS = ("3.11", "3.13")


@dataclass(frozen=True)
class Wheel:
    path: Path
    processor: str
    python: str

    @property
    def tag(self):
        return f"cp{self.python.replace('.', '')}"

    @property
    def module(self):
        return f"leaflight/_core.cpython-{self.tag[2:]}-darwin.so"


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def made():
    """Returns the paths of all packages for macOS."""
    command = [ROOT / "scripts" / "package"]
    for platform in PROCESSORS:
        command += ["--platform", platform]
    # No time limit, because a compiler does not hang.
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    return [ROOT / name for name in done.stdout.splitlines()[-1].split()]


@pytest.fixture(
    scope="session",
    params=[(processor, python) for processor in PROCESSORS.values() for python in PYTHONS],
    ids=lambda both: "-".join(both),
)
def wheel(request, made):
    processor, python = request.param
    tag = f"cp{python.replace('.', '')}"
    (path,) = (p for p in made if re.search(rf"-{tag}-\w+_{processor}\.whl$", p.name))
    return Wheel(path, processor, python)


@pytest.fixture(scope="session", params=PROCESSORS)
def extension(request, made):
    """Returns the path of an extension, the platform and the processor."""
    platform = request.param
    (path,) = (p for p in made if p.name.endswith(f"-{platform.replace('-', '_')}.zip"))
    return path, platform, PROCESSORS[platform]
