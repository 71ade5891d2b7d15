# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes one volume of a web page: values, light of texels, maps of direct light."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import leaflight._core as _core
import numpy as np

from ..arrays import Array
from ..bake.baked import Bake
from ..io.images import display_colors
from ..scene.scene import Ramp, core_scene, is_color
from ..stills.still import back_side
from ..volume.cuts import Ball, Box
from ..volume.volume import Volume
from .light_bricks import light_bricks
from .shared_exponent import packed
from .visibility_levels import POINTS_A_TEXEL, code_of, pairs, ranges

if TYPE_CHECKING:
    from .page_data import PageData

# Code of 16 bits for a voxel without data.
NO_DATA = 65535
# Largest number of colors of a texture with more of them than voxels.
MOST_COLORS = 1 << 22
# Largest number of flat cuts, because graphics cards have few uniforms. Later ones have dents.
MOST_CUTS = 8


@dataclass(frozen=True)
class ShownVolume:
    """A volume of a bake as a page shows it.

    volume: The volume of the bake, or a coarser one.
    texels: Texels along x, y and z.
    direct: The DirectLight to add to the light of texels. None if they contain it.
    """

    bake: Bake
    number: int
    volume: Volume
    texels: tuple[int, ...]
    direct: _core.DirectLight | None

    @property
    def is_coarser(self) -> bool:
        return self.volume is not self.bake.volumes[self.number]

    @property
    def sides(self) -> tuple[bool, ...]:
        """Sides of isosurfaces with light in the page; False is the front."""
        return (False, True) if back_side(self.bake, self.number) == "baked" else (False,)

    def has_maps(self, back: bool) -> bool:
        """Returns True if direct light is added to the texels of a side; else they hold it."""
        return self.direct is not None and (not back or self.direct.has_back)

    @property
    def raw_bytes(self) -> float:
        """Approximate number of bytes to deflate."""
        light, maps, values = bytes_each(self.bake, self.number)
        map_texels = self.direct.resolution if self.direct is not None else (0,)
        return (
            light * math.prod(self.texels)
            + maps * math.prod(map_texels)
            + values * math.prod(self.volume.field().dims)
        )


def shown_volume(bake: Bake, number: int, coarser: int, progress: _core.Progress) -> ShownVolume:
    """Returns the ShownVolume of a volume of a Bake, halved `coarser` times. Raises Cancelled."""
    volume, direct = bake.volumes[number], bake.grids[number].direct
    for _ in range(coarser):
        volume = volume.coarser()
    if coarser and direct is not None:
        # Coarser values have other isosurfaces and therefore other shadows.
        dims = volume.field().dims
        progress.begin("Direct light")
        fields = [each.field() for each in bake.volumes]
        fields[number] = volume.field()
        scene = core_scene(bake.scene, fields, bake.isovalues)
        has_back = bake.grids[number].has_back and len(bake.grids) == 1
        direct = _core.DirectLight(scene, number, dims, has_back, progress)
    return ShownVolume(bake, number, volume, texels_of(bake, number, coarser), direct)


def dims_of(bake: Bake, number: int, coarser: int) -> tuple[int, ...]:
    """Returns the voxels along x, y and z of the volume that is shown, without making it."""
    dims = tuple(bake.volumes[number].field().dims)
    for _ in range(coarser):
        dims = tuple(n // 2 + 1 for n in dims)
    return dims


def texels_of(bake: Bake, number: int, coarser: int) -> tuple[int, ...]:
    """Returns the texels along x, y and z of the light that a page shows."""
    return dims_of(bake, number, coarser) if coarser else tuple(bake.grids[number].resolution)


def volume_data(data: "PageData", shown: ShownVolume) -> dict[str, Any]:
    """Returns the part of a page's header about a ShownVolume; adds its blocks to the PageData."""
    bake, number, volume = shown.bake, shown.number, shown.volume
    isosurfaces, field = bake.scene.isosurfaces[number], volume.field()
    codes, offset, scale = coded(np.asarray(volume.values))
    return {
        "name": volume.name,
        "dims": list(field.dims),
        "indexToWorld": np.asarray(volume.index_to_world, np.float64).ravel().tolist(),
        "isovalues": [bake.isovalue_of(number, c) for c in (0.0, 1.0)],
        "values": data.add(codes),
        "bits": 8 * codes.itemsize,
        "masked": bool(field.masked),
        "smoothNormals": volume.smooth_normals,
        "layers": volume.layers,
        "offset": offset,
        "scale": scale,
        "light": _light_data(data, shown),
        "direct": _direct_data(data, shown, codes, offset, scale),
        "backIs": back_side(bake, number),
        "albedo": _stops(isosurfaces.albedo),
        "emission": _stops(isosurfaces.emission),
        "texture": colors_data(data, bake, number, volume),
        "cuts": cuts_data(volume, offset, scale),
    }


def cuts_data(volume: Volume, offset: float, scale: float) -> dict[str, Any] | None:
    """Returns the part of the header about the flat capped cuts, or None. Balls are not flat."""
    cuts = volume.cuts
    flat = [cut for cut in cuts.cuts if not isinstance(cut, Ball)] if cuts is not None else []
    if cuts is None or not flat:
        return None
    flat = flat[:MOST_CUTS]
    slabs = np.concatenate([cut.slabs for cut in flat])
    return {
        "range": [(value - offset) / scale for value in (cuts.low, cuts.high)],
        "slabs": slabs[:, :4].tolist(),
        "halfWidths": slabs[:, 4].tolist(),
        "keeps": [-1 if isinstance(cut, Box) and cut.keep == "outside" else 1 for cut in flat],
    }


def colors_data(data: "PageData", bake: Bake, number: int, volume: Volume) -> dict[str, Any] | None:
    """Returns the part of the header about the colors of another volume, or None.

    volume: The volume of that number, perhaps with fewer voxels.
    """
    texture = bake.scene.isosurfaces[number].texture
    # Texels of fixed samples hold the color.
    if texture is None or bake.provenance.fixed is not None:
        return None
    dims = np.array(texture.channels[0].values.shape[::-1])
    # The page interpolates colors, the bake the values. Finer nodes make both nearly equal.
    fineness = 1 if texture.nearest else int(np.clip(np.cbrt(MOST_COLORS / dims.prod()), 1, 4))
    nodes = fineness * (dims - 1) + 1
    # Coordinates of the texture are 0 and 1 half a node outside the outer nodes.
    to_unit = np.diag([*(fineness / nodes), 1.0])
    to_unit[:3, 3] = 0.5 / nodes
    to_voxels = np.linalg.inv(np.asarray(texture.channels[0].index_to_world, np.float64))
    return {
        "nodes": nodes.tolist(),
        "colors": data.add(display_colors(texture.colors_of_nodes(fineness), 1.0)),
        "fromIndex": (to_unit @ to_voxels @ volume.index_to_world).ravel().tolist(),
        "margin": (0.5 * (fineness - 1) / nodes).tolist(),
        "nearest": texture.nearest,
    }


def coded(values: Array) -> tuple[Array, float, float]:
    """Returns (codes uint8 or uint16, offset, scale): a value is offset + scale * code.

    The codes are exact for integers that span 16 bits, else to 1/65534 of the range. NaN is
    NO_DATA.
    """
    if values.dtype == np.uint8:
        return values, 0.0, 1.0
    if values.dtype.kind in "iu":
        least = int(values.min())
        span = int(values.max()) - least
        kind = np.uint8 if span <= 255 else np.uint16
        return (values.astype(np.int64) - least).astype(kind), float(least), 1.0
    known = np.isfinite(values)
    low, high = float(values[known].min()), float(values[known].max())
    scale = (high - low) / (NO_DATA - 1)
    codes = np.full(values.shape, NO_DATA, np.uint16)
    codes[known] = np.rint((values[known].astype(np.float64) - low) / scale)
    return codes, low, scale


def _light_data(data: "PageData", shown: ShownVolume) -> dict[str, Any]:
    """Returns the part of the header about the light of texels.

    The layers of texels on the cap of a flat cut follow above the others, along z.
    """
    exposure = np.float32(shown.bake.scene.exposure)
    offset, scale = coded(np.asarray(shown.volume.values))[1:]
    caps = shown.bake.grids[shown.number].cap_layers
    if cuts_data(shown.volume, offset, scale) is None or not shown.has_maps(False):
        caps = None
    count, first, step = caps or (0, 0.0, 1.0)
    sides = []
    for back in shown.sides:
        parts = [_light(shown, back, data.progress)]
        parts += [_layer(shown, back, layer) for layer in range(count)]
        sides.append(packed(np.concatenate(parts) * exposure))
    lit = np.logical_or.reduce([side != 0 for side in sides])
    found = _texture(data, lit, 1, [data.add_colors(side[lit]) for side in sides])
    found["layers"] = [count, (first - offset) / scale, step / scale]
    return found


def _direct_data(
    data: "PageData", shown: ShownVolume, codes: Array, offset: float, scale: float
) -> dict[str, Any] | None:
    """Returns the part of the header about the maps, or None. The page computes the same ranges."""
    direct = shown.direct
    if direct is None or len(direct.light_points) == 0:
        return None
    missing = NO_DATA if shown.volume.field().masked else None

    def code(numbers: Array) -> Array:
        return code_of(offset + scale * numbers, direct.code_range)

    active = direct.mask() != 0
    least, greatest = (each[active] for each in ranges(codes, missing, direct.resolution, code))
    sides = []
    for is_back in filter(shown.has_maps, shown.sides):
        about = (254 - greatest, 254 - least) if is_back else (least, greatest)
        sides.append([data.add(each) for each in pairs(direct, is_back, *about)])
    layers = len(sides) * -(-len(direct.light_points) // POINTS_A_TEXEL)
    return {
        **_texture(data, active, layers, sides),
        "codeRange": [(value - offset) / scale for value in direct.code_range],
        "points": direct.light_points.reshape(-1, 16).tolist(),
        "lights": direct.lights.tolist(),
        "indexToFrame": direct.index_to_frame.ravel().tolist(),
    }


def _texture(
    data: "PageData", active: Array, layers: int, sides: Sequence[int] | Sequence[list[int]]
) -> dict[str, Any]:
    """Returns the part of the header about a texture of texels.

    active: True for stored texels, bool [z, y, x]. sides: The block, or blocks, of each side.
    """
    bricks = light_bricks(active, layers)
    return {
        "texels": list(active.shape[::-1]),
        "active": data.add(np.packbits(active, bitorder="little")),
        "brick": list(bricks.brick),
        "bricks": list(bricks.table.shape[2::-1]),
        "table": data.add(bricks.table),
        "textureBricks": list(bricks.shape),
        "front": sides[0],
        "back": sides[1] if len(sides) > 1 else None,
    }


def _light(shown: ShownVolume, back: bool, progress: _core.Progress) -> Array:
    """Returns radiance, float32 (nz, ny, nx, 3), at texels evenly spaced between outer voxels."""
    # The page multiplies the light by the texture.
    grid = shown.bake.grids[shown.number].with_texture(None)
    field = shown.bake.volumes[shown.number].field()
    is_indirect = shown.has_maps(back)
    if not shown.is_coarser:
        name = "radiance_back" if back else "radiance"
        return grid.dense(f"{name}_indirect" if is_indirect else name)
    planes = []
    for z in range(shown.texels[2]):
        progress.check()
        points = texel_places(shown.volume, shown.texels, z)
        planes.append(grid.lookup(field, points, back, is_indirect))
    light = np.stack(planes).reshape(*shown.texels[::-1], 3)
    # Fill dark texels, because a coarser isosurface lies slightly beside the lit one.
    return spread(light)


def _layer(shown: ShownVolume, back: bool, layer: int) -> Array:
    """Returns the light of a layer of the texels on caps, as _light()."""
    name = "radiance_back" if back else "radiance"
    grid = shown.bake.grids[shown.number].with_texture(None)
    light = grid.dense(f"{name}_indirect" if shown.has_maps(back) else name, layer)
    if not shown.is_coarser:
        return light
    lit = light.any(axis=-1, keepdims=True).astype(np.float32)
    for axis, count in enumerate(shown.texels[::-1]):
        light, lit = _resampled(light, axis, count), _resampled(lit, axis, count)
    return spread(light / np.maximum(lit, 1e-6))


def _resampled(array: Array, axis: int, count: int) -> Array:
    """Interpolates an array at `count` places along an axis, from its first to its last."""
    places = np.linspace(0.0, array.shape[axis] - 1.0, count)
    below = np.minimum(places.astype(int), array.shape[axis] - 2)
    shape = [-1 if a == axis else 1 for a in range(array.ndim)]
    share = (places - below).astype(np.float32).reshape(shape)
    found: Array = array.take(below, axis) * (1 - share) + array.take(below + 1, axis) * share
    return found


def texel_places(volume: Volume, texels: Sequence[int], z: int) -> Array:
    """Returns world coordinates (ny nx, 3) of a plane of texels (x, y, z) that span a volume."""
    step = (np.array(volume.field().dims) - 1.0) / (np.array(texels) - 1.0)
    texel_to_world = np.asarray(volume.index_to_world) @ np.diag([*step, 1.0])
    y, x = np.mgrid[: texels[1], : texels[0]]
    places = np.stack([x, y, np.full_like(x, z), np.ones_like(x)], axis=-1).reshape(-1, 4)
    found: Array = (places @ texel_to_world.T)[:, :3]
    return found


def spread(light: Array) -> Array:
    """Returns the light (nz, ny, nx, 3). Dark texels get the mean of their lit neighbors."""
    lit = light.any(axis=-1)
    sums, counts = light * lit[..., None], lit.astype(np.float32)
    for axis in range(3):
        sums, counts = _of_three(sums, axis), _of_three(counts, axis)
    filled = sums / np.maximum(counts, 1.0)[..., None]
    return np.where(lit[..., None], light, filled).astype(np.float32)


def _of_three(array: Array, axis: int) -> Array:
    total = array.copy()
    before = [slice(None)] * array.ndim
    after = list(before)
    before[axis], after[axis] = slice(None, -1), slice(1, None)
    total[tuple(after)] += array[tuple(before)]
    total[tuple(before)] += array[tuple(after)]
    return total


def _stops(ramp: Ramp) -> list[list[Any]]:
    """Returns a ramp as [[isovalue, [r, g, b]], ...]."""
    if is_color(ramp):
        return [[0.0, list(ramp)]]
    return [[float(isovalue), list(map(float, color))] for isovalue, color in ramp]


def bytes_each(bake: Bake, number: int) -> tuple[float, float, float]:
    """Returns the bytes of the light of a texel, of its maps, and of a voxel, before deflation."""
    direct = bake.grids[number].direct
    sides = 2 if back_side(bake, number) == "baked" else 1
    bytes_a_voxel = 1 if np.asarray(bake.volumes[number].values).dtype == np.uint8 else 2
    maps = -(-len(direct.light_points) // 2) if direct else 0
    return 4.0 * sides, float(sides * maps), float(bytes_a_voxel)
