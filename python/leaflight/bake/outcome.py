# SPDX-License-Identifier: GPL-3.0-or-later
"""Describes the error that a bake in passes reached, for the command line and the panel."""

from typing import Protocol

from .fit_memory import NO_ROOM
from .provenance import Provenance
from .statistics import Statistics


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
            f"{text}; most of it is detail finer than the texels, which more passes do not resolve"
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
