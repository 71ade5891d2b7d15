# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of an isosurface at rest, at the vertices of its mesh."""

import time

import leaflight._core as _core

from .._core import LeaflightError


# A mesh at rest is cut finer, twice at most, until it has as many vertices: light is interpolated
# between these.
LEAST_VERTICES = 200_000


def settle(settling, seconds=None, threads=0, progress=None):
    """Works on a _core.Settle until it is done, or until the round after so many seconds.

    Returns (radiance float32 (n, 3), the standard error (n,) of what it traced). Without a limit
    the result is the same whatever the threads. Raises LeaflightError, Cancelled.
    """
    if seconds is not None and not seconds > 0:
        raise LeaflightError(f"An isosurface cannot settle in {seconds:g} seconds: allow it more.")
    progress = progress or _core.Progress()
    start = time.perf_counter()
    while settling.rounds_done < settling.rounds:
        settling.refine(progress, threads)
        if seconds is not None and time.perf_counter() - start >= seconds:
            break
    return settling.settled()
