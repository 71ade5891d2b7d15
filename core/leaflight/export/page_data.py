# SPDX-License-Identifier: GPL-3.0-or-later
"""What a web page shows of a bake: numbers in blocks of bytes, and a header that tells of them.

The page reads it in web/src/bake.ts, which lists the names; the two change together.
"""

import zlib
from dataclasses import asdict, dataclass, field

import numpy as np

from ..stills.camera import bounds_of, camera_around_bake
from ..stills.lamps import lamps_of
from ..version import __version__
from .page_volume import shown_volume, volume_data
from .page_walls import walls_data
from .shared_exponent import planes

# Of the header and the blocks; the page refuses another one.
FORMAT = 2
HISTOGRAM_BINS = 256
# How a coarser page is called, by how many times it was halved.
EVERY = ("every", "every 2nd", "every 4th", "every 8th")
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
        parted = np.ascontiguousarray(raw.reshape(-1).view(np.uint8).reshape(-1, raw.itemsize).T)
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

    def add_colors(self, words):
        """The same of packed() colors."""
        return self.add(planes(words))


def page_data(bake, isovalue, coarser, progress):
    """The PageData of a Bake; isovalue: the leaf coordinate that is shown at first.

    coarser: how many times voxels and texels are halved along each axis. progress:
    _core.Progress. Raises Cancelled.
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
        window=list(bake.isovalues),
        isovalue=float(isovalue),
        exposure=bake.scene.exposure,
        camera=asdict(camera_around_bake(bake)),
        bounds=[low.tolist(), high.tolist()],
        volumes=[volume_data(data, each) for each in shown],
        walls=walls_data(data, bake),
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
