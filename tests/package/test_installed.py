# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that the wheel, in a new environment with NumPy 2, gives the results of the build tree."""

from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent

# These tests make environments with packages that pip downloads.
pytestmark = pytest.mark.slow


def test_it_bakes_what_the_build_tree_bakes(run, plain_environment, installed, root, tmp_path):
    scene = root / "scenes" / "bump_box.json"
    script = HERE / "bake_arrays.py"
    built = root / "build" / "release" / "python"
    tree = plain_environment(PYTHONPATH=str(built))
    of_tree = run("/usr/bin/python3", script, scene, tmp_path / "tree.npz", env=tree, cwd="/")
    of_wheel = run(installed, script, scene, tmp_path / "wheel.npz", env=plain_environment())
    # Check that both NumPys and both packages were used.
    assert of_tree.startswith("1.") and str(built) in of_tree
    assert of_wheel.startswith("2.") and "site-packages" in of_wheel
    with np.load(tmp_path / "tree.npz") as tree, np.load(tmp_path / "wheel.npz") as wheel:
        assert sorted(tree.files) == sorted(wheel.files) and len(tree.files) > 20
        assert any(name.startswith("read/radiance_back") for name in tree.files)
        for name in tree.files:
            assert tree[name].size and tree[name].dtype == wheel[name].dtype
            np.testing.assert_array_equal(tree[name], wheel[name], err_msg=name)


def test_the_command(run, plain_environment, installed):
    program = installed.parent / "leaflight"
    shown = run(program, "info", "bump_box", "--dims", "20", env=plain_environment())
    assert shown.startswith("bump_box: 20 x 20 x 20 voxels")


def test_the_sdist_builds(run, plain_environment, made, tmp_path):
    """Installs the sdist into a new environment, with the requirements that pip downloads."""
    run("/usr/bin/python3", "-m", "venv", tmp_path / "venv")
    python = tmp_path / "venv" / "bin" / "python"
    run(python, "-m", "pip", "install", "--quiet", made["sdist"], timeout=None)
    program = tmp_path / "venv" / "bin" / "leaflight"
    shown = run(program, "info", "bump_box", "--dims", "20", env=plain_environment())
    assert shown.startswith("bump_box: 20 x 20 x 20 voxels")
