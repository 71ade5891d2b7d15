# SPDX-License-Identifier: GPL-3.0-or-later
"""Photons at their hits on isosurfaces, as points for display (thesis 4.3.5)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import leaflight._core as _core

from ..arrays import Array
from ..scene.scene import SceneDescription, core_scene
from .bake import placed
from .settings import whole


@dataclass(frozen=True, eq=False)
class Photons:
    """The n hits on isosurfaces of `count` photons that lights emitted.

    positions: Hits in world coordinates, float64 (n, 3).
    flux_height: Flux of each photon in W times the height of the isovalue range, float32 (n, 3).
        The height is in units of the common isovalue (thesis Eq. 4.4).
    common_isovalue: Isovalue of each hit, float32 (n,). It is that of the volume if there is only
        one.
    direct: True for photons straight from a light, bool (n,).
    """

    count: int
    positions: Array
    flux_height: Array
    common_isovalue: Array
    direct: Array

    def colors(self) -> Array:
        """Returns their colors (n, 3), the flux scaled to a mean gray of radiance 0.5."""
        colors: Array = 0.5 * self.flux_height / max(float(self.flux_height.mean()), 1e-30)
        return colors


def trace_photons(
    volumes: Any,
    scene: SceneDescription | None = None,
    *,
    count: int,
    isovalues: Sequence[float] | None = None,
    seed: int = 0,
    progress: _core.Progress | None = None,
) -> Photons:
    """Traces the Photons of a scene, those of a bake with as many photons and the same seed.

    volumes, scene, isovalues: see bake(). Raises LeaflightError, Cancelled.
    """
    count, seed = whole("photons", count, 1), whole("seed", seed, 0)
    volumes, description, isovalue_range = placed(volumes, scene, isovalues)
    fields = [volume.field() for volume in volumes]
    progress = progress or _core.Progress()
    found = _core.photon_points(
        core_scene(description, fields, isovalue_range), count, seed, progress
    )
    if progress.cancelled:
        raise _core.Cancelled()
    positions, flux_height, c, direct = found
    return Photons(count, positions, flux_height, c, direct.astype(bool))
