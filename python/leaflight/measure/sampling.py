# SPDX-License-Identifier: GPL-3.0-or-later
"""The sampling of a measurement: its points and its paths."""

from dataclasses import dataclass
from typing import TypedDict


class SamplingOptions(TypedDict, total=False):
    """The fields of Sampling by name."""

    points: int
    spp: int
    seed: int
    threads: int


@dataclass(frozen=True)
class Sampling:
    """The points and paths of a measurement.

    points: Approximate number of points.
    spp: Paths per point.
    seed, threads: As for bake().
    """

    points: int = 3000
    spp: int = 1024
    seed: int = 0
    threads: int = 0


@dataclass(frozen=True)
class Target:
    """The isosurface of a volume, or a mesh of the walls if one is given, by number.

    back: True for the back of the isosurface, or the side that the mesh's normals point away from.
    """

    volume: int = 0
    mesh: int | None = None
    back: bool = False
