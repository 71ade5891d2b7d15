# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the walls of a web page.

Walls with baked light have indirect light at several common isovalues. Their light paths give
direct light at any isovalue (web/src/wall_light.ts). The page shades the other walls.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..bake.baked import Bake
from ..stills.walls import RoomMesh, room_meshes
from .shared_exponent import packed
from .visibility_levels import code_of

if TYPE_CHECKING:
    from .page_data import PageData


def walls_data(data: "PageData", bake: Bake) -> dict[str, Any]:
    """Returns the part of a page's header about the walls; adds their blocks to the PageData."""
    nodes: list[float] = []
    tints: list[Any] = []
    lights: list[int] = []
    strengths: Array | None = None
    if bake.walls is not None and bake.scene.meshes:
        nodes = list(bake.walls.nodes)
        amounts = bake.walls.point_amounts
        strengths = amounts.max(axis=-1)
        tints = (amounts / np.maximum(strengths[..., None], 1e-30)).tolist()
        lights = bake.walls.point_lights.tolist()
    meshes = [_wall(data, bake, strengths, mesh) for mesh in room_meshes(bake)]
    return {"nodes": nodes, "tints": tints, "lights": lights, "meshes": meshes}


def _wall(data: "PageData", bake: Bake, strengths: Array | None, mesh: RoomMesh) -> dict[str, Any]:
    return {
        "name": bake.scene.meshes[mesh.number].name,
        "isOfRoom": mesh.is_of_room,
        "albedo": mesh.albedo.tolist(),
        "emission": mesh.emission.tolist(),
        "vertices": data.add(mesh.vertices.astype(np.float32)),
        "triangles": data.add(mesh.triangles.astype(np.uint32)),
        "light": None if strengths is None else _light(data, bake, strengths, mesh.number),
    }


def _light(data: "PageData", bake: Bake, strengths: Array, number: int) -> dict[str, Any]:
    radiance, exposure = bake.walls, np.float32(bake.scene.exposure)
    assert radiance is not None

    def colors(light: Array) -> int | None:
        return data.add_colors(packed(light * exposure)) if light.any() else None

    sets, least, greatest, shares, *unshadowed = radiance.direct_ways(number)
    return {
        "between": data.add(radiance.between(number)),
        "indirect": [colors(radiance.indirect(number, back)) for back in (False, True)],
        "unshadowed": [[colors(light) for light in side] for side in unshadowed],
        "sets": data.add(sets),
        "least": None if least is None else data.add(codes(least, bake.isovalues).T),
        "greatest": data.add(codes(greatest, bake.isovalues).T),
        "weights": data.add(weights(shares * strengths[sets]).T),
    }


def codes(greatest: Array, isovalue_range: Sequence[float]) -> Array:
    """Returns common isovalues as bytes: 1 to 253 over the range, rounded down.

    A value below the range is 0, above it 254, and infinity 255.
    """
    found = np.clip(np.floor(code_of(greatest, isovalue_range)), 0, 254)
    return np.where(np.isposinf(greatest), 255, found).astype(np.uint8)


def weights(lights: Array) -> Array:
    """Returns lights (n, points) as int8: over the greatest of a row and side, times 127.

    The front is positive.
    """
    sides = [np.maximum(sign * lights, 0.0) for sign in (1.0, -1.0)]
    front, back = (
        side / np.maximum(side.max(axis=1, keepdims=True, initial=0), 1e-30) for side in sides
    )
    found: Array = np.rint(127.0 * (front - back)).astype(np.int8)
    return found
