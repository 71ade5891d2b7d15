# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake shown on other values of its volumes, such as those of a new cut, before they are baked.

Light away from the changes is that of the bake. Near them, what the bake has lit is no longer
there. Isosurfaces there get an estimate: the mean light of those that the lamps reach, by normals.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import leaflight._core as _core

from .._core import LeaflightError
from ..volume.regions import cuts_to_record, frozen
from ..volume.volume import Volume
from .baked import Bake
from .provenance import values_sha256

# The core's pass_texels.cpp has the same limit for texels finer than voxels.
MOST_FINE_TEXELS = 32_000_000


def with_values(bake: Bake, volumes: Sequence[Volume], direct: bool = True) -> Bake:
    """Returns a Bake with other values of its volumes and an estimate of their light.

    volumes: As those of the bake and in their places, though with other voxels: cropped or cut.
    direct: False estimates indirect light alone, which is faster, for moved().
    moved() then computes its direct light. Raises LeaflightError for another number of volumes.
    """
    if len(volumes) != len(bake.volumes):
        raise LeaflightError(
            f"The bake has {len(bake.volumes)} volumes, but {len(volumes)} are given: bake again."
        )
    grids = [
        grid if volume.values is baked.values else _grid(bake, number, volume, direct)
        for number, (grid, volume, baked) in enumerate(zip(bake.grids, volumes, bake.volumes))
    ]
    records = tuple(
        replace(
            record,
            source=volume.source,
            values_sha256=values_sha256(volume),
            index_to_world=frozen(volume.index_to_world.tolist()),
            cuts=cuts_to_record(volume.cuts),
        )
        for record, volume in zip(bake.provenance.volumes, volumes)
    )
    known = replace(bake.provenance, volumes=records, continued=bake.id)
    known = known.after(grids, known.passes, known.blocks, known.continued)
    return replace(
        bake,
        volumes=list(volumes),
        grids=grids,
        provenance=known,
        original=bake.original or bake,
    )


def _grid(bake: Bake, number: int, volume: Volume, direct: bool) -> _core.RadianceGrid:
    low, high = (bake.isovalue_of(number, c) for c in bake.isovalues)
    before, grid = bake.volumes[number], bake.grids[number]
    resolution = resolution_on(volume, before, grid.resolution)
    # Without visibility maps, texels contain all light.
    direct = direct or not grid.map_resolution
    now = grid.estimated(before.field(), volume.field(), resolution, (low, high), direct)
    return now.with_texture(bake.scene.isosurfaces[number].texture_on(volume.field()))


def resolution_on(volume: Volume, before: Volume, resolution: Sequence[int]) -> list[int]:
    """Returns the resolution of texels as wide as those of a resolution on another volume.

    If it would have more than MOST_FINE_TEXELS texels, each is at least as wide as a voxel.
    """
    dims = volume.values.shape[::-1]
    each = zip(dims, before.values.shape[::-1], resolution)
    found = [max(2, round((now - 1) * (n - 1) / (then - 1)) + 1) for now, then, n in each]
    if math.prod(found) > MOST_FINE_TEXELS:
        found = [min(n, now) for n, now in zip(found, dims)]
    return found
