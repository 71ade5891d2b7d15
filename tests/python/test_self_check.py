# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the errors of `import leaflight`, each one sentence."""

import platform
import shutil
import sys
import time
from pathlib import Path

import leaflight
import numpy as np
import pytest
from leaflight import _core, self_check
from outcomes import written
from waiting import run_python

PACKAGE = Path(leaflight.__file__).parent
NUMPYS_FOLDER = str(Path(np.__file__).parents[1])


class Changed:
    """The compiled module with one other function."""

    def __init__(self, **changed):
        self.__dict__.update(changed)

    def __getattr__(self, name):
        return getattr(_core, name)


def refusal(check, *arguments):
    with pytest.raises(ImportError) as caught:
        check(*arguments)
    sentence = str(caught.value)
    assert sentence.endswith(".") and ". " not in sentence and "\n" not in sentence
    return sentence


@pytest.mark.parametrize("limit, threads", [(500 << 20, 2), ((2 << 30) - 1, 64)])
def test_too_little_memory(limit, threads):
    sentence = refusal(self_check.check_memory, limit, threads)
    assert f"this process is limited to {limit >> 20} MiB" in sentence


@pytest.mark.parametrize("limit, threads", [(None, 64), (2 << 30, 64), (2 << 30, None)])
def test_enough_memory(limit, threads):
    self_check.check_memory(limit, threads)


@pytest.mark.machine
def test_it_takes_milliseconds():
    start = time.perf_counter()
    for _ in range(10):
        self_check.check()
    assert time.perf_counter() - start < 0.5


@pytest.mark.parametrize("version", ["1.23.5", "1.9.0"])
def test_an_old_numpy(version):
    assert f"NumPy {version} is installed" in refusal(self_check.check_numpy, version)


@pytest.mark.parametrize("version", ["1.24.0", "1.26.4", "2.0.0rc1", "2.4.1"])
def test_numpys_that_will_do(version):
    self_check.check_numpy(version)


def test_an_old_processor():
    features = {"SSE42": True, "POPCNT": False}
    assert "processor lacks POPCNT" in refusal(self_check.check_processor, features)


def test_the_processor_here():
    features = self_check._processor_features()
    self_check.check_processor(features)
    if platform.machine() == "x86_64":
        assert set(self_check.PROCESSOR_FEATURES) < set(features)


def test_the_libraries_that_are_loaded():
    found = {name: (built, loaded) for name, built, loaded in _core.libraries()}
    assert set(found) == {"oneTBB", "Embree"}
    assert found["oneTBB"][1] >= (12, 0) and found["Embree"][1][0] in (3, 4)


@pytest.mark.parametrize("loaded", [(11, 9), (12, 4), (13, 0)])
def test_another_library_than_the_one_built_with(loaded):
    sentence = refusal(self_check.check_libraries, [("oneTBB", (12, 8), loaded)])
    assert f"built with oneTBB 12.8, but oneTBB {loaded[0]}.{loaded[1]} is loaded" in sentence


def test_a_newer_library_of_the_same_major_version():
    self_check.check_libraries([("oneTBB", (12, 8), (12, 8)), ("Embree", (3, 13), (3, 14))])


# Fields as a module would make them that reads arrays with the layout of another NumPy.
MISREADINGS = {
    "shifted": lambda values, matrix: _core.Field(np.roll(values, 1).copy(), matrix),
    "transposed": lambda values, matrix: _core.Field(np.ascontiguousarray(values.T), matrix),
    "unmoved": lambda values, matrix: _core.Field(values, np.eye(4)),
}


@pytest.mark.parametrize("name", MISREADINGS)
def test_arrays_that_arrive_as_something_else(name):
    sentence = refusal(self_check.check_arrays, np, Changed(Field=MISREADINGS[name]))
    assert f"misreads arrays of NumPy {np.__version__}" in sentence


def test_arrays_that_the_module_refuses(monkeypatch):
    def empty(values, matrix):
        return _core.Field(np.full_like(values, np.nan), matrix)

    monkeypatch.setattr(self_check, "_core", lambda: Changed(Field=empty))
    assert "fails its self-test" in refusal(self_check.check)


def _off(*arguments):
    hit, (x, y, z) = _core.trace(*arguments)
    return hit, (x, y, z + 1e-3)


WRONG_TRACES = {
    "no hit": lambda *arguments: (None, None),
    "off": _off,
    "through isosurfaces": lambda scene, origin, *others: _core.trace(
        scene, (*origin[:2], 1.5), *others
    ),
}


@pytest.mark.parametrize("name", WRONG_TRACES)
def test_rays_that_go_elsewhere(name):
    changed = Changed(trace=WRONG_TRACES[name])
    assert "traces rays wrongly" in refusal(self_check.check_rays, np, changed)


@pytest.fixture
def copy(tmp_path):
    """Copies the package to a new folder, so that a test can change its files."""
    ignored = shutil.ignore_patterns("__pycache__", "_core*")
    for name in ("leaflight", "leaflight_command"):
        shutil.copytree(PACKAGE.parent / name, tmp_path / name, ignore=ignored)
    return tmp_path


PYTHON = f"{sys.version_info[0]}.{sys.version_info[1]}"
(MODULE,) = (path.name for path in PACKAGE.glob("_core.cp*"))
# Files that spoil an installation, and what is then said.
SPOILT = {
    "no module": (None, "", f"no compiled module for Python {PYTHON}"),
    "damaged module": (f"leaflight/{MODULE}", "no library", "compiled module cannot be loaded"),
    "old NumPy": ("numpy.py", '__version__ = "1.23.5"\n', "NumPy 1.23.5 is installed"),
    "no NumPy": ("numpy.py", "raise ImportError('gone')\n", "needs NumPy, which this Python"),
}


@pytest.mark.parametrize("name", SPOILT)
def test_the_command_says_it_in_one_line(copy, name):
    spoilt, content, expected = SPOILT[name]
    if spoilt:
        written(copy / spoilt, content)
    where = {"paths": (copy, NUMPYS_FOLDER), "cwd": copy}
    done = run_python("-m", "leaflight_command", "info", "bump_box", **where)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.startswith("leaflight: ") and done.stderr.count("\n") == 1
    assert expected in done.stderr
    imported = run_python("-c", "import leaflight", **where)
    assert imported.returncode == 1 and expected in imported.stderr.splitlines()[-1]
