# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes the strengths of the lamps of a bake, without a new bake.

Direct light is computed at lookup and scales exactly, lamp by lamp. All other light scales by one
factor per channel: the growth of the light that returns to isosurfaces after one reflection. This
is exact if one lamp, or all lamps alike, are changed and nothing else emits. Otherwise it is
approximate, because the distribution of indirect light changes, too.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..scene.lights import Color, Light, strengths_of
from ..scene.scene import Isosurfaces, Mesh, Ramp, is_color
from ..volume.regions import frozen

if TYPE_CHECKING:
    from .baked import Bake


def relit(bake: "Bake", lamps: Mapping[str, float | Sequence[float]]) -> "Bake":
    """Returns the Bake with lamps scaled by {name: factor or (r, g, b)}; see Bake.relit."""
    if bake.is_moved:
        raise LeaflightError(
            "The lamps of a bake in another scene cannot be changed: move its original, with the "
            "lamps as they are."
        )
    original = bake.original or bake
    factors = _factors(bake, lamps)
    if not can_be_relit(original):
        raise LeaflightError(
            "This bake has no exact direct light, so its lamps cannot be changed: bake diffuse "
            "volumes to a target error, and several volumes only on fronts, or bake again."
        )
    if factors == _as_baked(original):
        return original
    indirect = original.indirect_shares.factor(factors)
    scene = original.core_scene()
    grids = [
        grid.relit(volume.field(), factors, indirect)
        for grid, volume in zip(original.grids, original.volumes)
    ]
    walls = original.walls
    if walls is not None:
        walls = walls.relit(scene, factors, indirect)
    lights = [_scaled(light, by) for light, by in zip(original.scene.lights, factors)]
    return replace(
        original,
        scene=replace(original.scene, lights=lights),
        grids=grids,
        walls=walls,
        provenance=replace(original.provenance, lamps=frozen(factors)),
        original=original,
        factors=factors,
    )


def can_be_relit(bake: "Bake", diffuse_alone: bool = False) -> bool:
    """Returns True if the lamps can be changed: all direct light is exact.

    diffuse_alone: leaves out mirrors and glass, which store no light.
    """
    return all(
        grid.can_be_relit
        for grid, isosurfaces in zip(bake.grids, bake.scene.isosurfaces)
        if not diffuse_alone or isosurfaces.scattering == "diffuse"
    )


def indirect_by_lamp(bake: "Bake") -> Array:
    """Returns the share of each lamp in indirect light, float64 (lamps + 1, 3); the rows sum to 1.

    The factor of indirect light, by channel, is the last row plus a sum over the lamps. Each term
    is the row of the lamp times the factor on its present strength.
    """
    original, count = bake.original or bake, len(bake.scene.lights)
    now = np.array(bake.factors or _as_baked(bake), np.float64).reshape(count, 3)

    def factor(factors: Array) -> Array:
        return np.array(original.indirect_shares.factor([tuple(row) for row in factors]))

    others, each = factor(0.0 * now), np.eye(count)[:, :, None] * now
    rows = np.array([*(factor(one) - others for one in each), others])
    total = rows.sum(axis=0)
    return np.divide(rows, total, out=np.full_like(rows, 1.0 / len(rows)), where=total > 0)


def scales_exactly(bake: "Bake") -> bool:
    """Returns True if indirect light of a relit bake is exact: one factor for all emitters."""
    if bake.factors is None:
        return True
    others: list[Mesh | Isosurfaces] = [*bake.scene.meshes, *bake.scene.isosurfaces]
    glows = any(np.max(_colors(other.emission)) > 0 for other in others)
    world = bake.scene.environment is not None and max(bake.scene.environment.radiance) > 0
    return not glows and not world and len(set(bake.factors)) == 1


def _as_baked(bake: "Bake") -> tuple[Color, ...]:
    return ((1.0, 1.0, 1.0),) * len(bake.scene.lights)


def _factors(bake: "Bake", lamps: Mapping[str, float | Sequence[float]]) -> tuple[Color, ...]:
    names = [light.name for light in bake.scene.lights]
    for name in lamps:
        if name not in names:
            known = f"choose one of {', '.join(sorted(set(names)))}" if names else "it has no lamps"
            raise LeaflightError(f'The bake has no lamp "{name}": {known}.')
    changed = {name: _factor(name, factor) for name, factor in lamps.items()}
    return tuple(
        _times(before, changed.get(name, (1.0, 1.0, 1.0)))
        for name, before in zip(names, bake.factors or _as_baked(bake))
    )


def _factor(name: str, factor: Any) -> Color:
    by_channel = (factor,) * 3 if isinstance(factor, Real) else tuple(factor)
    numbers = all(isinstance(x, Real) for x in by_channel)
    if len(by_channel) != 3 or not numbers or not all(0 <= x < math.inf for x in by_channel):
        raise LeaflightError(
            f'The factor of the lamp "{name}" is {factor!r}: give a number of at least 0, or three '
            "for red, green and blue."
        )
    r, g, b = map(float, by_channel)
    return r, g, b


def _scaled(light: Light, factor: Color) -> Light:
    changes: dict[str, Any] = {light.STRENGTH: _times(strengths_of(light), factor)}
    return replace(light, **changes)


def _times(color: Color, factor: Color) -> Color:
    r, g, b = (x * y for x, y in zip(color, factor))
    return r, g, b


def _colors(ramp: Ramp) -> Array:
    return np.array([ramp] if is_color(ramp) else [stop[1] for stop in ramp])
