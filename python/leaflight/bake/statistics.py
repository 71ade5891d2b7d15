# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of a bake, its estimated error, and a sentence on its outcome."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple, Protocol

import leaflight._core as _core

from .provenance import Provenance

# Names in skipped_passes of work for which the memory or the time had no room.
FINER_TEXELS = "finer texels"
NO_ROOM = FINER_TEXELS, "finer walls"


class SkippedPass(NamedTuple):
    """A part of the work that was skipped, and the reason."""

    name: str
    reason: str


@dataclass(frozen=True)
class Statistics:
    """The cost of a bake in passes, or of one with a fixed number of samples (validation/thesis).

    A fixed number of samples has no passes and no estimated errors: 0 and None.

    seconds: Time of the bake, without reading and writing files.
    rays: Number of rays traced, including lines.
    texels: Number of texels that hold radiance.
    peak_memory_bytes: Peak memory of the process.
    skipped_passes: A SkippedPass for each part of the work that was skipped.
    passes, blocks: Numbers of them in the averages.
    stopped: True if a stop or the time limit ended the bake before it reached its target error.
    estimated_error_percent: Estimate of rms_percent of compare().
    estimated_noise_percent: The part of that error that more passes reduce.
    worst_error_percent, worst_isovalue: Error and isovalue of the isosurface with the largest
        error.
    estimated_rms_percent: RMS of the noise that the texels report, in the units of compare(). None
        in bakes that on_pass gets, because it is slow to compute.
    """

    seconds: float
    rays: int
    texels: int
    peak_memory_bytes: int
    skipped_passes: tuple[SkippedPass, ...]
    passes: int = 0
    blocks: int = 0
    stopped: bool = False
    estimated_error_percent: float | None = None
    estimated_noise_percent: float | None = None
    worst_error_percent: float | None = None
    worst_isovalue: float | None = None
    estimated_rms_percent: float | None = None

    @property
    def rays_per_second(self) -> float:
        return self.rays / max(self.seconds, 1e-9)

    def record(self) -> dict[str, Any]:
        """Returns the fields in JSON's types, with rays_per_second."""
        return {**asdict(self), "rays_per_second": self.rays_per_second}


def cost_of(baked: _core.Baked | _core.Baked2) -> Statistics:
    """Returns the Statistics of a bake that has no passes and estimates no error."""
    known = baked.statistics
    return Statistics(
        seconds=known.seconds,
        rays=known.rays,
        texels=baked.texels,
        peak_memory_bytes=known.peak_memory_bytes,
        skipped_passes=tuple(SkippedPass(*each) for each in known.skipped),
    )


def statistics_of(baked: _core.Baked | _core.Baked2) -> Statistics:
    """Returns the Statistics of a bake in passes, without estimated_rms_percent."""
    known = baked.statistics
    return replace(
        cost_of(baked),
        passes=known.passes,
        blocks=known.blocks,
        stopped=known.stopped,
        estimated_error_percent=known.error_percent,
        estimated_noise_percent=known.noise_percent,
        worst_error_percent=known.worst_error_percent,
        worst_isovalue=known.worst_isovalue,
    )


def statistics_from_record(record: Mapping[str, Any]) -> Statistics:
    """Returns the Statistics of a record().

    Raises KeyError, TypeError, ValueError for any other.
    """
    known = {name: value for name, value in record.items() if name != "rays_per_second"}
    skipped = tuple(SkippedPass(str(a), str(b)) for a, b in known.pop("skipped_passes"))
    return Statistics(skipped_passes=skipped, **known)


class _Baked(Protocol):
    """A Bake, or a FlatBake."""

    @property
    def statistics(self) -> Statistics: ...
    @property
    def provenance(self) -> Provenance: ...


def outcome(bake: _Baked, why: str = "it was stopped or reached its time limit") -> str:
    """Returns a sentence about the estimated error of a Bake or FlatBake and its target.

    why: the reason, if it stopped early. The text is empty for a fixed amount of work.
    """
    if bake.provenance.fixed is not None:
        return ""
    text = _reached(bake, why)
    reasons = [reason for name, reason in bake.statistics.skipped_passes if name in NO_ROOM]
    return "; ".join([text, *reasons])


def _reached(bake: _Baked, why: str) -> str:
    statistics = bake.statistics
    target, reached = bake.provenance.error, statistics.estimated_error_percent
    assert target is not None and reached is not None
    passes = f"{statistics.passes} pass{'es' if statistics.passes > 1 else ''}"
    text = (
        f"estimated error {reached:.2f} %{_worst(statistics)} after {passes} (target {target:g} %)"
    )
    if reached <= target:
        return text
    if statistics.stopped:
        return f"{text}; the target was not reached: {why}"
    if not bake.provenance.blocks:
        return f"{text}; so few samples did not reach the target"
    if is_limited_by_texels(bake):
        return (
            f"{text}; most of it is detail finer than the texels, which a higher resolution "
            "resolves, but not more passes"
        )
    return f"{text}; the largest number of passes did not reach the target: continue the bake"


def is_limited_by_texels(bake: _Baked) -> bool:
    """Returns True if most of the error is detail finer than the texels.

    More passes do not add it.
    """
    reached = bake.statistics.estimated_error_percent
    noise = bake.statistics.estimated_noise_percent
    # Compare variances.
    return reached is not None and noise is not None and 2 * noise**2 < reached**2


def _worst(statistics: Statistics) -> str:
    """Returns the isovalue with a clearly larger error than the mean, in brackets; or ""."""
    worst, at = statistics.worst_error_percent, statistics.worst_isovalue
    error = statistics.estimated_error_percent
    assert worst is not None and at is not None and error is not None
    if worst < 1.2 * error:
        return ""
    return f" ({worst:.1f} % about isovalue {at:.3g})"
