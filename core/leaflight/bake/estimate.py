# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake will cost, from its first rounds."""

from dataclasses import dataclass

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from .bake import bake
from .settings import DEFAULT_ERROR, FIXED_WORK

# Rounds of a pilot: the first has yet to find out where the work lies, and two more show how the
# error falls.
PILOT_ROUNDS = 3
# The error falls with the rays to this power; the more, the nearer to that of independent samples.
FLATTEST, STEEPEST = -0.25, -1.0
# By how much the rays of a round exceed those of the last one.
LEAST_GROWTH, MOST_GROWTH = 1.0, 4.0
# Beyond so many rounds nobody waits.
MOST_ROUNDS = 1000


@dataclass(frozen=True)
class Estimate:
    """What a bake will cost here: seconds, memory_bytes of the process at its peak.

    error: percent that it will reach, as far as it is estimated; rounds: how many it will take;
    pilot_rounds: of which so many were done, in pilot_seconds.
    """

    seconds: float
    memory_bytes: int
    error: float
    rounds: int
    pilot_rounds: int
    pilot_seconds: float


def estimate(volumes, scene=None, *, error=None, time=None, progress=None, **settings):
    """The Estimate of a bake, by a pilot: its first rounds, which are thrown away.

    The arguments are those of bake(), without the settings of research.
    Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    given = [name for name in FIXED_WORK if settings.get(name) is not None]
    if given:
        raise LeaflightError(
            "Only of bakes in rounds is there an estimate, not of a fixed amount of work: leave "
            f"out {', '.join(name.replace('_', ' ') for name in given)}."
        )
    progress = progress or _core.Progress()
    rounds = []

    def look(baked):
        rounds.append(baked.statistics)
        if len(rounds) >= PILOT_ROUNDS:
            progress.stop()

    settings = {**settings, "error": error, "time": time, "progress": progress}
    last = bake(volumes, scene, on_round=look, **settings).statistics
    rounds = [one for one in rounds if one["rounds"] < last["rounds"]] + [last]
    return extrapolated(rounds, DEFAULT_ERROR if error is None else error, time)


def extrapolated(rounds, error, time=None):
    """The Estimate of a bake whose first rounds had these statistics.

    error, time: as of bake(). Each further round grows as the last one did, and the error falls on
    with the rays as it did in the last one.
    """
    last = rounds[-1]
    rays, seconds = float(last["rays"]), float(last["seconds"])
    reached, count = float(last["estimated_error_percent"]), int(last["rounds"])
    before = rounds[-2] if len(rounds) > 1 else {"rays": 0, "seconds": 0.0}
    step = max(rays - before["rays"], 1.0)
    pace = max(seconds - before["seconds"], 0.0) / step
    growth, slope = _growth(rounds), _slope(rounds)
    limit = float("inf") if time is None else time
    while reached > error and seconds < limit and count < MOST_ROUNDS:
        step *= growth
        reached *= ((rays + step) / rays) ** slope
        rays, seconds, count = rays + step, seconds + step * pace, count + 1
    return Estimate(
        seconds,
        int(last["peak_memory_bytes"]),
        reached,
        count,
        int(last["rounds"]),
        float(last["seconds"]),
    )


def _growth(rounds):
    steps = [b["rays"] - a["rays"] for a, b in zip(rounds, rounds[1:])]
    if len(steps) < 2:
        return LEAST_GROWTH
    return min(max(steps[-1] / max(steps[-2], 1), LEAST_GROWTH), MOST_GROWTH)


def _slope(rounds):
    """d log error / d log rays over the last round; of independent samples where unknown."""
    if len(rounds) < 2:
        return -0.5
    (r0, e0), (r1, e1) = ((one["rays"], one["estimated_error_percent"]) for one in rounds[-2:])
    if not (r1 > r0 > 0 and e0 > 0 and e1 > 0):
        return -0.5
    return min(max(np.log(e1 / e0) / np.log(r1 / r0), STEEPEST), FLATTEST)
