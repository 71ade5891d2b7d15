# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes with a fixed number of samples in each texel, or scattered over the volume."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import _thesis
import leaflight._core as _core
from leaflight.bake.bake import placed
from leaflight.bake.baked import Bake
from leaflight.bake.color_error import estimated_rms_percent
from leaflight.bake.provenance import provenance_of
from leaflight.bake.statistics import cost_of
from leaflight.io.scene_file import scene_to_json
from leaflight.progress_bar import with_progress
from leaflight.scene.scene import SceneDescription, core_scene

from .settings import FixedSamples, SampleOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


@with_progress("bake")
def bake(
    volumes: Any,
    scene: SceneDescription | None = None,
    *,
    progress: _core.Progress | None = None,
    **settings: "Unpack[SampleOptions]",
) -> Bake:
    """Computes the Bake of volumes by a fixed number of samples.

    volumes, scene, isovalues, seed, threads, both_sides, walls, progress: As for leaflight.bake.
    resolution: Texels along the longest axis, or (nx, ny, nz). None is one texel per node.
    settings: Fields of FixedSamples by name, as follows.
    samples: Rays per texel (32).
    photons: Number of photons (2 million).
    caustic_photons: Number of photons by mirrors and glass. The default is that of photons.
    estimator: "gather" (default), "volumetric", "path" or "thesis".
    photon_map: PhotonMap of the estimator "thesis". The default is the one of the thesis.
    scattered: Scattered, for samples over the domain instead of in each texel, with `samples` rays
        each.
    only_at: World points (n, 3). Only texels that lookups there use are baked; the estimator is
        "path".
    Returns a Bake. Raises Cancelled, and LeaflightError for input that cannot be baked.
    """
    fixed = FixedSamples(**settings)
    volumes, description, isovalue_range = placed(volumes, scene, fixed.isovalues)
    fields = [volume.field() for volume in volumes]
    of_core = fixed.core(_thesis.FixedSettings, fields[0].dims)
    core = core_scene(description, fields, isovalue_range)
    baked = _thesis.bake_with_fixed_samples(core, of_core, progress or _core.Progress())
    noise = estimated_rms_percent(baked.grids, description.exposure)
    statistics = replace(cost_of(baked), estimated_rms_percent=noise)
    text = scene_to_json(description)
    provenance = provenance_of(
        volumes, description.isosurfaces, text, isovalue_range, of_core, fixed.record()
    )
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
