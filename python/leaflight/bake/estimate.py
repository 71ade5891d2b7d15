# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake will cost, from its first rounds."""

from dataclasses import dataclass

import leaflight._core as _core
import numpy as np

from ..progress_bar import with_progress
from .bake import bake
from .settings import DEFAULT_ERROR

# Rounds of a pilot: two show how fast the error falls.
PILOT_ROUNDS = 2
# How noise falls with the work: as the square root, which is that of independent samples, or as it
# did in the last round, within these.
INDEPENDENT, STEEPEST, FLATTEST = -0.5, -1.0, -0.25
# Rounds of the same texels; each is as much work as all before it.
MOST_ROUNDS = 5


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


@dataclass(frozen=True, eq=False)
class Pilot:
    """The first rounds of a bake: statistics of each, and of what it returned."""

    rounds: list
    last: dict

    def estimate(self, error, time=None):
        """The Estimate of a bake to an error, no smaller than the pilot was made for."""
        closing = max(self.last["seconds"] - self.rounds[-1]["seconds"], 0) if self.rounds else 0
        for number, one in enumerate(self.rounds):
            if one["estimated_error_percent"] <= error:
                rounds = self.rounds[: number + 1]
                ended = {**one, "stopped": False, "seconds": one["seconds"] + closing}
                ended["peak_memory_bytes"] = self.last["peak_memory_bytes"]
                return extrapolated(rounds, ended, error, time)
        return extrapolated(self.rounds, self.last, error, time)


@with_progress("estimate")
def estimate(volumes, scene=None, *, error=None, time=None, progress=None, **settings):
    """The Estimate of a bake, by a pilot: its first rounds, which are thrown away.

    The arguments are those of bake().
    Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    made = pilot(volumes, scene, error=error, time=time, progress=progress, **settings)
    return extrapolated(made.rounds, made.last, DEFAULT_ERROR if error is None else error, time)


def pilot(volumes, scene=None, *, error=None, time=None, progress=None, **settings):
    """The Pilot of a bake, from which follow the Estimates of all errors down to the one given.

    The arguments and what is raised are those of estimate().
    """
    progress = progress or _core.Progress()
    rounds = []

    def look(baked):
        rounds.append(baked.statistics)
        if len(_alike(rounds)) >= PILOT_ROUNDS:
            progress.stop()

    settings = {**settings, "error": error, "time": time, "progress": progress}
    return Pilot(rounds, bake(volumes, scene, on_round=look, **settings).statistics)


def extrapolated(rounds, last, error, time=None):
    """The Estimate of a bake from the statistics of its first rounds and of what it returned.

    error, time: as of bake().
    """
    pilot = len(rounds), float(last["seconds"])
    memory, reached = int(last["peak_memory_bytes"]), float(last["estimated_error_percent"])
    if not rounds or not last["stopped"]:
        return Estimate(pilot[1], memory, reached, int(last["rounds"]), *pilot)
    seconds, count = float(rounds[-1]["seconds"]), len(rounds)
    # What follows the last round, such as the light on the surroundings.
    closing = max(pilot[1] - seconds, 0.0)
    alike = _alike(rounds)
    work, pace = _work(alike)
    slope = 0.5 * (INDEPENDENT + _slope(alike))
    limit = float("inf") if time is None else time
    noise = float(last["estimated_noise_percent"])
    missed, noisy = _texture(alike, reached, noise)
    left = MOST_ROUNDS - len(alike)
    while seconds < limit and left > 0:
        target = _core.noise_to_reach(error, np.hypot(missed, noisy * noise))
        # Rounding is no round.
        if noise <= (1 + 1e-9) * target:
            break
        growth = min((noise / target) ** (-1.0 / slope), 2.0)
        seconds += (growth - 1.0) * work * pace
        noise *= growth**slope
        work, count, left = growth * work, count + 1, left - 1
    error = float(np.sqrt(missed**2 + (1 + noisy**2) * noise**2))
    return Estimate(seconds + closing, memory, error, count, *pilot)


def _alike(rounds):
    """The rounds with about as many texels as the last: a bake may begin with a coarse picture."""
    return [one for one in rounds if 2 * one["texels"] >= rounds[-1]["texels"]]


def _work(rounds):
    """(rays that rounds have traced for what falls with them, seconds a ray).

    The last of two rounds is as much as all before it, besides what is done once.
    """
    last = rounds[-1]
    if len(rounds) == 1:
        return last["rays"], last["seconds"] / max(last["rays"], 1)
    step = max(last["rays"] - rounds[-2]["rays"], 1)
    return 2 * step, (last["seconds"] - rounds[-2]["seconds"]) / step


def _texture(rounds, reached, noise):
    """(what texels miss, percent; what noise adds to its estimate, a factor of the noise).

    A bake judges what texels miss by their neighbours, whose noise falls from round to round.
    """
    texture = max(0.0, reached**2 - noise**2)
    if len(rounds) < 2:
        return np.sqrt(texture), 0.0
    errors, noises = (
        [one[f"estimated_{kind}_percent"] ** 2 for one in rounds[-2:]]
        for kind in ("error", "noise")
    )
    fallen = noises[0] - noises[1]
    if not fallen > 0:
        return np.sqrt(texture), 0.0
    noisy = max(0.0, (errors[0] - errors[1]) / fallen - 1)
    noisy = min(noisy, texture / max(noise**2, 1e-12))
    return np.sqrt(texture - noisy * noise**2), np.sqrt(noisy)


def _slope(rounds):
    """d log noise / d log work over the last round, which doubled the work."""
    if len(rounds) < 2:
        return INDEPENDENT
    before, after = (one["estimated_noise_percent"] for one in rounds[-2:])
    if not before > after > 0:
        return FLATTEST
    return min(max(float(np.log2(after / before)), STEEPEST), FLATTEST)
