# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions with which tests wait for events, however long they take."""

import os
import subprocess
import sys
import time
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

# Seconds after which a program is assumed to hang, on any machine.
HANG = 1800


def wait_for(happened, can_happen):
    """Waits until happened() or until not can_happen(); returns whether it has happened."""
    while not happened():
        if not can_happen():
            return happened()
        time.sleep(0.01)
    return True


def package_folder():
    """Returns the folder of the package under test."""
    return Path(find_spec("leaflight").origin).parents[1]


def run_python(*arguments, paths=None, variables=None, **options):
    """Runs another Python to its end. Returns its status and what it said.

    paths: where it finds modules instead of the package and PYTHONPATH. variables: of the
    environment. options: of subprocess.run().
    """
    inherited = filter(None, [os.environ.get("PYTHONPATH")])
    found = map(str, paths or [package_folder(), *inherited])
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(found), **(variables or {})},
        **{"capture_output": True, "text": True, "timeout": HANG, **options},
    )


@contextmanager
def started(*command, **options):
    """Starts a program that may never end by itself; the context ends it."""
    with subprocess.Popen(*command, **options) as process:
        try:
            yield process
        finally:
            process.kill()
