# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that the error about a missing package has the right command to install it."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from leaflight.io.readers import MissingPackage, missing_package


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
