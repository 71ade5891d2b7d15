# SPDX-License-Identifier: GPL-3.0-or-later
"""The packages for Windows, and Windows' Python with the wheel, run by Wine."""

import os
import subprocess
import zipfile
from pathlib import Path

import pytest
from waiting import HANG

ROOT = Path(__file__).resolve().parents[2]
# Version of Python -> NumPy: what Blender 4.5 for Windows brings along, and the newest that needs
# no function that Wine 8 lacks.
NUMPYS = {"3.11": "1.26.4", "3.13": "2.1.3"}


def call(*command, **variables):
    """What a program prints; fails the test when the program fails or hangs."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    done = subprocess.run(
        list(map(str, command)),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        timeout=HANG,
        cwd=ROOT,
        env={**kept, "PYTHONNOUSERSITE": "1", **variables},
    )
    if done.returncode != 0:
        pytest.fail(f"{command[0]} exited with {done.returncode}:\n{done.stdout}", pytrace=False)
    return done.stdout


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def made():
    """The paths of the wheels, by version of Python, and of the extension."""
    command = (ROOT / "scripts" / "package", "--platform", "windows-x64")
    # A compiler does not hang.
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    *wheels, extension = [ROOT / name for name in done.stdout.splitlines()[-1].split()]
    return dict(zip(NUMPYS, wheels, strict=True)), extension


@pytest.fixture(scope="session", params=NUMPYS)
def python_version(request):
    return request.param


@pytest.fixture(scope="session")
def numpy_version(python_version):
    return NUMPYS[python_version]


@pytest.fixture(scope="session")
def tag(python_version):
    """As names of wheels have it."""
    return f"cp{python_version.replace('.', '')}"


@pytest.fixture(scope="session")
def windows(made, python_version, numpy_version, tag, tmp_path_factory):
    """Runs Windows' Python with the wheel and the readers of the extension."""
    packages = (f"numpy=={numpy_version}", "pytest", "colorama")
    program = (ROOT / "scripts" / "windows_python", python_version, f"plain-{python_version}")
    folder = call(*program, *packages).splitlines()[-1]
    site = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(made[1]) as extension:
        for name in extension.namelist():
            if name.endswith((f"-{tag}-win_amd64.whl", "-any.whl", "-abi3-win_amd64.whl")):
                with extension.open(name) as wheel, zipfile.ZipFile(wheel) as archive:
                    archive.extractall(site)
    return lambda *arguments: call(Path(folder, "python"), *arguments, PYTHONPATH=str(site))


@pytest.fixture(scope="session")
def linux():
    """Runs Debian's Python with the build tree."""
    built = ROOT / "build" / "release" / "python"
    return lambda *arguments: call("/usr/bin/python3", *arguments, PYTHONPATH=str(built))
