# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes with a fixed number of samples in each texel, or scattered over the volume."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import leaflight._core as _core

from ..bake.bake import placed
from ..bake.baked import Bake
from ..bake.color_error import estimated_rms_percent
from ..bake.provenance import provenance_of
from ..bake.statistics import Statistics, statistics_of
from ..progress_bar import with_progress
from ..scene.scene import SceneDescription, core_scene
from .settings import FixedSamples, Samples

if TYPE_CHECKING:
    from typing_extensions import Unpack

MEASURED = ("seconds", "rays", "texels", "peak_memory_bytes", "skipped_passes")


@with_progress("bake")
def bake(
    volumes: Any,
    scene: SceneDescription | None = None,
    *,
    isovalues: Sequence[float] | None = None,
    resolution: int | Sequence[int] | None = None,
    seed: int = 0,
    threads: int = 0,
    both_sides: bool = False,
    walls: bool = False,
    progress: _core.Progress | None = None,
    **samples: "Unpack[Samples]",
) -> Bake:
    """The Bake of volumes by a fixed number of samples, whatever its error.

    volumes, scene, isovalues, seed, threads, both_sides, walls, progress: as of
        leaflight.bake. resolution: texels as there; None is one texel a node.
    samples: those of FixedSamples by their names. samples: rays per texel (32); photons: number of
        photons (2 million); caustic_photons: of those that come by mirrors and glass (as many as
        photons); estimator: "gather" (the default), "volumetric", "path" or "thesis"; photon_map:
        PhotonMap of the last (the thesis's); scattered: Scattered, for samples scattered over the
        domain instead of in each texel, with `samples` rays each; only_at: world points (n, 3), to
        bake only the texels that lookups there use, with the estimator "path".
    Returns a Bake. Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    fixed = FixedSamples(**samples)
    volumes, description, isovalue_range = placed(volumes, scene, isovalues)
    fields = [volume.field() for volume in volumes]
    settings = fixed.core(
        _core.FixedSettings,
        fields[0].dims,
        resolution=resolution,
        seed=seed,
        threads=threads,
        both_sides=both_sides,
        walls=walls,
    )
    core = core_scene(description, fields, isovalue_range)
    baked = _core.bake_with_fixed_samples(core, settings, progress or _core.Progress())
    noise = estimated_rms_percent(baked.grids, description.exposure)
    statistics = fixed_statistics(baked, noise)
    provenance = provenance_of(volumes, description, isovalue_range, settings, fixed.record())
    provenance = provenance.after(baked.grids)
    return Bake(
        volumes,
        description,
        isovalue_range,
        baked.grids,
        baked.walls,
        statistics,
        provenance,
    )


def fixed_statistics(baked: _core.Baked | _core.Baked2, noise: float | None = None) -> Statistics:
    """The Statistics of a bake that has no passes, and estimates no error."""
    known = {name: baked.statistics[name] for name in MEASURED}
    return statistics_of({**known, "estimated_rms_percent": noise})
