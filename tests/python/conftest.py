# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of all tests: small volumes, one small bake, and two ways to call the command line."""

import importlib
import json
import math
import signal
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import leaflight
import numpy as np
import pytest
from cone import cone
from hypothesis import HealthCheck, settings
from leaflight import progress_bar
from leaflight.cluster.workers import Workers
from leaflight.io import reader_process
from leaflight.volume.particles import lapr
from leaflight_command import main
from waiting import HANG

# Use the same examples in every run, so that a failure is caused by the current change.
settings.register_profile(
    "repeatable",
    derandomize=True,
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("repeatable")

ROOT = Path(__file__).resolve().parents[2]
# Names of the scene files, except those of Flatland, which have another format.
SHIPPED = sorted(
    path.name for path in (ROOT / "scenes").glob("*.json") if "flatland" not in path.name
)
COLIN27 = Path("/usr/share/mricron/templates/ch2.nii.gz")

# Settings of bakes that take well below a second with at most 20^3 nodes, also for thesis.bake().
SMALL = {"error": 5.0, "isovalues": (30.0, 70.0)}
FIXED = {"samples": 4, "photons": 20_000, "isovalues": (30.0, 70.0)}


@dataclass
class Outcome:
    status: int
    out: str
    err: str


@pytest.fixture(scope="session", autouse=True)
def unhurried():
    """Removes limits of time, so that slow machines neither give up nor print progress."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(progress_bar, "PATIENCE_SECONDS", math.inf)
        patch.setattr(reader_process, "WAIT", HANG)
        # The last default is patience_seconds.
        patch.setattr(Workers.__init__, "__defaults__", (None, None, HANG))
        yield


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def colin27():
    if not COLIN27.exists():
        pytest.skip("the Debian package mricron-data is not installed")
    return COLIN27


@pytest.fixture(scope="session")
def thesis():
    """Returns the package validation/thesis, whose module only the build tree has."""
    if not Path(leaflight.__file__).is_relative_to(ROOT / "build" / "release"):
        pytest.skip("no package contains the methods of the thesis")
    return importlib.import_module("thesis")


@pytest.fixture
def small():
    return {**SMALL, "resolution": 20}


@pytest.fixture
def fixed_work():
    return dict(FIXED)


@pytest.fixture(scope="session")
def bump_scene():
    return leaflight.load_scene(ROOT / "scenes" / "bump_box.json")


@pytest.fixture(scope="session")
def box_bake(bump_scene):
    """Returns the bump box with 20^3 nodes and as many texels, baked in its scene."""
    return leaflight.bake(leaflight.bump_box(20), bump_scene, resolution=20, **SMALL)


@pytest.fixture(scope="session")
def box_file(box_bake, tmp_path_factory):
    path = tmp_path_factory.mktemp("bake") / "box.vdb"
    box_bake.save(path)
    return path


@pytest.fixture
def box(bump_scene):
    """Returns bake(**settings) of a small cone."""

    def bake(**settings):
        volume = cone(16, is_open=settings.get("both_sides", False))
        return leaflight.bake(volume, bump_scene, isovalues=(30.0, 70.0), **settings)

    return bake


@pytest.fixture(params=SHIPPED)
def shipped(request):
    """Returns each of the shipped scene files."""
    return leaflight.load_scene(ROOT / "scenes" / request.param)


@pytest.fixture(scope="session")
def lapr_scene():
    return leaflight.load_scene(ROOT / "scenes" / "lapr.json")


@pytest.fixture(scope="session")
def lapr_bake(lapr_scene):
    """Returns a bake of two volumes with both sides and walls. Light enters at the open border."""
    volumes = [replace(one, values=one.values[:, :, :20].copy()) for one in lapr(30)]
    return leaflight.bake(volumes, lapr_scene, error=5.0, both_sides=True, walls=True)


@pytest.fixture(scope="session")
def lapr_file(lapr_bake, tmp_path_factory):
    path = tmp_path_factory.mktemp("bake") / "lapr.vdb"
    lapr_bake.save(path)
    return path


class CommandLine:
    """Calls of the command line in this process: cli("info", "x.nii") -> Outcome."""

    def __init__(self, capsys):
        self.capsys = capsys

    def __call__(self, *arguments):
        # After a program has written its files it ignores Ctrl-C, but the tests continue.
        before = signal.getsignal(signal.SIGINT)
        status = main([str(argument) for argument in arguments])
        signal.signal(signal.SIGINT, before)
        captured = self.capsys.readouterr()
        return Outcome(status, captured.out, captured.err)

    def runs(self, *arguments):
        """Checks that a call succeeds, and returns what it prints."""
        __tracebackhide__ = True
        outcome = self(*arguments)
        assert outcome.status == 0, outcome.err
        return outcome.out

    def json(self, *arguments):
        """Returns the JSON on the last line of a call that succeeds."""
        __tracebackhide__ = True
        return json.loads(self.runs(*arguments, "--json").splitlines()[-1])

    def refuses(self, words, *arguments):
        """Checks that a call fails with one line that contains words, and returns the line."""
        __tracebackhide__ = True
        outcome = self(*arguments)
        assert outcome.status == 2 and words in outcome.err, outcome.err
        assert outcome.err.count("\n") == 1, outcome.err
        return outcome.err


@pytest.fixture
def cli(capsys):
    return CommandLine(capsys)


@pytest.fixture(scope="session")
def script():
    """Returns a function that calls the program as a user does, from another folder."""
    program = [ROOT / "scripts" / "leaflight"]
    if sys.platform == "win32":
        # The wheel was unpacked, not installed, so there is no program.
        program = [sys.executable, "-m", "leaflight"]
    elif not Path(leaflight.__file__).is_relative_to(ROOT / "build" / "release"):
        program = [Path(sys.prefix) / "bin" / "leaflight"]

    def call(*arguments, cwd="/"):
        done = subprocess.run(
            [*program, *map(str, arguments)], capture_output=True, text=True, timeout=HANG, cwd=cwd
        )
        return Outcome(done.returncode, done.stdout, done.stderr)

    return call


@pytest.fixture
def values():
    """Returns values (4, 5, 6) that integer types from uint8 on and float types hold exactly."""
    return np.random.default_rng(7).permutation(120).reshape(4, 5, 6).astype(np.float32)
