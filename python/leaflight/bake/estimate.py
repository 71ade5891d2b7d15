# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates the cost of a bake from its first passes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import leaflight._core as _core
import numpy as np
from numpy.typing import ArrayLike

from ..progress_bar import with_progress
from ..scene.scene import SceneDescription
from .bake import Workers, bake
from .baked import Bake
from .settings import DEFAULT_ERROR, BakeOptions
from .statistics import Statistics

if TYPE_CHECKING:
    from typing_extensions import Unpack

# Passes of a pilot: two show how fast the error falls.
PILOT_PASSES = 2
# Exponents of noise as a power of work. Independent samples have -0.5. Otherwise it is the exponent
# of the last pass, within these limits.
INDEPENDENT, STEEPEST, FLATTEST = -0.5, -1.0, -0.25
# Upper bound on passes with the same texels. Each is as much work as all before it.
MOST_PASSES = 5


class PilotOptions(BakeOptions, total=False):
    """The settings of bake() that estimate() passes to it."""

    spacing: ArrayLike | None
    workers: Workers | None


@dataclass(frozen=True)
class Estimate:
    """The expected cost of a bake here: seconds, and memory_bytes of the process at its peak.

    error: estimated error that it will reach, in percent; passes: their expected number;
    pilot_passes: number of them that the pilot ran, in pilot_seconds.
    """

    seconds: float
    memory_bytes: int
    error: float
    passes: int
    pilot_passes: int
    pilot_seconds: float


@dataclass(frozen=True, eq=False)
class Pilot:
    """The first passes of a bake: the Statistics of each pass and of the returned Bake."""

    passes: list[Statistics]
    last: Statistics

    def estimate(self, error: float, time: float | None = None) -> Estimate:
        """Returns the Estimate of a bake to an error, at least the one of the pilot."""
        closing = max(self.last.seconds - self.passes[-1].seconds, 0) if self.passes else 0
        for number, one in enumerate(self.passes):
            if _error(one) <= error:
                passes = self.passes[: number + 1]
                ended = replace(
                    one,
                    stopped=False,
                    seconds=one.seconds + closing,
                    peak_memory_bytes=self.last.peak_memory_bytes,
                )
                return extrapolated(passes, ended, error, time)
        return extrapolated(self.passes, self.last, error, time)


@with_progress("estimate")
def estimate(
    volumes: Any,
    scene: SceneDescription | None = None,
    *,
    progress: _core.Progress | None = None,
    **settings: "Unpack[PilotOptions]",
) -> Estimate:
    """Returns the Estimate of a bake. Runs a pilot, its first passes, and discards the light.

    The arguments are those of bake().
    Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    made, error = pilot(volumes, scene, progress, **settings), settings.get("error")
    error = DEFAULT_ERROR if error is None else error
    return extrapolated(made.passes, made.last, error, settings.get("time"))


def pilot(
    volumes: Any,
    scene: SceneDescription | None = None,
    progress: _core.Progress | None = None,
    **settings: "Unpack[PilotOptions]",
) -> Pilot:
    """Runs the Pilot of a bake. It gives the Estimates of all errors down to the one given.

    The arguments and the errors raised are those of estimate().
    """
    watched = progress or _core.Progress()
    passes: list[Statistics] = []

    def collect(baked: Bake) -> None:
        passes.append(baked.statistics)
        if len(_alike(passes)) >= PILOT_PASSES:
            watched.stop()

    baked = bake(volumes, scene, on_pass=collect, progress=watched, **settings)
    return Pilot(passes, baked.statistics)


def extrapolated(
    passes: Sequence[Statistics], last: Statistics, error: float, time: float | None = None
) -> Estimate:
    """Returns the Estimate of a bake from the statistics of its first passes and of its result.

    error, time: as for bake().
    """
    pilot = len(passes), float(last.seconds)
    memory, reached = int(last.peak_memory_bytes), float(_error(last))
    if not passes or not last.stopped:
        return Estimate(pilot[1], memory, reached, int(last.passes), *pilot)
    seconds, count = float(passes[-1].seconds), len(passes)
    # Seconds after the last pass, such as for the light on the walls.
    closing = max(pilot[1] - seconds, 0.0)
    alike = _alike(passes)
    work, pace = _work(alike)
    slope = 0.5 * (INDEPENDENT + _slope(alike))
    limit = float("inf") if time is None else time - closing
    noise = float(_noise(last))
    texture = np.sqrt(max(0.0, reached**2 - noise**2))
    left = MOST_PASSES - len(alike)
    while seconds < limit and left > 0:
        target = _core.noise_to_reach(error, texture)
        # A difference by rounding needs no further pass.
        if noise <= (1 + 1e-9) * target:
            break
        in_time = 1.0 + (limit - seconds) / (work * pace)
        growth = min((noise / target) ** (-1.0 / slope), 2.0, in_time)
        seconds += (growth - 1.0) * work * pace
        noise *= growth**slope
        work, count, left = growth * work, count + 1, left - 1
    error = float(np.hypot(texture, noise))
    return Estimate(seconds + closing, memory, error, count, *pilot)


def _error(one: Statistics) -> float:
    assert one.estimated_error_percent is not None
    return one.estimated_error_percent


def _noise(one: Statistics) -> float:
    assert one.estimated_noise_percent is not None
    return one.estimated_noise_percent


def _alike(passes: Sequence[Statistics]) -> list[Statistics]:
    """Returns the passes with about as many texels as the last one.

    A bake may begin with a coarse result.
    """
    return [one for one in passes if 2 * one.texels >= passes[-1].texels]


def _work(passes: Sequence[Statistics]) -> tuple[int, float]:
    """Returns (rays traced by the work that reduces noise, seconds per ray).

    The last of two passes traces as many rays as all passes before it. The rest is done once.
    """
    last = passes[-1]
    if len(passes) == 1:
        return last.rays, last.seconds / max(last.rays, 1)
    step = max(last.rays - passes[-2].rays, 1)
    return 2 * step, (last.seconds - passes[-2].seconds) / step


def _slope(passes: Sequence[Statistics]) -> float:
    """Returns d log noise / d log work over the last pass, which doubled the work."""
    if len(passes) < 2:
        return INDEPENDENT
    before, after = map(_noise, passes[-2:])
    if not before > after > 0:
        return FLATTEST
    return min(max(float(np.log2(after / before)), STEEPEST), FLATTEST)
