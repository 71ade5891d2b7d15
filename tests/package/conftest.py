# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures: the packages that scripts/package makes, and a virtual environment with the wheel."""

import os
import subprocess
from pathlib import Path

import pytest
from waiting import HANG

ROOT = Path(__file__).resolve().parents[2]


def call(*command, timeout=HANG, **options):
    """Returns the output of a program; fails the test if the program fails or hangs."""
    done = subprocess.run(
        list(map(str, command)),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=timeout,
        **options,
    )
    if done.returncode != 0:
        pytest.fail(f"{command[0]} exited with {done.returncode}:\n{done.stdout}", pytrace=False)
    return done.stdout


def environment(**more):
    """Returns the environment variables of this process without the user's paths and settings of
    Python.
    """
    kept = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    return {**kept, "PYTHONNOUSERSITE": "1", **more}


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def run():
    return call


@pytest.fixture(scope="session")
def plain_environment():
    return environment


@pytest.fixture(scope="session")
def made():
    """Returns the packages by kind: wheel, sdist, extension, legacy."""
    # No time limit, because a compiler does not hang.
    last = call(ROOT / "scripts" / "package", "--quick", timeout=None).splitlines()[-1]
    paths = [ROOT / name for name in last.split()]
    wheel, sdist, extension, legacy = paths
    assert wheel.suffix == ".whl" and sdist.name.endswith(".tar.gz")
    assert legacy.name.endswith("-legacy.zip") and extension.suffix == ".zip"
    return {"wheel": wheel, "sdist": sdist, "extension": extension, "legacy": legacy}


@pytest.fixture(scope="session")
def installed(made, tmp_path_factory):
    """Returns the Python of a new virtual environment with the wheel, installed as users do."""
    folder = tmp_path_factory.mktemp("installed")
    call("/usr/bin/python3", "-m", "venv", folder)
    python = folder / "bin" / "python"
    call(python, "-m", "pip", "install", "--quiet", "numpy>=2", made["wheel"])
    return python
