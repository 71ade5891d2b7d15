# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that Windows' and Debian's Python bake the same bits, and read each other's files."""

import os
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
DATA = Path(os.environ.get("LEAFLIGHT_DATA", HERE.parents[2] / "shared" / "data"))


def arrays(path):
    with np.load(path) as stored:
        return {name: stored[name] for name in stored.files}


def assert_alike(found, expected):
    assert sorted(found) == sorted(expected)
    for name, array in expected.items():
        assert found[name].shape == array.shape and found[name].dtype == array.dtype, name
        np.testing.assert_array_equal(found[name], array, err_msg=name)


def test_the_bump_box(windows, numpy_version, linux, root, tmp_path):
    script = root / "tests" / "package" / "bake_arrays.py"
    scene = root / "scenes" / "bump_box.json"
    shown = windows(script, scene, tmp_path / "windows.npz")
    assert shown.startswith(f"{numpy_version} Z:")
    linux(script, scene, tmp_path / "linux.npz")
    assert_alike(arrays(tmp_path / "windows.npz"), arrays(tmp_path / "linux.npz"))


@pytest.fixture(scope="module")
def nucleon(windows, linux, root, tmp_path_factory):
    """Returns the folder with bakes of nucleon.raw: windows.vdb and linux.vdb."""
    volume = DATA / "nucleon.raw"
    if not volume.exists():
        pytest.skip(f"{volume} is missing; name its folder by LEAFLIGHT_DATA")
    folder = tmp_path_factory.mktemp("nucleon")
    layout = ("--dims", "41", "41", "41", "--type", "uint8")
    scene = ("--scene", root / "scenes" / "studio.json", "--walls")
    for name, python in (("windows", windows), ("linux", linux)):
        python("-m", "leaflight", "bake", volume, *layout, *scene, "--out", folder / f"{name}.vdb")
    return folder


@pytest.mark.parametrize("reader", ["windows", "linux"])
def test_each_reads_the_bakes_of_both(nucleon, request, reader):
    found = {}
    for writer in ("windows", "linux"):
        out = nucleon / f"{writer}-read-by-{reader}.npz"
        request.getfixturevalue(reader)(HERE / "read_bake.py", nucleon / f"{writer}.vdb", out)
        found[writer] = arrays(out)
    assert found["linux"]["radiance"].max() > 0.1
    assert_alike(found["windows"], found["linux"])
