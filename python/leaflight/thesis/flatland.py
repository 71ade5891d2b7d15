# SPDX-License-Identifier: GPL-3.0-or-later
"""Isolines of images, lit by a fixed number of samples."""

import leaflight._core as _core

from ..flatland.flatland import FlatBake, flat_placed
from ..progress_bar import with_progress
from .bake import fixed_statistics
from .settings import FixedSamples


@with_progress("flatland")
def bake_flatland(
    volume,
    scene=None,
    *,
    isovalues=None,
    resolution=None,
    seed=0,
    threads=0,
    progress=None,
    **samples,
):
    """The FlatBake of a height field by a fixed number of samples, whatever its error.

    volume, scene, isovalues, resolution: as of leaflight.flatland.bake_flatland; the rest as of
    leaflight.thesis.bake. Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    scene, isovalue_range, core = flat_placed(volume, scene, isovalues)
    settings = FixedSamples(**samples).core(
        _core.FixedSettings2,
        volume.field().dims,
        resolution=resolution,
        seed=seed,
        threads=threads,
    )
    baked = _core.bake_with_fixed_samples2(core, settings, progress or _core.Progress())
    return FlatBake(volume, scene, isovalue_range, baked.grids[0], fixed_statistics(baked))
