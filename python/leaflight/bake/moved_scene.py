# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake shown in another scene: exact direct light, plus the scaled indirect light of the bake.

Lamps, walls and volumes may have moved, or be new or missing. Visibility maps are computed again,
so direct light is exact. All other light of isosurfaces and walls is that of the bake, scaled by
one factor per channel: the growth of the light that returns to isosurfaces after one reflection.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import leaflight._core as _core

from .._core import LeaflightError
from ..io.scene_file import scene_to_json
from ..scene.scene import Mesh, SceneDescription
from ..volume.other_arrays import as_volumes
from ..volume.regions import frozen
from ..volume.volume import Volume
from .bake import placed
from .baked import Bake
from .changed_values import resolution_on
from .relit import can_be_relit
from .provenance import Provenance, values_sha256


@dataclass(frozen=True)
class Detail:
    """The sampling density of direct light.

    wider: Factor on the width of texels of visibility maps.
    spacing: Upper bound on the voxels between the lines that sample the maps.
    share: Number of shadow rays of the walls of which one is traced.
    """

    wider: int = 1
    spacing: float = 1.0
    share: int = 1


WHOLE = Detail()
# Lines are as far apart as texels. Neighbors on walls trace different rays, together as many as
# there are light points.
QUICK = Detail(wider=2, spacing=math.inf, share=7)


def moved(
    bake: Bake,
    volumes: Any,
    scene: SceneDescription | None,
    *,
    isovalues: Sequence[float] | None = None,
    quick: bool = False,
    walls: bool = True,
    progress: _core.Progress | None = None,
) -> Bake:
    """Returns the Bake in another scene: computes direct light and scales indirect light.

    bake: A Bake in passes, or with_values() of one.
    volumes, scene: As for bake(). The values must be those of the bake; their positions may differ.
    isovalues: As for bake(). None is the range of the bake.
    quick: True makes the texels of visibility maps twice as wide and traces fewer shadow rays. It
        takes a fifth of the time. Shadows are blurred and may miss thin parts.
    walls: True lights baked walls again, too. Otherwise the result has none.
    progress: A Progress, which can cancel the work.
    Save and resume the original, because the result itself cannot be saved. Raises Cancelled, and
    LeaflightError if direct light is not exact or the texels belong to other volumes.
    """
    original = bake.original or bake
    progress = progress or _core.Progress()
    isovalues = original.isovalues if isovalues is None else isovalues
    volumes = as_volumes(volumes)
    if len(volumes) != len(original.volumes):
        raise LeaflightError(
            f"The bake has {len(original.volumes)} volumes, but the scene has {len(volumes)}: "
            "bake again."
        )
    volumes, description, isovalue_range = placed(volumes, scene, isovalues)
    texels = bake if _has_other_values(bake, original) else original
    _check(texels, volumes, description, isovalue_range)
    volumes = [_as_before(*pair) for pair in zip(volumes, texels.volumes)]
    result = replace(
        original,
        volumes=volumes,
        scene=description,
        walls=None,
        provenance=_provenance(texels, volumes, description),
        original=original,
    )
    now = result.core_scene()
    progress.begin("Direct light")
    detail = QUICK if quick else WHOLE
    factor = _growth(result)
    lights_alone = _lights_alone_moved(result)
    grids = [
        _grid(result, now, number, grid, detail, factor, lights_alone, progress)
        for number, grid in enumerate(texels.grids)
    ]
    known = result.provenance
    known = known.after(grids, known.passes, known.blocks, known.continued)
    result = replace(result, grids=grids, provenance=known)
    return lit_walls(result, detail, progress) if walls else result


def lit_walls(bake: Bake, detail: Detail, progress: _core.Progress) -> Bake:
    """Adds the walls of the original to a bake that moved() made without. Raises Cancelled."""
    original = bake.original
    assert original is not None
    if original.walls is None:
        return bake
    progress.begin("Shadows on walls")
    same_as = _same_meshes(original.scene.meshes, bake.scene.meshes)
    before, now = original.core_scene(), bake.core_scene()
    walls = original.walls.moved(
        before, now, same_as, _growth(bake), progress, detail.share, _lights_alone_moved(bake)
    )
    return replace(bake, walls=walls)


def _check(
    bake: Bake,
    volumes: Sequence[Volume],
    description: SceneDescription,
    isovalue_range: tuple[float, float],
) -> None:
    before, now = bake.scene.isosurfaces, description.isosurfaces
    if bake.factors is not None:
        raise LeaflightError(
            "This bake has other values and other lamps: give with_values() the bake as baked."
        )
    if not can_be_relit(bake.original or bake, diffuse_alone=True):
        raise LeaflightError(
            "This bake has no exact direct light, so objects cannot move in it: bake to a target "
            "error, and several volumes only on fronts, or bake again after each move."
        )
    same = isovalue_range == bake.isovalues
    if not same or any(a.isovalues != b.isovalues for a, b in zip(before, now) if len(now) > 1):
        raise LeaflightError("The isovalue range has changed since the bake: bake again.")
    if any(a.scattering != b.scattering for a, b in zip(before, now)):
        raise LeaflightError("The material of a volume has changed since the bake: bake again.")
    records = bake.provenance.volumes
    for volume, baked, record in zip(volumes, bake.volumes, records):
        same_array = volume.values is baked.values
        if not same_array and values_sha256(volume) != record.values_sha256:
            raise LeaflightError(
                f"{volume.name}: its values have changed since the bake: bake again."
            )


def _has_other_values(bake: Bake, original: Bake) -> bool:
    """Returns True for a bake of with_values()."""
    records = zip(bake.provenance.volumes, original.provenance.volumes)
    return any(one.values_sha256 != other.values_sha256 for one, other in records)


def _as_before(volume: Volume, baked: Volume) -> Volume:
    """Returns the baked Volume if it has not moved, because its field is in memory."""
    return baked if (volume.index_to_world == baked.index_to_world).all() else volume


def _provenance(bake: Bake, volumes: Sequence[Volume], description: SceneDescription) -> Provenance:
    records = tuple(
        replace(record, index_to_world=frozen(volume.index_to_world.tolist()))
        for record, volume in zip(bake.provenance.volumes, volumes)
    )
    scene = scene_to_json(description)
    # `continued` distinguishes it from a bake of that scene.
    return replace(bake.provenance, volumes=records, scene=scene, continued=bake.id)


def _growth(bake: Bake) -> tuple[float, ...]:
    """Returns (r, g, b): the light that returns to isosurfaces, relative to the original."""
    assert bake.original is not None
    before, after = bake.original.indirect_shares.total, bake.indirect_shares.total
    return tuple(b / a if a > 0 else 1.0 for a, b in zip(before, after))


def _grid(
    bake: Bake,
    scene: _core.Scene,
    number: int,
    grid: _core.RadianceGrid,
    detail: Detail,
    factor: Sequence[float],
    lights_alone: bool,
    progress: _core.Progress,
) -> _core.RadianceGrid:
    assert bake.original is not None
    volume, baked = bake.volumes[number], bake.original.volumes[number]
    grid = grid.with_texture(bake.scene.isosurfaces[number].texture_on(volume.field()))
    earlier = bake.original.grids[number]
    if not earlier.map_resolution:
        # Mirrors and glass store no light.
        return grid
    resolution = resolution_on(volume, baked, earlier.map_resolution)
    if earlier.direct and resolution != list(earlier.map_resolution):
        low, high = (bake.isovalue_of(number, c) for c in bake.isovalues)
        points = len(earlier.direct.light_points)
        resolution = _core.map_resolution(volume.field(), (low, high), resolution, points)
    direct = _core.DirectLight(
        scene,
        number,
        [max(2, (n - 1) // detail.wider + 1) for n in resolution],
        grid.has_back,
        progress,
        detail.spacing,
        earlier.direct if lights_alone else None,
    )
    return grid.moved(volume.field(), direct, factor)


def _lights_alone_moved(bake: Bake) -> bool:
    """Returns True if the scenes differ in nothing but their lamps."""
    assert bake.original is not None
    before, now = (
        {**json.loads(each.provenance.scene), "lights": []} for each in (bake.original, bake)
    )
    return before == now and all(a is b for a, b in zip(bake.original.volumes, bake.volumes))


def _same_meshes(before: Sequence[Mesh], now: Sequence[Mesh]) -> list[int]:
    """Returns, for each mesh now, the number of the mesh before with its name and size, or -1."""
    known = {(mesh.name, len(mesh.triangles)): number for number, mesh in enumerate(before)}
    return [known.get((mesh.name, len(mesh.triangles)), -1) for mesh in now]
