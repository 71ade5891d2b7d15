# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the progress of long work in Python, and its end by Ctrl-C."""

import contextlib
import fcntl
import os
import pty
import signal
import struct
import subprocess
import sys
import termios
import threading
from pathlib import Path

import leaflight
import pytest
from leaflight import Progress
from leaflight.progress_bar import with_progress
from outcomes import refused
from waiting import HANG


def test_a_function_is_called_with_fraction_and_stage(small):
    seen, here = [], threading.get_ident()

    def look(fraction, stage):
        assert threading.get_ident() == here
        seen.append((fraction, stage))

    leaflight.bake(leaflight.bump_box(12), **small, progress=look)
    fraction, stage = seen[-1]
    assert 0 < fraction <= 1 and stage


def test_what_the_function_raises_ends_the_work(small):
    def refuse(*_):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        leaflight.bake(leaflight.bump_box(12), **small, progress=refuse)
    assert "bake" not in [thread.name for thread in threading.enumerate()]


def test_a_progress_is_used_as_it_is():
    given = Progress()

    @with_progress("test")
    def work(*, progress=None):
        return progress, threading.current_thread().name

    assert work(progress=given) == (given, "MainThread")
    progress, name = work(progress=False)
    assert isinstance(progress, Progress) and name == "test"


def test_errors_are_raised_in_the_thread_of_the_caller():
    refused("there is no such file", leaflight.read_volume, "nowhere.nii")


ENDLESS = """
import sys
import leaflight
from leaflight import progress_bar

progress_bar.PATIENCE_SECONDS = 0.0
try:
    leaflight.bake(leaflight.bump_box(100), error=1e-3)
except KeyboardInterrupt:
    print("interrupted")
"""


def test_ctrl_c_ends_a_bake_in_a_terminal(tmp_path):
    """Checks that the terminal shows a bar: tqdm's if it is installed, else ours."""
    leader, follower = pty.openpty()
    # tqdm shows nothing in a terminal without columns.
    fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("4H", 24, 80, 0, 0))
    environment = {**os.environ, "PYTHONPATH": str(Path(leaflight.__file__).parents[1])}
    process = subprocess.Popen(
        [sys.executable, "-c", ENDLESS],
        stdout=subprocess.PIPE,
        stderr=follower,
        env=environment,
        text=True,
        # Shells ignore SIGINT for background jobs, and children inherit that, so restore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    os.close(follower)
    shown = b""
    while b"%" not in shown:
        shown += os.read(leader, 4096)
    process.send_signal(signal.SIGINT)
    # Read the terminal until its end, which is an error; otherwise it would fill up.
    with contextlib.suppress(OSError):
        while os.read(leader, 4096):
            pass
    out, _ = process.communicate(timeout=HANG)
    os.close(leader)
    assert out == "interrupted\n" and shown.strip().startswith(b"bake")
