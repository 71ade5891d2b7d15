# SPDX-License-Identifier: GPL-3.0-or-later
"""The web page without a bake, and the size of one with a bake, estimated from samples of it."""

import math
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from .._core import DirectLight, LeaflightError, Progress
from ..arrays import Array
from ..bake.baked import Bake
from ..paths import AnyPath
from ..stills.still import back_side
from .page_data import PageData, by_significance
from .page_volume import NO_DATA, bytes_each, coded, colors_data, dims_of, texel_places, texels_of
from .page_walls import walls_data
from .shared_exponent import packed, planes
from .visibility_levels import code_of, pairs_in, ranges_in_plane

# The page without a bake, which web/bundle.mjs builds as a part of the package.
TEMPLATE = Path(__file__).parent.parent / "page" / "page.html"
# Sample sizes: bytes of an array, and planes of a volume.
_SAMPLE, _PLANES = 1 << 18, 4
# Bytes of the first picture of a page.
_POSTER = 75_000
# Characters of base64 for a byte.
_TEXT = 4.0 / 3.0


def read_template(path: AnyPath) -> str:
    """Returns the page without a bake. Raises LeaflightError for path if it is missing."""
    try:
        return TEMPLATE.read_text(encoding="utf-8")
    except OSError:
        raise LeaflightError(
            f"{path}: this installation was built without Node, so it cannot write web pages: "
            "install a wheel of Leaflight, or build it with scripts/setup."
        ) from None


def estimated_bytes(bake: Bake, coarser: int = 0) -> float:
    """Returns the approximate size of a page in bytes: within a fifth, if it is not coarser.

    coarser: As for export_page().
    """
    total = _POSTER + _bytes_of_colors_and_walls(bake)
    for number, grid in enumerate(bake.grids):
        texels, dims = texels_of(bake, number, coarser), dims_of(bake, number, coarser)
        lit = _lit_texels(grid.mask() != 0, texels)
        light, maps, values = bytes_each(bake, number)
        total += lit * light * _share_of_light(bake, number)
        total += _lit_maps(grid.direct, lit, coarser) * maps * _share_of_maps(bake, number)
        total += math.prod(dims) * values * _share_of_values(bake, number)
    template = TEMPLATE.stat().st_size if TEMPLATE.exists() else 0
    return template + _TEXT * total


def _lit_texels(lit: Array, texels: Sequence[int]) -> float:
    """Returns the number of coarser texels (x, y, z) with light, which spreads by one texel."""
    if lit.shape == tuple(texels[::-1]):
        return float(lit.sum())
    for axis, count in enumerate(texels[::-1]):
        starts = np.arange(count) * lit.shape[axis] // count
        lit = np.logical_or.reduceat(lit, starts, axis=axis)
    for axis in range(3):
        ends = np.take(lit, (0, -1), axis=axis)
        first, last = np.split(ends, 2, axis=axis)
        padded = np.concatenate([first, lit, last], axis=axis)
        count = lit.shape[axis]
        parts = [np.take(padded, range(k, k + count), axis=axis) for k in range(3)]
        lit = np.logical_or.reduce(parts)
    return float(lit.sum())


def _lit_maps(direct: DirectLight | None, lit: float, coarser: int) -> float:
    if direct is None or coarser:
        return lit
    return float((direct.mask() != 0).sum())


class _Sampled(PageData):
    """The data of a page whose size is estimated by deflating a part of each array."""

    bytes = 0.0

    def add(self, numbers: Array) -> int:
        raw = np.ascontiguousarray(numbers).reshape(-1)
        count = max(1, _SAMPLE // raw.itemsize)
        middle = max(0, (len(raw) - count) // 2)
        self.bytes += raw.nbytes * _deflated_share([raw[middle : middle + count]])
        return 0


def _bytes_of_colors_and_walls(bake: Bake) -> float:
    sampled = _Sampled(Progress())
    for number, volume in enumerate(bake.volumes):
        colors_data(sampled, bake, number, volume)
    walls_data(sampled, bake)
    return sampled.bytes


def _deflated_share(samples: list[Array]) -> float:
    """Returns the deflated size of arrays as a share of their bytes."""
    parts = [by_significance(np.ascontiguousarray(each)).tobytes() for each in samples]
    size = sum(map(len, parts))
    return sum(len(zlib.compress(part, 6)) for part in parts) / size if size else 0.0


def _planes_of(count: int) -> Iterator[int]:
    """Returns the numbers of evenly spaced planes."""
    yield from sorted({round(count * (k + 0.5) / _PLANES) for k in range(_PLANES)} - {count})


def _share_of_values(bake: Bake, number: int) -> float:
    values = np.asarray(bake.volumes[number].values)
    low, high = bake.volumes[number].field().range
    samples = []
    for z in _planes_of(len(values)):
        # Include the ends of the range, so that the codes equal those of the whole volume.
        plane = values[z : z + 2].copy()
        plane.flat[:2] = low, high
        samples.append(coded(plane)[0])
    return _deflated_share(samples)


def _share_of_light(bake: Bake, number: int) -> float:
    grid, volume = bake.grids[number], bake.volumes[number]
    exposure, samples = np.float32(bake.scene.exposure), []
    for z in _planes_of(grid.resolution[2]):
        places = texel_places(volume, grid.resolution, z)
        for back in (False, True) if back_side(bake, number) == "baked" else (False,):
            light = grid.lookup(volume.field(), places, back, bool(grid.map_resolution))
            colors = packed(light * exposure)
            samples.append(planes(colors[colors != 0]))
    return _deflated_share(samples)


def _share_of_maps(bake: Bake, number: int) -> float:
    """Returns the deflated share of the levels of the first light points, in planes of texels."""
    direct = bake.grids[number].direct
    if direct is None or len(direct.light_points) == 0:
        return 0.0
    volume = bake.volumes[number]
    codes, offset, scale = coded(np.asarray(volume.values))
    missing = NO_DATA if volume.field().masked else None

    def code(numbers: Array) -> Array:
        return code_of(offset + scale * numbers, direct.code_range)

    active, samples = direct.mask() != 0, []
    ends = np.cumsum([0, *active.sum(axis=(1, 2))])
    for z in _planes_of(len(active)):
        plane = ranges_in_plane(codes, missing, direct.resolution, code, z)
        least, greatest = (each[active[z]] for each in plane)
        samples.append(pairs_in(direct, least, greatest, slice(ends[z], ends[z + 1])))
    return _deflated_share(samples)
