# SPDX-License-Identifier: GPL-3.0-or-later
"""The data of a web page: numbers in blocks of bytes, and a header that describes them.

The page reads it in web/src/bake.ts, which lists the names; the two change together.
"""

import math
import zlib
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from .._core import Progress
from ..arrays import Array
from ..bake.baked import Bake
from ..bake.relit import can_be_relit, indirect_by_lamp
from ..color_maps import MAPS
from ..io.images import display_colors
from ..looks import LOOKS
from ..scene.lights import strengths_of
from ..scene.color_bar import captions_of, color_bar_of
from ..stills.camera import bounds_of
from ..stills.first_view import FILLED, framing
from ..stills.lamps import lamps_of
from ..stills.photograph import metered_stops
from ..stills.still import UNBAKED, back_side
from ..version import __version__
from ..words import figures
from .histogram import histogram
from .page_volume import shown_volume, volume_data
from .page_walls import walls_data
from .shared_exponent import planes

# Version of the header and the blocks; the page refuses any other.
FORMAT = 8
# Names of coarser pages, by the number of halvings.
EVERY = ("every", "every 2nd", "every 4th", "every 8th")
# Bytes to deflate between two checks for a cancel.
STEP_BYTES = 1 << 22


@dataclass
class PageData:
    """The header and the body of a page.

    header: A JSON object. Its "blocks" are [first byte, bytes, bytes when inflated] of body.
    progress: A _core.Progress, which counts bytes before they are deflated.
    """

    progress: Progress
    header: dict[str, Any] = field(default_factory=dict)
    body: bytearray = field(default_factory=bytearray)

    def add(self, numbers: Array) -> int:
        """Appends an array, deflated; returns the number of its block. Raises Cancelled."""
        raw = np.ascontiguousarray(numbers)
        parted = by_significance(raw)
        first, deflate = len(self.body), zlib.compressobj(6)
        for begin in range(0, parted.nbytes, STEP_BYTES):
            self.progress.check()
            part = parted.data.cast("B")[begin : begin + STEP_BYTES]
            self.body += deflate.compress(part)
            self.progress.advance(len(part))
        self.body += deflate.flush()
        blocks = self.header.setdefault("blocks", [])
        blocks.append([first, len(self.body) - first, raw.nbytes])
        return len(blocks) - 1

    def add_colors(self, words: Array) -> int:
        """Appends packed() colors, deflated; returns the number of their block.

        Raises Cancelled.
        """
        return self.add(planes(words))


def by_significance(raw: Array) -> Array:
    """Returns bytes uint8 (itemsize, n), sorted by significance, which deflate better."""
    return np.ascontiguousarray(raw.reshape(-1).view(np.uint8).reshape(-1, raw.itemsize).T)


def page_data(bake: Bake, isovalue: float, coarser: int, progress: Progress) -> PageData:
    """Returns the PageData of a Bake. Raises Cancelled.

    isovalue: Common isovalue that is shown at first.
    coarser: Number of times that voxels and texels are halved along each axis.
    progress: A _core.Progress.
    """
    data = PageData(progress)
    numbers = range(len(bake.volumes))
    shown = [shown_volume(bake, number, coarser, progress) for number in numbers]
    progress.begin("Values and light")
    progress.expect(sum(each.raw_bytes for each in shown))
    lamps = lamps_of(bake.scene)
    low, high = bounds_of(bake)
    data.header.update(
        format=FORMAT,
        title=" and ".join(volume.name for volume in bake.volumes),
        isovalueRange=list(bake.isovalues),
        isovalue=float(isovalue),
        exposure=bake.scene.exposure,
        stops=metered_stops(bake),
        unbaked=UNBAKED,
        camera={**asdict(framing(bake, isovalue)), "filled": FILLED},
        bounds=[low.tolist(), high.tolist()],
        volumes=[volume_data(data, each) for each in shown],
        walls=walls_data(data, bake),
        lights=lights_data(bake),
        lamps=[[int(k), *row] for k, row in zip(lamps.lights, lamps.rows.tolist())],
        ambient=lamps.ambient.tolist(),
        headlight=lamps.headlight,
        histogram=histogram(bake),
        step=step_of(bake),
        unit=bake.volumes[0].unit,
        unitLength=1.0,
        isPatient=any(volume.patient for volume in bake.volumes),
        colorMaps={key: [name, *colors] for key, (name, _, colors) in MAPS.items()},
        colorBars=color_bars_data(bake),
        looks={key: asdict(look) for key, look in LOOKS.items()},
        about=about(bake, coarser),
    )
    return data


def lights_data(bake: Bake) -> dict[str, Any]:
    """Returns the lamps of a bake whose strengths the page can change: all or none."""
    if bake.is_moved or not can_be_relit(bake.original or bake):
        return {"lamps": [], "others": [1.0, 1.0, 1.0]}
    *shares, others = indirect_by_lamp(bake).tolist()
    lamps = [
        {"name": light.name, "color": list(strengths_of(light)), "share": share}
        for light, share in zip(bake.scene.lights, shares)
    ]
    return {"lamps": lamps, "others": others}


def color_bars_data(bake: Bake) -> list[dict[str, Any]]:
    """Returns the color bars of a bake's textures, with the colors as those of colorMaps."""
    bars = [color_bar_of(isosurfaces.texture) for isosurfaces in bake.scene.isosurfaces]
    return [
        {
            "title": bar.title,
            "stops": [
                [share, bytes(display_colors(color, 1.0)).hex()] for share, color in bar.stops
            ],
            "ticks": bar.ticks,
        }
        for bar in bars
        if bar is not None
    ]


def step_of(bake: Bake) -> float:
    """Returns the step of isovalues in the page's controls.

    A power of ten, at most a thousandth of the isovalue range. Data of integers have steps that
    include half-integers.
    """
    low, high = bake.isovalues
    step = 10.0 ** math.floor(math.log10((high - low) / 1000.0))
    is_integer = len(bake.volumes) == 1 and bake.volume.values.dtype.kind in "iu"
    return min(step, 0.1) if is_integer else step


def about(bake: Bake, coarser: int) -> list[tuple[str, str]]:
    """Returns facts about a bake, [(label, value as text)]."""
    known = bake.statistics
    rows = []
    for volume in bake.volumes:
        nx, ny, nz = volume.field().dims
        rows.append(("Volume", f"{volume.name}, {nx} x {ny} x {nz} voxels"))
    for grid in bake.grids:
        rows.append(("Texels", f"{' x '.join(map(str, grid.resolution))}, {grid.texels} lit"))
    if coarser:
        rows.append(("Shown here", f"{EVERY[coarser]} voxel along each axis"))
    rows.append(("Isovalues lit", " to ".join(figures(*bake.isovalues))))
    rows.append(("Scene", bake.scene.name))
    rows.extend(("Color", caption) for caption in captions_of(bake.scene))
    if bake.scene.meshes and bake.walls is None:
        rows.append(("Walls", "shaded locally; bake with --walls to light them"))
    if any(back_side(bake, number) == "local" for number in range(len(bake.volumes))):
        rows.append(("backs", "not baked; lit from the camera to show their shape"))
    error = known.estimated_error_percent
    if error:
        rows.append(("Error of the bake", f"{error:.2g} % of the displayable range, estimated"))
    worst = known.worst_error_percent
    if worst:
        rows.append(("Greatest error", f"{worst:.2g} %, at isovalue {known.worst_isovalue:g}"))
    rows.append(("Bake", f"{known.seconds:.3g} s, {known.rays:.3g} rays"))
    rows.append(("Bake's id", bake.id))
    rows.append(("Made with", f"Leaflight {__version__}"))
    return rows
