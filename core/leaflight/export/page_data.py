# SPDX-License-Identifier: GPL-3.0-or-later
"""What a web page shows of a bake: numbers in blocks of bytes, and a header that tells of them.

The page reads it in web/src/bake.ts, which lists the names; the two change together.
"""

import math
import zlib
from dataclasses import asdict, dataclass, field

import numpy as np

from ..scene.scene import is_color
from ..still.camera import bounds_of, camera_around_bake
from ..still.lamps import lamps_of
from ..still.still import inner_side
from ..still.walls import lit_meshes
from ..version import __version__
from .light_bricks import light_bricks
from .shared_exponent import packed

# Of the header and the blocks; the page refuses another one.
FORMAT = 1
HISTOGRAM_BINS = 256
# How a coarser page is called, by how many times it was halved.
EVERY = ("every", "every 2nd", "every 4th", "every 8th")
# Finer levels are shown with texels of their width everywhere, up to so many.
MOST_FINER_TEXELS = 20_000_000
# Of 16 bits, where there are no data.
NO_DATA = 65535
# That are deflated before somebody may cancel.
STEP_BYTES = 1 << 22


@dataclass
class PageData:
    """header: a JSON object; its "blocks": [first byte, bytes, bytes when inflated] of body.

    progress: _core.Progress, which counts bytes before they are deflated.
    """

    progress: object
    header: dict = field(default_factory=dict)
    body: bytearray = field(default_factory=bytearray)

    def add(self, numbers):
        """Appends an array, deflated; returns the number of its block. Raises Cancelled."""
        # Bytes of like significance side by side deflate better.
        raw = np.ascontiguousarray(numbers)
        planes = np.ascontiguousarray(raw.reshape(-1).view(np.uint8).reshape(-1, raw.itemsize).T)
        first, deflate = len(self.body), zlib.compressobj(6)
        for begin in range(0, planes.nbytes, STEP_BYTES):
            self.progress.check()
            part = planes.data.cast("B")[begin : begin + STEP_BYTES]
            self.body += deflate.compress(part)
            self.progress.advance(len(part))
        self.body += deflate.flush()
        blocks = self.header.setdefault("blocks", [])
        blocks.append([first, len(self.body) - first, raw.nbytes])
        return len(blocks) - 1


def page_data(bake, isovalue, coarser, progress):
    """The PageData of a Bake; isovalue: the leaf coordinate that is shown at first.

    coarser: how many times voxels and texels are halved along each axis. progress:
    _core.Progress. Raises Cancelled.
    """
    data = PageData(progress)
    progress.begin("Values and light")
    progress.expect(sum(_raw_bytes(bake, number, coarser) for number in range(len(bake.volumes))))
    volumes = []
    for number in range(len(bake.volumes)):
        volumes.append(_volume(data, bake, number, coarser))
    lamps = lamps_of(bake.scene)
    low, high = bounds_of(bake)
    data.header.update(
        format=FORMAT,
        title=" and ".join(volume.name for volume in bake.volumes),
        window=list(bake.isovalues),
        isovalue=float(isovalue),
        exposure=bake.scene.exposure,
        camera=asdict(camera_around_bake(bake)),
        bounds=[low.tolist(), high.tolist()],
        volumes=volumes,
        walls=[_wall(data, bake, *mesh) for mesh in lit_meshes(bake)],
        lamps=lamps.rows.tolist(),
        ambient=lamps.ambient.tolist(),
        headlight=lamps.headlight,
        histogram=histogram(bake),
        about=about(bake, coarser),
    )
    return data


def histogram(bake):
    """How many voxels of the first volume have which value, in even bins over the window."""
    low, high = (bake.isovalue_of(0, c) for c in bake.isovalues)
    values = bake.volume.data()
    bins = HISTOGRAM_BINS
    if values.dtype.kind in "iu":
        # Narrower ones than a step of the values would be empty by turns.
        bins = int(np.clip(np.floor(high - low), 1, bins))
    counts, _ = np.histogram(values[np.isfinite(values)], bins, (low, high))
    return counts.tolist()


def about(bake, coarser):
    """[(what, its value as text)] of a bake."""
    known = bake.statistics
    rows = []
    for volume in bake.volumes:
        nx, ny, nz = volume.field().dims
        rows.append(("Volume", f"{volume.name}, {nx} x {ny} x {nz} voxels"))
    for grid in bake.grids:
        rows.append(("Texels", f"{' x '.join(map(str, grid.resolution))}, {grid.texels} lit"))
    if coarser:
        rows.append(("Shown here", f"{EVERY[coarser]} voxel along each axis"))
    lo, hi = bake.isovalues
    rows.append(("Isovalues lit", f"{lo:g} to {hi:g}"))
    rows.append(("Scene", bake.scene.name))
    error = known.get("estimated_error_percent")
    if error:
        rows.append(("Error of the bake", f"{error:.2g} % of the displayable range, estimated"))
    worst = known.get("worst_error_percent")
    if worst:
        rows.append(("Greatest error", f"{worst:.2g} %, at isovalue {known['worst_isovalue']:g}"))
    rows.append(("Bake", f"{known['seconds']:.3g} s, {known['rays']:.3g} rays"))
    rows.append(("Bake's id", bake.id))
    rows.append(("Made with", f"Leaflight {__version__}"))
    return rows


def shown_volume(bake, number, coarser):
    """The Volume, one of a Bake's or a coarser one, that a page shows."""
    volume = bake.volumes[number]
    for _ in range(coarser):
        volume = volume.coarser()
    return volume


def dims_of(bake, number, coarser):
    """Voxels along x, y and z of shown_volume(), without making it."""
    return tuple(n >> coarser for n in bake.volumes[number].field().dims)


def texels_of(bake, number, coarser):
    """Texels along x, y and z of the light that a page shows: of the finest level of the bake that
    is not too much for a browser."""
    if coarser:
        return dims_of(bake, number, coarser)
    grid = bake.grids[number]
    for level in range(grid.levels - 1, 0, -1):
        finer = tuple((n - 1) * 2**level + 1 for n in grid.resolution)
        if math.prod(finer) <= MOST_FINER_TEXELS:
            return finer
    return tuple(grid.resolution)


def _volume(data, bake, number, coarser):
    volume, leaves = shown_volume(bake, number, coarser), bake.scene.leaves[number]
    codes, offset, scale = coded(np.asarray(volume.values))
    inner = inner_side(bake, number)
    exposure = np.float32(bake.scene.exposure)
    resolution = texels_of(bake, number, coarser)
    sides = [
        packed(_light(bake, number, volume, resolution, back, data.progress) * exposure)
        for back in ((False, True) if inner == "baked" else (False,))
    ]
    bricks = light_bricks(np.logical_or.reduce([side != 0 for side in sides]))
    blocks = [data.add(bricks.gather(side)) for side in sides]
    return {
        "name": volume.name,
        "dims": list(volume.field().dims),
        "indexToWorld": np.asarray(volume.index_to_world, np.float64).ravel().tolist(),
        "isovalues": [bake.isovalue_of(number, c) for c in (0.0, 1.0)],
        "values": data.add(codes),
        "bits": 8 * codes.itemsize,
        "masked": bool(volume.field().masked),
        "offset": offset,
        "scale": scale,
        "texels": list(resolution),
        "brick": list(bricks.brick),
        "bricks": list(bricks.table.shape[2::-1]),
        "table": data.add(bricks.table),
        "textureBricks": list(bricks.shape),
        "outer": blocks[0],
        "inner": blocks[1] if inner == "baked" else None,
        "innerIs": inner,
        "albedo": _stops(leaves.albedo),
        "emission": _stops(leaves.emission),
    }


def coded(values):
    """(codes uint8 or uint16, offset, scale): a value is offset + scale * code.

    Exact for integers that span 16 bits; else to 1/65534 of the range, NaN being NO_DATA.
    """
    if values.dtype == np.uint8:
        return values, 0.0, 1.0
    if values.dtype.kind in "iu":
        low = int(values.min())
        span = int(values.max()) - low
        kind = np.uint8 if span <= 255 else np.uint16
        return (values.astype(np.int64) - low).astype(kind), float(low), 1.0
    known = np.isfinite(values)
    low, high = float(values[known].min()), float(values[known].max())
    scale = (high - low) / (NO_DATA - 1)
    codes = np.full(values.shape, NO_DATA, np.uint16)
    codes[known] = np.rint((values[known].astype(np.float64) - low) / scale)
    return codes, low, scale


def _light(bake, number, volume, resolution, back, progress):
    """Radiance float32 (nz, ny, nx, 3) at texels evenly spaced from the first voxel to the last."""
    grid = bake.grids[number]
    if volume is bake.volumes[number] and tuple(grid.resolution) == tuple(resolution):
        return grid.dense("radiance_back" if back else "radiance")
    field = bake.volumes[number].field()
    step = (np.array(volume.field().dims) - 1.0) / (np.array(resolution) - 1.0)
    texel_to_world = np.asarray(volume.index_to_world) @ np.diag([*step, 1.0])
    nx, ny, nz = resolution
    y, x = np.mgrid[:ny, :nx]
    planes = []
    for z in range(nz):
        progress.check()
        texels = np.stack([x, y, np.full_like(x, z), np.ones_like(x)], axis=-1).reshape(-1, 4)
        planes.append(grid.lookup(field, (texels @ texel_to_world.T)[:, :3], back))
    light = np.stack(planes).reshape(nz, ny, nx, 3)
    # A coarser isosurface is not quite where the one that was lit is.
    return light if volume is bake.volumes[number] else spread(light)


def spread(light):
    """The light (nz, ny, nx, 3), dark texels having the mean of their neighbours that are lit."""
    lit = light.any(axis=-1)
    sums, counts = light * lit[..., None], lit.astype(np.float32)
    for axis in range(3):
        sums, counts = _of_three(sums, axis), _of_three(counts, axis)
    filled = sums / np.maximum(counts, 1.0)[..., None]
    return np.where(lit[..., None], light, filled).astype(np.float32)


def _of_three(array, axis):
    total = array.copy()
    before = [slice(None)] * array.ndim
    after = list(before)
    before[axis], after[axis] = slice(None, -1), slice(1, None)
    total[tuple(after)] += array[tuple(before)]
    total[tuple(before)] += array[tuple(after)]
    return total


def _wall(data, bake, number, vertices, triangles, is_of_room):
    nodes, exposure = bake.surroundings.nodes, np.float32(bake.scene.exposure)
    sides = []
    for back in (False, True):
        light = np.stack([bake.surroundings.radiance(number, c, back=back) for c in nodes])
        sides.append(data.add(packed(light * exposure)) if light.any() else None)
    return {
        "name": bake.scene.meshes[number].name,
        "isOfRoom": is_of_room,
        "vertices": data.add(vertices.astype(np.float32)),
        "triangles": data.add(triangles.astype(np.uint32)),
        "nodes": list(nodes),
        "outer": sides[0],
        "inner": sides[1],
    }


def _stops(ramp):
    """A ramp as [[isovalue, [r, g, b]], ...]."""
    if is_color(ramp):
        return [[0.0, list(ramp)]]
    return [[float(isovalue), list(map(float, color))] for isovalue, color in ramp]


def estimated_bytes(bake, coarser=0):
    """About how large the file of a page will be: of texels three of four bytes stay when deflated,
    and of values half; text holds six bits a byte."""
    parts = [_of_texels_and_voxels(bake, number, coarser) for number in range(len(bake.volumes))]
    return 4.0 / 3.0 * sum(3.0 / 4.0 * light + 0.5 * values for light, values in parts)


def _raw_bytes(bake, number, coarser):
    return sum(_of_texels_and_voxels(bake, number, coarser))


def _of_texels_and_voxels(bake, number, coarser):
    """About how many bytes the light of a volume takes, and its values, before they deflate."""
    grid = bake.grids[number]
    sides = 2 if inner_side(bake, number) == "baked" else 1
    share = 1.2 * grid.texels / math.prod(grid.resolution)
    texels = math.prod(texels_of(bake, number, coarser)) * min(1.0, share)
    bytes_a_voxel = 1 if np.asarray(bake.volumes[number].values).dtype == np.uint8 else 2
    return 4.0 * sides * texels, bytes_a_voxel * math.prod(dims_of(bake, number, coarser))
