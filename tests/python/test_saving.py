# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that a full disk, a kill, a cancel or another writer leaves an old or a complete file."""

import os
import resource
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager

import leaflight
import numpy as np
import pytest
from leaflight import Cancelled, LeaflightError, Progress, _core, load_bake
from leaflight.bake.load_bake import open_bake, with_walls
from leaflight.export.export import SUFFIXES, export
from leaflight.io.images import write_png
from leaflight.io.output import replaced, replaced_together
from leaflight.export.ply import write_ply
from leaflight.progress_bar import run_with_progress
from outcomes import refused, written
from waiting import HANG, package_folder, run_python

NOISE = np.random.default_rng(3).random((64, 64, 3), np.float32)
BEFORE = b"what was there before"


@contextmanager
def files_of_at_most(count):
    """Limits the size of files, as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (count, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture
def small_disk(tmp_path):
    """Yields a file system of 64 KB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)]
    if os.geteuid() or subprocess.run(command, capture_output=True).returncode:
        pytest.skip("only root can make a small disk")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


# mesh.ply is a .ply. Blender writes a .blend, under another name first.
WRITTEN_HERE = [suffix for suffix in SUFFIXES if suffix not in (".ply", ".blend")]


def writers(bake):
    surface = bake.surface(47.0)
    pixels = (255 * NOISE).astype(np.uint8)
    return {
        "x.vdb": bake.save,
        "x.exr": lambda path: _core.write_exr(path, NOISE),
        "x.png": lambda path: write_png(path, pixels),
        "mesh.ply": lambda path: write_ply(path, surface, 1.0),
        **{f"x{suffix}": exporter(bake, suffix) for suffix in WRITTEN_HERE},
    }


def exporter(bake, suffix):
    isovalues = None if suffix in (".vti", ".am") else [47.0]
    return lambda path: export(bake, path, isovalues)


KINDS = ["x.vdb", "x.exr", "x.png", "mesh.ply"]
KINDS += [f"x{suffix}" for suffix in WRITTEN_HERE]


@pytest.mark.parametrize("name", KINDS)
def test_a_full_disk_leaves_the_file_before(box_bake, tmp_path, name):
    module = dict.fromkeys(("x.vti", "x.vtp"), "vtkmodules")
    module |= dict.fromkeys(("x.usd", "x.usda", "x.usdc"), "pxr")
    pytest.importorskip(module.get(name, "numpy"))
    path = tmp_path / name
    write = writers(box_bake)[name]
    write(path)
    whole, files = path.stat().st_size, os.listdir(tmp_path)
    path.write_bytes(BEFORE)
    # Half a file is never mistaken for a complete one, even if only its last bytes are missing.
    for share in (0.1, 0.6, 0.999):
        with files_of_at_most(int(share * whole)):
            said = refused(".", write, path)
        assert str(path) in said and "\n" not in said
        assert path.read_bytes() == BEFORE
        assert sorted(os.listdir(tmp_path)) == sorted(files)


def test_a_disk_that_is_full(box_bake, small_disk):
    path = written(small_disk / "x.vdb", BEFORE)
    refused("No space left", box_bake.save, path)
    refused("No space left", _core.write_exr, small_disk / "x.exr", np.tile(NOISE, (4, 4, 1)))
    assert path.read_bytes() == BEFORE
    assert os.listdir(small_disk) == ["x.vdb"]


def test_flatland_keeps_both_files_where_one_fails(cli, tmp_path):
    """Checks that both files stay: the picture does not fit on the disk, but the texture does."""
    for name in ("x.exr", "x.png"):
        (tmp_path / name).write_bytes(BEFORE)
    arguments = ["flatland", "bump_box", "--dims", "9", "--error", "50", "--resolution", "9"]
    with files_of_at_most(3000):
        outcome = cli(*arguments, "--out", tmp_path / "x.exr")
    assert outcome.status == 2 and "x.png" in outcome.err
    assert [path.read_bytes() for path in sorted(tmp_path.iterdir())] == [BEFORE, BEFORE]
    assert cli(*arguments, "--out", tmp_path / "x.exr").status == 0
    assert (tmp_path / "x.exr").stat().st_size < 3000 < (tmp_path / "x.png").stat().st_size


def test_a_saved_bake_ends_with_its_checksum(box_file, tmp_path):
    """Checks that every changed bit is detected, and that another program's copy is still read."""
    whole = box_file.read_bytes()
    path = tmp_path / "x.vdb"
    rng = np.random.default_rng(5)
    for place in rng.integers(0, len(whole), 20):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)
        try:
            load_bake(path)
            assert place >= len(whole) - 24, "only the mark itself may change"
        except LeaflightError as error:
            assert str(path) in str(error)
    path.write_bytes(whole[:-24])
    assert not _core.has_seal(path)
    np.testing.assert_array_equal(load_bake(path).volume.values, load_bake(box_file).volume.values)


def test_two_writers_of_one_file(box_bake, small, tmp_path):
    """Checks that the last save wins completely, and that no other file remains."""
    path = tmp_path / "x.vdb"
    other = leaflight.bake(leaflight.bump_box(12), **small)
    bakes = [box_bake, other] * 4
    threads = [threading.Thread(target=bake.save, args=(path,)) for bake in bakes]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert load_bake(path).id in (box_bake.id, other.id)
    assert os.listdir(tmp_path) == ["x.vdb"]


def test_what_a_killed_process_left_is_removed(tmp_path):
    script = "import sys; from leaflight.io.output import replaced\n"
    script += "with replaced(sys.argv[1]) as file: file.write_text('half'); print(1, flush=True);"
    # Wait until it is killed.
    script += " sys.stdin.read()"
    child = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path / "a.txt")],
        env={**os.environ, "PYTHONPATH": str(package_folder())},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    child.stdout.readline()
    with replaced(tmp_path / "b.txt") as file:
        file.write_text("whole")
    assert len(list(tmp_path.glob(".leaflight-*"))) == 1, "the child is alive"
    child.kill()
    child.communicate()
    with replaced(tmp_path / "b.txt") as file:
        file.write_text("whole")
    assert os.listdir(tmp_path) == ["b.txt"]


def test_several_files_change_together(tmp_path):
    paths = [tmp_path / name for name in ("a", "b")]
    for path in paths:
        path.write_bytes(BEFORE)
    with pytest.raises(LeaflightError, match="b"), replaced_together(*paths) as (one, _two):
        one.write_bytes(b"new")
    assert [path.read_bytes() for path in paths] == [BEFORE, BEFORE]
    assert len(os.listdir(tmp_path)) == 2


def test_a_cancelled_save_writes_nothing(box_bake, tmp_path):
    progress = Progress()
    progress.cancel()
    with pytest.raises(Cancelled):
        box_bake.save(tmp_path / "x.vdb", progress)
    assert os.listdir(tmp_path) == []


def test_reading_can_be_cancelled_and_has_a_share(lapr_file):
    """Checks progress near 1 twice: after the direct light of isosurfaces, and of walls."""
    cancelled, progress = Progress(), Progress()
    cancelled.cancel()
    with pytest.raises(Cancelled):
        open_bake(lapr_file, cancelled)
    bake, walls = open_bake(lapr_file, progress)
    assert 0.9 < progress.fraction < 1.0
    with pytest.raises(Cancelled):
        with_walls(bake, walls, cancelled)
    assert with_walls(bake, walls, progress).walls is not None and 0.9 < progress.fraction < 1.0


def test_a_cancel_that_comes_too_late():
    """Checks that a file which is already complete is reported."""

    def work(progress):
        progress.cancel()
        return "written"

    before = signal.getsignal(signal.SIGINT)
    assert run_with_progress(work, "test", writes=True) == "written"
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    signal.signal(signal.SIGINT, before)
    with pytest.raises(Cancelled):
        run_with_progress(work, "test")


# Program that interrupts itself before, or after, a bake is saved.
INTERRUPTED = """
import os, signal, sys, time
from leaflight import Bake
from leaflight_command import program

save, when = Bake.save, sys.argv.pop()

def interrupted(bake, path, progress):
    if when == "after":
        save(bake, path, progress)
    os.kill(os.getpid(), signal.SIGINT)
    while not progress.cancelled:
        time.sleep(0.01)
    if when == "before":
        save(bake, path, progress)

Bake.save = interrupted
program()
"""


@pytest.mark.parametrize("when", ["before", "after"])
def test_ctrl_c_beside_saving(tmp_path, when):
    path = tmp_path / "x.vdb"
    arguments = ["bake", "bump_box", "--dims", "8", "--error", "50"]
    done = run_python(
        *("-c", INTERRUPTED, *arguments, "--out", path, when),
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert done.returncode == (130 if when == "before" else 0)
    assert ("nothing written" in done.stderr) == (when == "before")
    assert "Traceback" not in done.stderr
    assert os.listdir(tmp_path) == ([] if when == "before" else ["x.vdb"])
    if when == "after":
        load_bake(path)


@pytest.mark.slow
def test_ctrl_c_while_saving(root, tmp_path):
    """Checks that the program reports the result of an interruption at any moment."""
    command = [root / "scripts" / "leaflight", "bake", "bump_box", "--dims", "64", "--error"]
    for delay in (0.0, 0.01, 0.03, 0.1):
        path = tmp_path / f"{delay}.vdb"
        process = subprocess.Popen(
            [*command, "50", "--out", path],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )
        while process.poll() is None and not list(tmp_path.glob(".leaflight-part-*")):
            pass
        threading.Event().wait(delay)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=HANG)
        assert (process.returncode, path.exists()) in ((130, False), (0, True)), err
        assert ("nothing written" in err) is not path.exists()
        assert "Traceback" not in err and not list(tmp_path.glob(".leaflight-part-*"))
        if path.exists():
            load_bake(path)
