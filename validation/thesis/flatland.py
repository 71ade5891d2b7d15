# SPDX-License-Identifier: GPL-3.0-or-later
"""Isolines of images, lit by a fixed number of samples."""

from typing import TYPE_CHECKING

import _thesis
import leaflight._core as _core
from leaflight.bake.statistics import cost_of
from leaflight.flatland.flat_scene import FlatScene
from leaflight.flatland.flatland import FlatBake, flat_placed, flat_provenance, refuse_sides
from leaflight.progress_bar import with_progress
from leaflight.volume.volume import Volume

from .settings import FixedSamples, SampleOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


@with_progress("flatland")
def bake_flatland(
    volume: Volume,
    scene: FlatScene | None = None,
    *,
    progress: _core.Progress | None = None,
    **settings: "Unpack[SampleOptions]",
) -> FlatBake:
    """Computes the FlatBake of a height field by a fixed number of samples.

    volume, scene, progress: As for leaflight.flatland.bake_flatland.
    settings: Fields of FixedSamples by name, as for thesis.bake, except both_sides and
        walls.
    Raises Cancelled, and LeaflightError for input that cannot be baked.
    """
    fixed = FixedSamples(**settings)
    refuse_sides(fixed)
    scene, isovalue_range, core = flat_placed(volume, scene, fixed.isovalues)
    of_core = fixed.core(_thesis.FixedSettings2, volume.flat_field().dims)
    baked = _thesis.bake_with_fixed_samples2(core, of_core, progress or _core.Progress())
    provenance = flat_provenance(volume, scene, isovalue_range, of_core, fixed.record())
    (grid,) = baked.grids
    known = provenance.after([grid])
    return FlatBake(volume, scene, isovalue_range, grid, cost_of(baked), known)
