# SPDX-License-Identifier: GPL-3.0-or-later
"""Isolines of images, lit by a fixed number of samples."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import leaflight._core as _core

from ..flatland.flat_scene import FlatScene
from ..flatland.flatland import FlatBake, flat_placed
from ..progress_bar import with_progress
from ..volume.volume import Volume
from .bake import fixed_statistics
from .settings import FixedSamples, Samples

if TYPE_CHECKING:
    from typing_extensions import Unpack


@with_progress("flatland")
def bake_flatland(
    volume: Volume,
    scene: FlatScene | None = None,
    *,
    isovalues: Sequence[float] | None = None,
    resolution: int | Sequence[int] | None = None,
    seed: int = 0,
    threads: int = 0,
    progress: _core.Progress | None = None,
    **samples: "Unpack[Samples]",
) -> FlatBake:
    """The FlatBake of a height field by a fixed number of samples, whatever its error.

    volume, scene, isovalues, resolution: as of leaflight.flatland.bake_flatland; the rest as of
    leaflight.thesis.bake. Raises LeaflightError for input that cannot be baked, Cancelled.
    """
    scene, isovalue_range, core = flat_placed(volume, scene, isovalues)
    settings = FixedSamples(**samples).core(
        _core.FixedSettings2,
        volume.flat_field().dims,
        resolution=resolution,
        seed=seed,
        threads=threads,
    )
    baked = _core.bake_with_fixed_samples2(core, settings, progress or _core.Progress())
    return FlatBake(volume, scene, isovalue_range, baked.grids[0], fixed_statistics(baked))
