# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that a resumed bake has the bits of an uninterrupted one, wherever it was interrupted."""

import os
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import replace

import leaflight
import numpy as np
import pytest
from cone import cone
from leaflight import Cancelled, Checkpoint, LeaflightError, Progress, load_bake
from leaflight.bake.checkpoint import checkpoint_for, read_recipe
from leaflight.volume import regions
from outcomes import refused
from same_bytes import assert_same_light
from waiting import started, wait_for

ERROR = 0.3


# The kind of a part that is a block, its first byte (core/src/bake/plan/workers.h).
BLOCK = 5


class Canceller:
    """Workers that return no part, so that the bake computes all itself, and cancel one block."""

    def __init__(self, progress, blocks):
        self.progress, self.blocks = progress, blocks
        self.parts = []

    def tracing(self, *_):
        return nullcontext(self)

    def send(self, *_):
        pass

    def announce(self, parts):
        self.parts += parts
        return len(self.parts) - len(parts)

    def take(self, number):
        if self.parts[number][0] == BLOCK:
            if self.blocks == 0:
                self.progress.cancel()
            self.blocks -= 1
        return b""

    def drop(self, *_):
        pass


def interrupted(arguments, checkpoint, blocks):
    """Bakes this many blocks and a part of the next one, then drops the bake."""
    progress = Progress()
    workers = Canceller(progress, blocks)
    with pytest.raises(Cancelled):
        leaflight.bake(**arguments, checkpoint=checkpoint, progress=progress, workers=workers)


# Treat the warning about a checkpoint that cannot be written as an error.
@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize(
    "options, counts", [({}, ((1, 1), (2, 3))), ({"both_sides": True}, ((1, 3),))], ids=str
)
def test_the_same_bits(tmp_path, bump_scene, options, counts):
    volume = cone(16, is_open="both_sides" in options)
    arguments = {"volumes": volume, "scene": bump_scene, "isovalues": (30.0, 70.0)}
    arguments.update(options, error=ERROR)
    whole = leaflight.bake(**arguments)
    assert whole.statistics.passes > 1
    for first, second in counts:
        checkpoint = Checkpoint(tmp_path / f"{first}.checkpoint", {"of": first}, seconds=0.0)
        interrupted(arguments, checkpoint, first)
        # Resume twice, the last time with another number of threads.
        again = replace(checkpoint, resume=True)
        interrupted(arguments, again, second)
        assert read_recipe(again.path) == {"of": first}
        assert_same_light(leaflight.bake(**arguments, checkpoint=again, threads=1), whole)


@pytest.mark.parametrize("kind", ["capped", "open"])
def test_a_bake_of_a_cut_is_resumed(tmp_path, bump_scene, kind):
    halved = regions.changed(cone(16), [regions.HalfSpace((0.5, 0.5, 0.5), (0.3, -0.5, 1.0), kind)])
    arguments = {"volumes": halved, "scene": bump_scene, "isovalues": (30.0, 70.0), "error": ERROR}
    checkpoint = Checkpoint(tmp_path / "x.checkpoint", seconds=0.0)
    interrupted(arguments, checkpoint, 2)
    again = leaflight.bake(**arguments, checkpoint=replace(checkpoint, resume=True))
    assert_same_light(again, leaflight.bake(**arguments))


def test_a_continued_bake_is_resumed(tmp_path, bump_scene):
    kept = leaflight.bake(cone(16), bump_scene, isovalues=(30.0, 70.0), error=12.0)
    whole = leaflight.refine(kept, error=0.3)
    checkpoint = Checkpoint(tmp_path / "x.checkpoint", seconds=0.0)
    first = leaflight.refine(kept, error=0.3, checkpoint=checkpoint)
    again = leaflight.refine(kept, error=0.3, checkpoint=replace(checkpoint, resume=True))
    assert_same_light(first, whole)
    assert_same_light(again, whole)


def test_only_its_own_bake_goes_on(tmp_path, bump_scene):
    checkpoint = Checkpoint(tmp_path / "x.checkpoint", seconds=0.0)
    arguments = {"scene": bump_scene, "isovalues": (30.0, 70.0), "error": 12.0}
    leaflight.bake(leaflight.bump_box(6), checkpoint=checkpoint, **arguments)
    again = replace(checkpoint, resume=True)
    for changed in ({"error": 11.0}, {"seed": 1}, {"isovalues": (30.0, 71.0)}):
        others = {**arguments, **changed, "checkpoint": again}
        refused("another bake", leaflight.bake, leaflight.bump_box(6), **others)
    refused("another bake", leaflight.bake, leaflight.bump_box(7), checkpoint=again, **arguments)
    whole = checkpoint.path.read_bytes()
    for damaged in (whole[:-1], whole[:100], b"", whole[:200] + b"x" + whole[201:]):
        checkpoint.path.write_bytes(damaged)
        refused("checkpoint", leaflight.bake, leaflight.bump_box(6), checkpoint=again, **arguments)


def test_a_checkpoint_that_cannot_be_written_does_not_end_the_bake(tmp_path, bump_scene):
    checkpoint = Checkpoint(tmp_path / "gone" / "x.checkpoint", seconds=0.0)
    settings = {"isovalues": (30.0, 70.0), "error": 9.0, "checkpoint": checkpoint}
    with pytest.warns(RuntimeWarning, match="not exist"):
        bake = leaflight.bake(leaflight.bump_box(6), bump_scene, **settings)
    assert bake.statistics.stopped is False


def test_killed_and_resumed_by_the_command_line(tmp_path, cli):
    out, other = tmp_path / "x.vdb", tmp_path / "whole.vdb"
    # Use a relative path, and save a checkpoint after each block instead of each half minute.
    script = "import sys, threading; from leaflight.bake import checkpoint as c; c.SECONDS = 0.0\n"
    script += "from leaflight import Bake; Bake.save = lambda *_: threading.Event().wait()\n"
    script += "from leaflight_command import main; sys.exit(main(sys.argv[1:]))"
    np.save(tmp_path / "box.npy", leaflight.bump_box(16).values)
    bake = ["bake", "box.npy", "--isovalues", "30", "70", "--error", "0.7", "--out"]
    run = [sys.executable, "-c", script, *bake, "x.vdb"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with started(run, cwd=tmp_path, env=environment, stderr=subprocess.DEVNULL) as process:
        assert wait_for(checkpoint_for(out).exists, lambda: process.poll() is None)
    assert checkpoint_for(out).exists() and not out.exists()
    cli.refuses("leave out --seed", "bake", "--resume", out, "--seed", "3")
    cli.runs("bake", "--resume", out)
    assert not list(tmp_path.glob("*checkpoint")) and not list(tmp_path.glob(".leaflight-*"))
    cli.runs(*bake[:1], tmp_path / "box.npy", *bake[2:], other)
    assert_same_light(load_bake(out), load_bake(other))
    cli.refuses("is complete", "bake", "--resume", out)


def test_a_bake_that_failed_says_that_it_can_go_on(tmp_path, cli, monkeypatch):
    out = tmp_path / "x.vdb"
    monkeypatch.setattr(sys.modules["leaflight.bake.checkpoint"], "SECONDS", 0.0)

    def full(*_):
        raise LeaflightError("There is no space left on the disk; make some.")

    with monkeypatch.context() as without_space:
        without_space.setattr(leaflight.Bake, "save", full)
        outcome = cli("bake", "bump_box", "--dims", "6", "--error", "5", "--out", out)
    assert outcome.status == 2
    assert f"make some; afterwards, leaflight bake --resume {out} continues it.\n" in outcome.err
    assert cli("bake", "--resume", out).status == 0
    assert load_bake(out) and os.listdir(tmp_path) == ["x.vdb"]
