# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the program that prepares a release, without its packages."""

import importlib.machinery
import importlib.util
import re
import subprocess
from pathlib import Path

import pytest
from leaflight.version import __version__

PROGRAM = Path(__file__).resolve().parents[2] / "scripts" / "release"


@pytest.fixture(scope="module")
def release():
    loader = importlib.machinery.SourceFileLoader("release", str(PROGRAM))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("release", loader))
    loader.exec_module(module)
    return module


def test_each_file_gets_the_version(release, tmp_path, monkeypatch):
    for name, *_ in release.PLACES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text((release.ROOT / name).read_text())
        assert __version__ in (tmp_path / name).read_text()
    monkeypatch.setattr(release, "ROOT", tmp_path)
    release.set_version("9.8.7")
    for name, *_ in release.PLACES:
        assert "9.8.7" in (tmp_path / name).read_text()
    changes = (tmp_path / "CHANGELOG.md").read_text()
    assert re.search(r"\[Unreleased\]\n\n## \[9\.8\.7\] - \d{4}-\d\d-\d\d\n", changes)


def test_one_option_sets_the_address_everywhere(release, tmp_path, monkeypatch):
    for name in release.SITES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text((release.ROOT / name).read_text())
    monkeypatch.setattr(release, "ROOT", tmp_path)
    old = release.site()
    release.set_site("https://code.example.net/leaflight")
    texts = [(tmp_path / name).read_text() for name in release.SITES]
    assert not any(old in text for text in texts)
    assert all("https://code.example.net/leaflight" in text for text in texts)
    assert "https://code.example.net/leaflight/raw/main/" in texts[0]


@pytest.mark.parametrize("version", ["1.0", __version__])
def test_a_wrong_version_changes_nothing(version):
    done = subprocess.run([PROGRAM, version], capture_output=True, text=True)
    assert done.returncode == 2
    assert version in done.stderr
