# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs each file of checks of inside/ in a Blender of its own, with pytest as it is out here."""

import json
import zipfile
from pathlib import Path

import pytest

INSIDE = Path(__file__).resolve().parent / "inside"
CHECKS = sorted(path.name for path in INSIDE.glob("check_*.py"))

# Processor seconds of importing NumPy, and of enabling the add-on after it and the package.
ENABLE = """
import addon_utils, bpy, json, resource, sys
# Which --factory-startup leaves out.
sys.path.append(bpy.utils.user_resource("SCRIPTS", path="modules"))
def seconds():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime
start = seconds()
import numpy
numpys = seconds() - start
import leaflight
middle = seconds()
assert addon_utils.enable("leaflight_addon") is not None and "leaflight" in sys.modules
print("TOOK", json.dumps([numpys, seconds() - middle, sorted(sys.modules)]))
"""


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


def test_the_addon_is_enabled_at_once(blender):
    """What the add-on itself takes: 0.15 s, NumPy's import 0.08 s beside the same other work.

    Not counted is the module of the core: its own OpenVDB takes 0.45 s to load.
    """
    if blender.extends:
        pytest.skip("as an extension it is named by its repository")

    def took():
        output = blender.run("--factory-startup", "--python-expr", ENABLE, timeout=60)
        line = next(line for line in output.splitlines() if line.startswith("TOOK "))
        return json.loads(line.removeprefix("TOOK "))

    runs = [took() for _ in range(3)]
    loaded = set(runs[0][2])
    absent = {"nibabel", "tifffile", "pydicom", "mrcfile", "h5py", "zarr"}
    assert not loaded & (absent | {"PIL", "matplotlib", "scipy", "meshio"})
    assert min(enabled for _, enabled, _ in runs) < 3 * min(numpy for numpy, _, _ in runs)
