# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests volumes and light with limited memory: the same bits, or an error before any work."""

import gc
import json
import sys
from pathlib import Path

import leaflight
import numpy as np
import pytest
from leaflight import Volume, _core, bump_box
from leaflight.bake.bake import task_of
from leaflight.volume.memory import LEAST_LIMIT, limit_memory, new_voxels
from outcomes import refused
from waiting import run_python

MEBIBYTE = 1 << 20

# Program that bakes a volume and prints the peak of its anonymous memory.
_BAKE = """
import json, sys, threading, time
import leaflight

path, out, limit, settings = json.loads(sys.argv[1])
held, done = [0], False

def watch():
    while not done:
        with open("/proc/self/status") as status:
            lines = dict(line.split(":") for line in status)
        held[0] = max(held[0], int(lines["RssAnon"].split()[0]) << 10)
        time.sleep(0.005)

thread = threading.Thread(target=watch)
thread.start()
try:
    if limit:
        leaflight.limit_memory(limit, folder=out.rpartition("/")[0])
    begun = held[0]
    volume = leaflight.read_volume(path)
    bake = leaflight.bake(volume, error=50.0, **settings)
    bake.save(out)
    in_files = leaflight._core.large_memory()[1]
finally:
    done = True
    thread.join()
print(json.dumps({"held": held[0], "begun": begun, "in_files": in_files,
                  "resolution": list(bake.grid.resolution)}))
"""

needs_linux = pytest.mark.skipif(
    not Path("/proc/self/status").exists(), reason="only Linux reports what a process holds"
)


@pytest.fixture(autouse=True)
def unlimited():
    yield
    limit_memory(None)


def bake_in_subprocess(path, out, limit=0, **settings):
    arguments = json.dumps([str(path), str(out), limit, settings])
    ended = run_python("-c", _BAKE, arguments)
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    """Returns (folder, results of baking a volume above the limit with the limit, and without)."""
    n = 384
    x = np.linspace(-1, 1, n, dtype=np.float32)
    plane = np.cos(9 * x)[:, None] * np.sin(7 * x)
    folder = tmp_path_factory.mktemp("large")
    path = folder / "large.npy"
    values = np.lib.format.open_memmap(path, "w+", np.float32, (n, n, n))
    for k in range(n):
        values[k] = plane * np.cos(8 * x[k]) - x[k] ** 2
    del values
    assert path.stat().st_size > LEAST_LIMIT
    limited = bake_in_subprocess(path, folder / "limited.vdb", LEAST_LIMIT, resolution=20)
    return folder, limited, bake_in_subprocess(path, folder / "whole.vdb", resolution=20)


@pytest.mark.slow
@needs_linux
def test_volume_larger_than_the_limit_is_baked_with_the_same_bits(large):
    folder, limited, whole = large
    path = folder / "large.npy"
    values = np.load(path, mmap_mode="r")
    assert limited["in_files"] > values.nbytes and whole["in_files"] == 0
    # The files had no names, so the folder has no others.
    assert sorted(folder.iterdir()) == [path, folder / "limited.vdb", folder / "whole.vdb"]
    one, other = (leaflight.load_bake(folder / f"{name}.vdb") for name in ("limited", "whole"))
    assert np.array_equal(one.volumes[0].values, values)
    for name in ("radiance", "radiance_indirect", "radiance_error"):
        assert np.array_equal(one.grid.dense(name), other.grid.dense(name), equal_nan=True)


@pytest.mark.machine
@needs_linux
def test_a_limit_is_kept(large):
    _, limited, whole = large
    assert limited["held"] < LEAST_LIMIT
    assert whole["held"] > LEAST_LIMIT


@pytest.mark.machine
@needs_linux
@pytest.mark.parametrize(
    "settings",
    [
        {"resolution": 100},
        {"resolution": 100, "both_sides": True},
        {"resolution": 100, "walls": True},
        {"resolution": 160},
    ],
)
def test_memory_of_the_light_is_foreseen(tmp_path, settings):
    path = tmp_path / "box.npy"
    np.save(path, bump_box(100).values)
    found = bake_in_subprocess(path, tmp_path / "box.vdb", **settings)

    volume = leaflight.read_volume(path)
    task = task_of(volume, None, **settings)
    foreseen = _core.light_memory(task.core_scene(), task.settings)
    assert 0.6 < (found["held"] - found["begun"]) / foreseen < 1.15


@pytest.mark.slow
def test_default_texels_are_the_finest_that_fit(monkeypatch):
    volume = bump_box(120)
    limit_memory(320 * MEBIBYTE)
    bake = leaflight.bake(volume, error=50)
    assert 40 < bake.grid.resolution[0] < 120
    name, reason = bake.statistics.skipped_passes[-1]
    assert name == "finer texels" and "memory" in reason
    # The bake must record the chosen resolution like one given by the caller.
    assert list(bake.provenance.asked_resolution) == list(bake.grid.resolution)

    limit_memory(None)
    monkeypatch.setattr(_core, "machine_memory", lambda: 16 << 30)
    assert leaflight.bake(volume, error=50).grid.resolution[0] == 120


def test_small_machine_gets_coarser_texels(monkeypatch):
    monkeypatch.setattr(_core, "machine_memory", lambda: 500 * MEBIBYTE)
    bake = leaflight.bake(bump_box(120), error=50)
    assert 40 < bake.grid.resolution[0] < 120


def test_light_that_does_not_fit_is_refused_before_it_is_computed():
    limit_memory(LEAST_LIMIT)
    words = r"300 x 300 x 300 texels takes (about|over) .*without one it is [3-7][0-9]\)"
    refused(words, leaflight.bake, bump_box(100), resolution=300)


def test_limits_that_no_process_can_keep():
    refused("192 MiB", limit_memory, MEBIBYTE)


def test_arrays_beyond_the_limit_lie_in_files(tmp_path):
    limit_memory(LEAST_LIMIT, tmp_path)
    # Free the memory of earlier tests now, not during the measurement.
    gc.collect()
    in_memory, in_files = _core.large_memory()
    small = new_voxels((8, 1024, 1024), np.uint8)
    large = new_voxels((100, 1024, 1024), np.uint8)
    assert _core.large_memory() == (in_memory + small.nbytes, in_files + large.nbytes)
    large[...] = 7
    assert (large == 7).all()
    # On Windows, files in use keep their names.
    assert sys.platform == "win32" or not list(tmp_path.iterdir())
    del small, large
    assert _core.large_memory() == (in_memory, in_files)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limit")
def test_full_disk_is_a_sentence(tmp_path):
    import resource

    limit_memory(LEAST_LIMIT, tmp_path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (MEBIBYTE, before[1]))
    try:
        refused(f"{tmp_path.name}.*no room for .*100 MiB", new_voxels, (100, 1024, 1024), np.uint8)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


def test_capped_volumes_lie_in_files_too(tmp_path):
    values = np.random.default_rng(1).random((4, 5, 6), dtype=np.float32)
    whole = Volume(values, np.eye(4), "noise").capped()
    padded = np.pad(values, 1, constant_values=whole.values[0, 0, 0])
    assert np.array_equal(whole.values, padded)
