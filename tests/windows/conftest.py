# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures: the packages for Windows, and Windows' Python with the wheel in Wine."""

import os
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest
from waiting import HANG

ROOT = Path(__file__).resolve().parents[2]
# NumPy by version of Python: that of Blender 4.5 for Windows, and the newest that works in Wine 8.
NUMPYS = {"3.11": "1.26.4", "3.13": "2.1.3"}
# Packages that tests/python needs, in versions for that NumPy of Python 3.11.
PACKAGES = (
    *("hypothesis", "scipy==1.11.4", "matplotlib==3.8.4", "meshio==5.3.5", "trimesh==4.6.0"),
    *("nibabel==5.3.2", "tifffile==2025.5.10", "pydicom==3.0.1", "mrcfile==1.5.4"),
    *("pillow==12.0.0", "flip-evaluator==1.7", "h5py==3.11.0"),
    *("zarr==2.18.3", "numcodecs==0.13.1", "crc32c==2.9.post0"),
)


def call(*command, **variables):
    """Returns the output of a program; fails the test if the program fails or hangs."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    done = subprocess.run(
        list(map(str, command)),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        timeout=4 * HANG,  # some are whole test suites
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
    """Returns the paths of the wheels, by version of Python, and of the extension."""
    command = (ROOT / "scripts" / "package", "--platform", "windows-x64")
    # No time limit, because a compiler does not hang.
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
    """Returns a version of Python as in names of wheels."""
    return f"cp{python_version.replace('.', '')}"


def windows_python(version, name, *packages):
    """Installs Windows' Python with packages of PyPI; returns the path of its program."""
    program = (ROOT / "scripts" / "windows_python", version, f"{name}-{version}")
    packages = (f"numpy=={NUMPYS[version]}", "pytest", "colorama", *packages)
    return Path(call(*program, *packages).splitlines()[-1], "python")


@pytest.fixture(scope="session")
def package_tests(made):
    """Returns a function that runs Windows' Python 3.11 with the wheel and the packages of
    tests/python.
    """
    program = windows_python("3.11", "tests", *PACKAGES)
    site = ROOT / "build" / "windows" / "tests-3.11" / "wheel"
    shutil.rmtree(site, ignore_errors=True)
    with zipfile.ZipFile(made[0]["3.11"]) as archive:
        archive.extractall(site)
    return lambda *arguments: call(program, *arguments, PYTHONPATH=str(site))


@pytest.fixture(scope="session")
def windows(made, python_version, tag, tmp_path_factory):
    """Returns a function that runs Windows' Python with the wheel and the readers of the
    extension.
    """
    program = windows_python(python_version, "plain")
    site = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(made[1]) as extension:
        for name in extension.namelist():
            if name.endswith((f"-{tag}-win_amd64.whl", "-any.whl", "-abi3-win_amd64.whl")):
                with extension.open(name) as wheel, zipfile.ZipFile(wheel) as archive:
                    archive.extractall(site)
    return lambda *arguments: call(program, *arguments, PYTHONPATH=str(site))


@pytest.fixture(scope="session")
def linux():
    """Returns a function that runs Debian's Python with the build tree."""
    built = ROOT / "build" / "release" / "python"
    return lambda *arguments: call("/usr/bin/python3", *arguments, PYTHONPATH=str(built))
