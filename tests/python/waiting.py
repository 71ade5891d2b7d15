# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions with which tests wait for events, however long they take."""

import subprocess
import time
from contextlib import contextmanager

# Seconds after which a program is assumed to hang, on any machine.
HANG = 1800


def wait_for(happened, can_happen):
    """Waits until happened() or until not can_happen(); returns whether it has happened."""
    while not happened():
        if not can_happen():
            return happened()
        time.sleep(0.01)
    return True


@contextmanager
def started(*command, **options):
    """Starts a program that may never end by itself; the context ends it."""
    with subprocess.Popen(*command, **options) as process:
        try:
            yield process
        finally:
            process.kill()
