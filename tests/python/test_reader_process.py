# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the process that reads files: its imports, and how it returns errors and values.

An absent package is named, with the command that installs it.
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from leaflight import LeaflightError
from leaflight.io import reader_process
from leaflight.io.reader_process import ReaderProcess
from leaflight.io.readers import MissingPackage, missing_package
from leaflight.volume.setting_error import SettingError
from outcomes import refused
from waiting import run_python

MODULE = """
import os
import numpy as np
from leaflight import LeaflightError
from leaflight.io.reader_process import requests
from leaflight.volume.setting_error import SettingError

VALUES = np.arange(24, dtype="<u2").reshape(2, 3, 4)

def two_pieces(path):
    return {"name": path.name}, iter(VALUES)

def refuses(path):
    raise LeaflightError(f"{path}: no.")

def refuses_a_setting(path):
    raise SettingError(f"{path}: no.", "dataset")

def needs_a_package(path):
    import is_not_installed.at_all

def fails(path):
    raise KeyError("x")

def refuses_later(path):
    def pieces():
        yield VALUES[0]
        raise LeaflightError(f"{path}: not the second.")
    return None, pieces()

def pages(path):
    def answers():
        for path, number in requests():
            if number == 9:
                raise LeaflightError(f"{path}: no page 9.")
            yield VALUES[0] + (os.getpid() if number < 0 else number)
    return None, answers()

def names_its_version(path):
    import shadowed
    return shadowed.VERSION, ()
"""


@pytest.fixture
def call(tmp_path, monkeypatch):
    (tmp_path / "its_functions.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "file.dat").write_bytes(b"")
    return lambda function: ReaderProcess(tmp_path / "file.dat", "file", "its_functions", function)


def test_values_come_piece_by_piece(call):
    values = np.zeros((2, 3, 4), "<u2")
    with call("two_pieces") as process:
        assert process.answer() == {"name": "file.dat"}
        process.fill(values)
    np.testing.assert_array_equal(values.ravel(), np.arange(24))
    with call("two_pieces") as process:
        process.answer()
        one = process.array(most=24)
        np.testing.assert_array_equal(one, values[0])
        refused("crashed or exceeded", process.array, most=23)
    # The array must have exactly the size of the values.
    for shape in ((3, 3, 4), (1, 3, 3)):
        with call("two_pieces") as process:
            process.answer()
            refused("crashed or exceeded", process.fill, np.zeros(shape, "<u2"))


def test_errors_come_as_they_were_raised(call):
    def error(function):
        with call(function) as process, pytest.raises(Exception) as caught:
            process.answer()
        return caught.value

    assert type(error("refuses")) is LeaflightError
    assert error("refuses_a_setting").settings == ("dataset",)
    assert type(error("refuses_a_setting")) is SettingError
    assert error("needs_a_package").name == "is_not_installed"
    assert type(error("fails")) is ValueError
    with call("refuses_later") as process:
        process.answer()
        refused("not the second", process.fill, np.zeros((2, 3, 4), "<u2"))


def test_one_process_decodes_all_pages(call, tmp_path):
    def page(name, number, most=24):
        path = tmp_path / name
        return reader_process.decoded(path, "file", ("its_functions", "pages"), most, number)

    (tmp_path / "other.dat").write_bytes(b"")
    first = np.arange(12, dtype="<u2").reshape(3, 4)
    with reader_process.kept_processes():
        np.testing.assert_array_equal(page("file.dat", 3), first + 3)
        np.testing.assert_array_equal(page("other.dat", 4), first + 4)
        number = page("file.dat", -1, most=1000)
        np.testing.assert_array_equal(number, page("other.dat", -1, most=1000))
        refused("other.dat: no page 9", page, "other.dat", 9)
        # A new process takes its place.
        assert not np.array_equal(number, page("other.dat", -1, most=1000))
    # Without kept_processes(), each page has its own process.
    np.testing.assert_array_equal(page("file.dat", 3), first + 3)
    refused("file.dat: .* crashed", page, "file.dat", 3, most=23)


def test_packages_of_its_own_win(call, tmp_path, monkeypatch):
    """Checks that the package's own versions win over those of other add-ons in Blender."""
    assert reader_process.PACKAGES[0].endswith("leaflight_readers")
    monkeypatch.setattr(reader_process, "PACKAGES", [str(tmp_path / "own")])
    (tmp_path / "shadowed.py").write_text("VERSION = 'of another add-on'")
    with call("names_its_version") as process:
        assert process.answer() == "of another add-on"
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "shadowed.py").write_text("VERSION = 'own'")
    with call("names_its_version") as process:
        assert process.answer() == "own"


# Program that prints its sys.modules.
ALL_READERS = """
import importlib, json, sys
from leaflight.io import readers
for kind in readers.FORMATS:
    importlib.import_module("leaflight.io.readers." + kind.module)
print(json.dumps(sorted(set(sys.modules) - own)))
"""


def test_compiled_readers_are_imported_nowhere_else():
    # pydicom imports its decoders itself from version 3.0 on.
    script = f"import sys; sys.path[:] = {sys.path}\nimport pydicom; own = set(sys.modules)\n"
    loaded = set(json.loads(run_python("-c", script + ALL_READERS, check=True).stdout))
    assert "leaflight.io.readers.hdf5" in loaded
    assert not loaded & {"h5py", "zarr", "numcodecs", "crc32c", "gemmi", "openjpeg", "libjpeg"}


@pytest.fixture
def system(monkeypatch):
    """Simulates a system whose pip refuses or not, and with or without Debian's apt."""

    def become(managed, apt=True):
        monkeypatch.setattr(missing_package, "_is_managed", lambda: managed)
        monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}" if apt else None)

    return become


def said(package):
    return str(MissingPackage(Path("x"), "CZI file", package))


def test_where_pip_installs(system):
    system(managed=False)
    assert f"not installed; run '{sys.executable} -m pip install h5py'." in said("h5py")
    assert "-m pip install pillow'." in said("PIL")


def test_what_debian_has(system):
    system(managed=True)
    assert said("h5py").endswith("run 'apt install python3-h5py' as root.")
    assert MissingPackage(Path("x"), "HDF5 file", "h5py").of_debian == "python3-h5py"


@pytest.mark.parametrize("apt", [True, False])
def test_what_only_a_virtual_environment_can_have(system, monkeypatch, apt):
    """Checks that the command excludes requirements that would replace the system's packages."""
    system(True, apt)
    root = Path(missing_package.__file__).parents[3]
    monkeypatch.setenv("PYTHONPATH", f"/elsewhere:{root}")
    sentence = said("pylibCZIrw")
    assert "-m venv --system-site-packages ~/leaflight-python && ~/leaflight-python/" in sentence
    assert "pip install --no-deps pylibCZIrw validators xmltodict'" in sentence
    assert sentence.endswith(f"'PYTHONPATH={root} ~/leaflight-python/bin/python -m leaflight'.")
    assert len(sentence) < 600
    monkeypatch.delenv("PYTHONPATH")
    assert said("nd2").endswith("by '~/leaflight-python/bin/python -m leaflight'.")


def test_pip_refuses_where_this_says_so():
    """Compares with pip, which may refuse, but never in a virtual environment."""
    managed = missing_package._is_managed()
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--no-index", "nothing-at-all"]
    done = subprocess.run(command, capture_output=True, text=True)
    if "No module named pip" in done.stderr:
        pytest.skip("there is no pip")
    assert ("externally-managed-environment" in done.stderr) == managed
