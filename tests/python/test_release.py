# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the program that prepares a release, without its packages."""

import importlib.machinery
import importlib.util
import json
import re
import subprocess
from pathlib import Path

import pytest
import tomllib
import yaml
from leaflight.version import __version__

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "scripts" / "release"


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
        assert __version__ in (tmp_path / name).read_text().replace(", ", ".")
    monkeypatch.setattr(release, "ROOT", tmp_path)
    release.set_version("9.8.7")
    for name, *_ in release.PLACES:
        assert "9.8.7" in (tmp_path / name).read_text().replace(", ", ".")
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


def test_checks_name_their_files(release):
    commands = {name: release.filled(command, "F", "W") for name, command in release.CHECKS}
    assert "twine check --strict F" in commands["long description"]
    assert commands["contents of the wheels"].endswith(" W")
    assert all("{files}" not in one and "{wheels}" not in one for one in commands.values())
    assert all(one.count("'") % 2 == 0 for one in commands.values())


def test_places_of_publication_agree():
    """Compares what Zenodo, conda and the paper say with pyproject.toml and CITATION.cff."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    zenodo = json.loads((ROOT / ".zenodo.json").read_text())
    for key in ("title", "version", "license", "keywords"):
        assert zenodo[key] == citation[key], key
    recipe = yaml.safe_load((ROOT / "packaging/conda/recipe.yaml").read_text())
    needs = recipe["requirements"]
    built_with = [text.replace(">=", " >=") for text in project["build-system"]["requires"]]
    assert set(built_with) <= set(needs["host"])
    used = [text.replace(">=", " >=") for text in project["project"]["dependencies"]]
    assert {"python", *used} == set(needs["run"])
    assert recipe["about"]["license"] == project["project"]["license"] == citation["license"]
    assert recipe["about"]["homepage"] == project["project"]["urls"]["Homepage"]


def test_the_paper_has_what_its_journal_asks_for():
    text = (ROOT / "paper/paper.md").read_text()
    _, head, body = text.split("---\n", 2)
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} <= set(
        yaml.safe_load(head)
    )
    for heading in ("Summary", "Statement of need", "Limits", "References"):
        assert f"\n# {heading}\n" in body
    known = re.findall(r"@\w+\{(\w+),", (ROOT / "paper/paper.bib").read_text())
    assert set(re.findall(r"@(\w+)", body)) == set(known)
    assert 250 < len(body.split()) < 1000


@pytest.mark.parametrize("version", ["1.0", __version__])
def test_a_wrong_version_changes_nothing(version):
    done = subprocess.run([PROGRAM, version], capture_output=True, text=True)
    assert done.returncode == 2
    assert version in done.stderr
