# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks files on Windows: names, replacement of open files, reading in other processes.

test_files.py runs this in Windows' Python.
"""

import sys
import threading

import leaflight
import numpy as np
import pytest
from leaflight import _core
from leaflight.io import process_limits

assert sys.platform == "win32"


@pytest.fixture(scope="module")
def bake():
    return leaflight.bake(leaflight.bump_box(12), error=20.0)


def check_names_may_have_any_letters_and_backslashes(bake, tmp_path):
    folder = tmp_path / "Gehirn für 体積 №1"
    folder.mkdir()
    path = f"{folder}\\häßlich 体.vdb"
    bake.save(path)
    assert leaflight.load_bake(path).grid.texels == bake.grid.texels
    assert [entry.name for entry in folder.iterdir()] == ["häßlich 体.vdb"]
    with pytest.raises(leaflight.LeaflightError, match="体積 №1.*häßlich"):
        leaflight.load_bake(path + ".gone")


def check_a_file_that_is_open_is_kept_and_named(bake, tmp_path):
    path = tmp_path / "bake.vdb"
    path.write_bytes(b"old")
    with path.open("rb"):
        with pytest.raises(leaflight.LeaflightError, match="bake.vdb' cannot be written"):
            bake.save(path)
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["bake.vdb"]


def check_a_file_that_is_open_for_a_moment_is_replaced(bake, tmp_path):
    path = tmp_path / "bake.vdb"
    path.write_bytes(b"old")
    file = path.open("rb")
    threading.Timer(0.3, file.close).start()
    bake.save(path)
    assert leaflight.load_bake(path).grid.texels == bake.grid.texels
    assert [entry.name for entry in tmp_path.iterdir()] == ["bake.vdb"]


def check_paths_may_be_longer_than_260_characters(bake, tmp_path):
    folder = tmp_path.joinpath(*[str(digit) * 100 for digit in range(4)])
    folder.mkdir(parents=True)
    path = folder / "bake.vdb"
    for _ in range(2):
        bake.save(path)
    assert leaflight.load_bake(path).grid.texels == bake.grid.texels
    assert min(leaflight.read_volume(path, grid="radiance_error").field().dims) > 1
    assert [entry.name for entry in folder.iterdir()] == ["bake.vdb"]
    _check_large_arrays(folder / "arrays")


def check_what_a_killed_run_left_is_removed(bake, tmp_path):
    killed = tmp_path / ".leaflight-part-0123456789abcdef"
    killed.mkdir()
    (killed / "output.vdb").write_bytes(b"incomplete")
    bake.save(tmp_path / "bake.vdb")
    assert [entry.name for entry in tmp_path.iterdir()] == ["bake.vdb"]


def check_pictures_may_have_such_names(tmp_path):
    image = np.zeros((2, 3, 3), np.float32)
    path = tmp_path / "体.exr"
    _core.write_exr(str(path), image)
    np.testing.assert_array_equal(_core.read_exr(str(path)), image)


def check_a_process_reads_vdb_files(bake, tmp_path):
    path = tmp_path / "体.vdb"
    bake.save(path)
    volume = leaflight.read_volume(path, grid="radiance_error")
    assert min(volume.field().dims) > 1
    damaged = tmp_path / "damaged.vdb"
    damaged.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(leaflight.LeaflightError, match="damaged.vdb"):
        leaflight.read_volume(damaged)


def check_a_process_can_limit_itself():
    process_limits.limit_process(10_000)


def check_large_arrays_lie_in_a_file_that_vanishes(tmp_path):
    _check_large_arrays(tmp_path / "体")


def _check_large_arrays(folder):
    folder.mkdir()
    _core.limit_large_memory(1 << 20, str(folder))
    try:
        array = _core.large_array((4, 512, 1024), np.dtype(np.float32))
        assert _core.large_memory()[1] >= array.nbytes
        array[:] = 7
        assert array.sum() == 7 * array.size
        del array
    finally:
        _core.limit_large_memory(0, str(folder))
    assert _core.large_memory()[1] == 0 and not list(folder.iterdir())
