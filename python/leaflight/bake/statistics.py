# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of a bake, and its estimated error."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple

import leaflight._core as _core


class SkippedPass(NamedTuple):
    """A part of the work that was skipped, and the reason."""

    name: str
    reason: str


@dataclass(frozen=True)
class Statistics:
    """The cost of a bake in passes, or of one with a fixed number of samples (../thesis).

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
