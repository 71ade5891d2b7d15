# SPDX-License-Identifier: GPL-3.0-or-later
"""The sampling of a measurement: its points and its paths."""

from dataclasses import dataclass
from typing import TypedDict


class SamplingOptions(TypedDict, total=False):
    """Sampling by its names."""

    points: int
    spp: int
    seed: int
    threads: int


@dataclass(frozen=True)
class Sampling:
    """points: about how many; spp: paths a point; seed, threads: as of leaflight.bake."""

    points: int = 3000
    spp: int = 1024
    seed: int = 0
    threads: int = 0


@dataclass(frozen=True)
class Target:
    """The isosurface of a volume, or a mesh of the walls if one is given, by their numbers.

    back: the back of the isosurface, or the side of the mesh from which its normals point away.
    """

    volume: int = 0
    mesh: int | None = None
    back: bool = False
