# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests lists of bakes, each baked by one worker, and resumed after an interruption."""

import csv
import os
import signal
import subprocess
import sys
from pathlib import Path

import leaflight
import nibabel
import numpy as np
import pytest
from leaflight import load_bake
from leaflight.cli import batch_command
from outcomes import written
from waiting import HANG, started, wait_for

pytest.importorskip("distributed")


@pytest.fixture
def scan(tmp_path):
    """Writes a NIfTI file with two frames."""
    z, y, x = np.mgrid[:12, :12, :12]
    frames = [np.sin(0.4 * x + t) + np.cos(0.5 * y) + 0.1 * z for t in range(2)]
    path = tmp_path / "scan.nii"
    nibabel.save(nibabel.Nifti1Image(np.stack(frames, -1).astype(np.float32), np.eye(4)), path)
    return path


def listed(tmp_path, *lines):
    return written(tmp_path / "bakes.txt", "# what to bake\n\n" + "\n".join(lines) + "\n")


@pytest.mark.slow
def test_frames_volumes_and_settings(cli, scan, tmp_path):
    lines = [f"{scan} --frame {t} --error 5 --out '{tmp_path}/frame {t}.vdb'" for t in range(2)]
    lines.append(f"bump_box --dims 10 --error 5 --out {tmp_path}/box.vdb  # generated")
    path = listed(tmp_path, *lines)
    assert "3 baked, 0 already complete" in cli.runs("batch", path, "--workers", "2")
    alone = tmp_path / "alone.vdb"
    cli.runs("bake", scan, "--frame", 1, "--error", 5, "--out", alone)
    found = [load_bake(one).grid.dense("radiance") for one in (alone, tmp_path / "frame 1.vdb")]
    np.testing.assert_array_equal(*found)
    # A second run has nothing to do. It bakes files that are missing, damaged or have other
    # settings.
    assert "0 baked, 3 already complete" in cli("batch", path).out
    (tmp_path / "frame 0.vdb").unlink()
    whole = (tmp_path / "box.vdb").read_bytes()
    (tmp_path / "box.vdb").write_bytes(whole[:-100])
    path = listed(tmp_path, lines[0], lines[1].replace("--error 5", "--error 4"), lines[2])
    assert "3 baked" in cli("batch", path).out
    assert (tmp_path / "box.vdb").stat().st_size > len(whole) - 100


# Program that waits for its workers, however slow the machine is.
PROGRAM = f"""
import sys
from leaflight.cluster.workers import Workers
from leaflight_command import main
Workers.__init__.__defaults__ = (None, None, {HANG})
sys.exit(main(sys.argv[1:]))
"""


def test_the_end_of_a_batch_leaves_the_bakes_of_others(monkeypatch):
    def is_ended(ended, _threads, progress):
        batch_command.end_batch(ended)
        return progress.cancelled

    monkeypatch.setattr(batch_command, "_bake_line", is_ended)
    assert batch_command.bake_line("mine", "mine", 1)
    assert not batch_command.bake_line("mine", "another", 1)


@pytest.mark.slow
def test_a_batch_that_was_interrupted_goes_on(cli, tmp_path):
    """Checks that a resumed batch keeps the finished bake and bakes the rest."""
    lines = [f"bump_box --dims 10 --error 5 --out {tmp_path}/short.vdb"]
    # This bake would take days.
    long = f"bump_box --dims 200 --error 0.01 --out {tmp_path}/long.vdb"
    path = listed(tmp_path, *lines, long)
    with started(
        [sys.executable, "-c", PROGRAM, "batch", path, "--workers", "2"],
        env={**os.environ, "PYTHONPATH": str(Path(leaflight.__file__).parents[1])},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    ) as program:
        assert wait_for((tmp_path / "short.vdb").exists, lambda: program.poll() is None)
        written = (tmp_path / "short.vdb").stat().st_mtime_ns
        program.send_signal(signal.SIGINT)
        _, err = program.communicate(timeout=HANG)
    assert program.returncode == 130 and "run the same command to continue" in err
    assert not (tmp_path / "long.vdb").exists()
    path = listed(tmp_path, *lines, f"bump_box --dims 10 --error 3 --out {tmp_path}/long.vdb")
    assert "1 baked, 1 already complete" in cli("batch", path).out
    assert (tmp_path / "short.vdb").stat().st_mtime_ns == written


def test_what_fails_is_reported(cli, tmp_path):
    bad = written(tmp_path / "bad.nii", b"no volume")
    path = listed(
        tmp_path,
        f"{bad} --out {tmp_path}/bad.vdb",
        f"bump_box --dims 10 --error 5 --out {tmp_path}/box.vdb",
    )
    done = cli("batch", path)
    assert done.status == 2 and "1 of 2 bakes failed" in done.err and "line 3" in done.err
    assert (tmp_path / "box.vdb").exists()


def test_a_folder_makes_a_table_and_one_damaged_file_stops_nothing(cli, scan, tmp_path):
    scans, out, table = tmp_path / "scans", tmp_path / "bakes", tmp_path / "results.csv"
    scans.mkdir()
    out.mkdir()
    np.save(scans / "wave.npy", np.float32(np.sin(0.5 * np.mgrid[:9, :10, :11].sum(axis=0))))
    written(scans / "cut.nii", scan.read_bytes()[:5000])
    written(scans / "notes.md", "no volume")
    command = ("batch", scans, "--out", out, "--each", "--error 20 --seed 3", "--table", table)
    done = cli(*command)
    assert done.status == 2 and "1 of 2 bakes failed, the first of them on cut.nii" in done.err
    with table.open(newline="") as file:
        cut, wave = csv.DictReader(file)
    assert cut["file"] == str(scans / "cut.nii") and cut["output"] == cut["texels"] == ""
    assert cut["failure"] in done.err
    bake = load_bake(out / "wave.vdb")
    assert wave["nodes"] == "11 x 10 x 9" and wave["output"] == str(out / "wave.vdb")
    assert int(wave["texels"]) == bake.statistics.texels and wave["failure"] == ""
    assert float(wave["seconds"]) == pytest.approx(bake.statistics.seconds)
    error = bake.statistics.estimated_error_percent
    assert float(wave["estimated_error_percent"]) == pytest.approx(error)
    # The same command without that file keeps the other bake and its row.
    (scans / "cut.nii").unlink()
    first = table.read_text().splitlines()[-1]
    assert "0 baked, 1 already complete" in cli(*command).out
    assert table.read_text().splitlines()[1:] == [first]


def test_a_folder_needs_another_one_for_its_bakes(cli, tmp_path):
    for options in ((), ("--out", tmp_path), ("--out", tmp_path / "none")):
        cli.refuses("another folder", "batch", tmp_path, *options)
    (tmp_path / "out").mkdir()
    cli.refuses("no volumes", "batch", tmp_path / "out", "--out", tmp_path)
    for options in (("--out", tmp_path / "out"), ("--each", "--error 2")):
        cli.refuses("for a folder", "batch", listed(tmp_path, "bump_box --out a.vdb"), *options)


@pytest.mark.parametrize(
    "line, words",
    [
        ("bump_box", "line 3:"),
        ("bump_box --out a.vdb --workers 3", "--out"),
        ("bump_box --out 'a.vdb", "quotation"),
        ("bump_box --out a.vdb\nhydrogen --out a.vdb", "another bake also writes"),
        ("", "lists no bakes"),
    ],
)
def test_lists_that_make_no_sense(cli, tmp_path, monkeypatch, line, words):
    monkeypatch.chdir(tmp_path)
    cli.refuses(words, "batch", listed(tmp_path, line))
    cli.refuses("none.txt", "batch", tmp_path / "none.txt")


@pytest.mark.parametrize(
    "command", ["batch bakes.txt", "render x.blend --out frames", "bake bump_box --out x.vdb"]
)
def test_workers_are_of_one_kind(cli, command):
    options = ("--workers", "2", "--scheduler", "tcp://127.0.0.1:1")
    cli.refuses("--workers", *command.split(), *options)


def test_no_workers_are_none(cli, tmp_path):
    path = listed(tmp_path, f"bump_box --out {tmp_path}/x.vdb")
    cli.refuses("workers is 0", "batch", path, "--workers", "0")
