# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs each file of checks of inside/ in a Blender of its own, with pytest as it is out here."""

import zipfile
from pathlib import Path

import pytest

INSIDE = Path(__file__).resolve().parent / "inside"
CHECKS = sorted(path.name for path in INSIDE.glob("check_*.py"))


@pytest.mark.parametrize("checks", CHECKS)
def test_in_blender(blender, results, checks):
    file = results / checks.replace(".py", ".json")
    output = blender.check(INSIDE / checks, file, timeout=900)
    print(output)
    assert "passed" in output and file.exists()


def test_zip_holds_the_addon_with_its_core(legacy_zip):
    names = zipfile.ZipFile(legacy_zip).namelist()
    assert "leaflight_addon/__init__.py" in names
    assert "modules/leaflight/__init__.py" in names
    assert "modules/leaflight/io/readers/nifti.py" in names
    assert "modules/leaflight/scenes/cornell.json" in names
    assert any(name.startswith("modules/leaflight/_core.") for name in names)
    assert not any("__pycache__" in name for name in names)
    assert len(names) == len(set(names))
