# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake of the bump box in a separate process, so that its peak of memory is the bake's."""

import multiprocessing
import re
import signal
from pathlib import Path

from leaflight._core import Cancelled, LeaflightError
from leaflight.bake.bake import bake
from leaflight.io.scene_file import packaged_scene
from leaflight.volume.volume import bump_box

POLL_SECONDS = 0.05
# Names of the bake's statistics to keep.
KEPT = ("seconds", "rays", "texels")


def bake_bump_box(nodes, seed, threads, progress):
    """Bakes nodes^3 with the default settings; returns a dict of KEPT and peak_bytes.

    Raises LeaflightError, also if the process ends without an answer, and Cancelled.
    """
    # A copy of this process would begin with its memory, and with locks that others hold.
    context = multiprocessing.get_context("spawn")
    answers, answer = context.Pipe(duplex=False)
    process = context.Process(target=_bake, args=(answer, nodes, seed, threads))
    process.start()
    answer.close()
    try:
        while not answers.poll(POLL_SECONDS):
            if progress.cancelled:
                raise Cancelled("The bake was cancelled.")
        found = answers.recv()
    except EOFError:
        process.join()
        raise LeaflightError(
            f"The bake of {nodes}^3 nodes ended without an answer (exit status "
            f"{process.exitcode}): see whether there is enough memory."
        ) from None
    finally:
        process.kill()
        process.join()
    if isinstance(found, str):
        raise LeaflightError(found)
    return found


def _bake(answer, nodes, seed, threads):
    # Ctrl-C reaches all processes of a terminal; the one that shows progress answers it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        baked = bake(bump_box(nodes), packaged_scene("bump_box.json"), seed=seed, threads=threads)
        answer.send(
            {name: getattr(baked.statistics, name) for name in KEPT} | {"peak_bytes": _peak(baked)}
        )
    except LeaflightError as error:
        answer.send(str(error))


def _peak(baked):
    """Returns the most bytes that this process has held.

    Linux's figures of its resources, which the statistics use, include the peak of the process that
    started it: exec keeps that.
    """
    try:
        status = Path("/proc/self/status").read_text()
    except OSError:
        return baked.statistics.peak_memory_bytes
    return 1024 * int(re.search(r"VmHWM:\s+(\d+) kB", status)[1])
