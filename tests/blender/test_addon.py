# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs each file of inside/ in a separate Blender, with this Python's pytest."""

import json
import zipfile
from pathlib import Path

import pytest

INSIDE = Path(__file__).resolve().parent / "inside"
FILES = sorted(INSIDE.glob("check_*.py"))
# The files of the short suite. They cover all steps from import to lit isovalues, and the parts
# that differ between versions of Blender.
SHORT = {
    *("check_import.py", "check_stage.py", "check_meshes.py", "check_lights.py"),
    *("check_materials.py", "check_bake.py", "check_shader.py", "check_scrub.py"),
    "check_walls.py",
}
CHECKS = [
    pytest.param(path.name, marks=() if path.name in SHORT else pytest.mark.slow) for path in FILES
]
assert {path.name for path in FILES} > SHORT

# Program that prints processor seconds of importing NumPy, and of enabling the add-on after the
# package.
ENABLE = """
import addon_utils, bpy, json, resource, sys
# --factory-startup excludes this folder.
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
    file.unlink(missing_ok=True)
    output = blender.check(file, INSIDE / checks)
    print(output)
    outcomes = {result["outcome"] for result in json.loads(file.read_text()).values()}
    if blender.about["windows"] and outcomes == {"skipped"}:
        pytest.skip("none of its checks can run by Wine")
    assert "passed" in output


# Program that disables and enables an extension, as in the preferences.
OFF_AND_ON = """
import bpy
for switch in (bpy.ops.preferences.addon_disable, bpy.ops.preferences.addon_enable):
    switch(module="bl_ext.user_default.leaflight")
import leaflight
print("VERSION", leaflight.__version__)
"""
STARTED = """
import bpy
print("STARTED", hasattr(bpy.types.Object, "leaflight"))
"""


@pytest.mark.slow
def test_starts_after_it_was_off_and_on(blender):
    """Checks Blender for Windows, which removes a module in use at its next start, even if it was
    reinstalled. The following start installs it again.
    """
    if not blender.extends:
        pytest.skip("the legacy add-on has its package in a folder of modules")
    assert "VERSION " in blender.run("--python-expr", OFF_AND_ON)
    first = blender.run("--python-expr", STARTED)
    if blender.about["windows"] and "STARTED False" in first:
        assert "Blender removed the package leaflight; restart Blender to install it." in first
        first = blender.run("--python-expr", STARTED)
    assert "STARTED True" in first


@pytest.mark.machine
def test_seconds_in_blender(blender, tmp_path):
    """Runs the checks that measure time or memory."""
    file = tmp_path / "results.json"
    output = blender.check(file, *FILES, "-m", "machine", LEAFLIGHT_MACHINE="1")
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


def enable(blender):
    """Returns (seconds of NumPy, seconds of the add-on, loaded modules)."""
    if blender.extends:
        pytest.skip("as an extension it is named by its repository")
    output = blender.run("--factory-startup", "--python-expr", ENABLE)
    line = next(line for line in output.splitlines() if line.startswith("TOOK "))
    return json.loads(line.removeprefix("TOOK "))


def test_the_addon_loads_no_readers_when_it_is_enabled(blender):
    loaded = set(enable(blender)[2])
    absent = {"nibabel", "tifffile", "pydicom", "mrcfile", "h5py", "zarr"}
    assert not loaded & (absent | {"PIL", "matplotlib", "scipy", "meshio"})


@pytest.mark.machine
def test_the_addon_is_enabled_at_once(blender):
    """Compares the add-on's own 0.15 s with NumPy's import, 0.08 s, to cancel out other work.

    The core's module, with 0.45 s for OpenVDB, is not counted.
    """
    runs = [enable(blender) for _ in range(3)]
    assert min(enabled for _, enabled, _ in runs) < 3 * min(numpy for numpy, _, _ in runs)
