# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of microscopes in HDF5.

BigDataViewer and BigStitcher: t00000/s00/0/cells, for each time and setup. Values are unsigned, but
stored as signed integers. https://imagej.net/plugins/bdv
Imaris: DataSet/ResolutionLevel 0/TimePoint 0/Channel 0/Data.
https://imaris.oxinst.com/support/imaris-file-format
"""

import re
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np

from ...volume.axes import Axis
from .channels import Channel, channel_of
from .hdf5_image import Image, image_of
from .hdf5_links import resolved
from .packing import Packing, attribute, text_of

# Upper bound on the bytes of the .xml beside the file.
_MOST_XML = 1 << 26
_SHORT = np.dtype(np.int16)


def bdv_images(file: h5py.File) -> dict[str, Image]:
    """Returns the image of each setup, such as a channel or an angle; {} for other programs' files.

    Frames are the times at which the setup has an image.
    """
    times = sorted(name for name in file if re.fullmatch("t[0-9]{5,}", name))
    setups = sorted(name for name in file if re.fullmatch("s[0-9]{2,}", name))
    sizes = _voxel_sizes(Path(file.filename)) if times else {}
    found = {}
    for setup in setups:
        factors = resolved(file, f"{setup}/resolutions")
        here = [time for time in times if resolved(file, f"{time}/{setup}") is not None]
        if not here or not isinstance(factors, h5py.Dataset) or factors.ndim != 2:
            continue
        size, unit = sizes.get(int(setup[1:]), ((1.0, 1.0, 1.0), ""))
        levels, dtype = [], _SHORT
        for number, factor in enumerate(np.asarray(factors[:], np.float64)):
            paths = [[f"{time}/{setup}/{number}/cells"] for time in here]
            cells = resolved(file, paths[0][0])
            if not isinstance(cells, h5py.Dataset) or cells.ndim != 3 or factor.shape != (3,):
                break
            dtype = cells.dtype
            # A coarse voxel lies in the middle of those that it averages.
            axes = [
                Axis(n, "", letter, 0.5 * (times - 1) * step, times * step, unit)
                for letter, n, times, step in zip("zyx", cells.shape, factor[::-1], size[::-1])
            ]
            levels.append((axes, paths))
        packing = Packing(unsigned=dtype.kind == "i" and dtype.itemsize == _SHORT.itemsize)
        image = image_of(levels, dtype, packing)
        if image is not None:
            found[setup] = image
    return found


def _voxel_sizes(path: Path) -> dict[int, tuple[tuple[float, ...], str]]:
    """Returns {setup: (voxel size (x, y, z), unit)} by the .xml beside the file; {} without one."""
    found: dict[int, tuple[tuple[float, ...], str]] = {}
    beside = path.with_suffix(".xml")
    try:
        if beside.stat().st_size > _MOST_XML:
            return {}
        root = ElementTree.fromstring(beside.read_bytes())
        for setup in root.iter("ViewSetup"):
            numbers = tuple(float(n) for n in setup.findtext("voxelSize/size", "").split())
            if len(numbers) == 3 and all(0 < n < float("inf") for n in numbers):
                unit = setup.findtext("voxelSize/unit", "")
                found[int(setup.findtext("id", ""))] = numbers, unit
    except (OSError, ValueError, ElementTree.ParseError):
        return {}
    return found


# A lost micro sign.
_LOST = "?m"


def imaris_images(file: h5py.File) -> dict[str, Image]:
    """Returns the only image of an Imaris file, {} for any other file."""
    root = text_of(attribute(file, "DataSetDirectoryName")) or "DataSet"
    info = text_of(attribute(file, "DataSetInfoDirectoryName")) or "DataSetInfo"
    extents = resolved(file, f"{info}/Image")
    steps: list[float | None] = []
    levels, data = [], None
    found: tuple[Channel, ...] = ()
    for level in _numbered(file, root, "ResolutionLevel"):
        times = _numbered(file, level, "TimePoint")
        channels = _numbered(file, times[0], "Channel") if times else []
        first = resolved(file, channels[0]) if channels else None
        if not isinstance(first, h5py.Group) or "Data" not in first:
            break
        names = [channel.rpartition("/")[2] for channel in channels]
        paths = [[f"{time}/{name}/Data" for name in names] for time in times]
        data = data or first["Data"]
        found = found or tuple(_channel(file, f"{info}/{name}") for name in names)
        axes = _axes(first, extents, steps)
        steps = steps or [axis.step for axis in axes]
        levels.append((axes, paths))
    image = image_of(levels, data.dtype, None, found) if data is not None else None
    return {} if image is None else {root: image}


def _channel(file: h5py.File, path: str) -> Channel:
    """Returns the name and the color of a channel. The color is three numbers as text."""
    item = resolved(file, path)
    try:
        color = [float(number) for number in text_of(attribute(item, "Color")).split()]
    except ValueError:
        color = []
    return channel_of(text_of(attribute(item, "Name")), color)


def _axes(
    channel: h5py.Group, extents: h5py.Group | None, finest: list[float | None]
) -> list[Axis]:
    """Returns the axes z, y and x of the image, without the padding of its chunks.

    finest: Steps of the finest level. Its first voxel lies at the lower end of the extents.
    """
    axes = []
    unit = text_of(attribute(extents, "Unit"))
    for place, (name, number) in enumerate(zip("ZYX", "210")):
        full = channel["Data"].shape[place]
        size = int(_number(channel, f"ImageSize{name}") or full)
        low, high = (_number(extents, f"Ext{end}{number}") for end in ("Min", "Max"))
        axis = Axis(min(size, full), letter=name.lower())
        if low is not None and high is not None and 0 < size and 0 < high - low:
            step = (high - low) / size
            shift = 0.5 * (step - (finest[place] or step)) if finest else 0.0
            unit = "µm" if unit in ("", _LOST) else unit
            axis = Axis(axis.size, "", axis.letter, low + shift, step, unit)
        axes.append(axis)
    return axes


def _numbered(file: h5py.File, path: str, word: str) -> list[str]:
    """Returns the paths of the groups "word 0", "word 1", ... at a path."""
    group = resolved(file, path)
    found = [re.fullmatch(f"{word} ([0-9]+)", name) for name in group or ()]
    return [f"{path}/{word} {n}" for n in sorted(int(one[1]) for one in found if one)]


def _number(item: h5py.HLObject | None, name: str) -> float | None:
    """Returns a number that Imaris stores as text."""
    try:
        number = float(text_of(attribute(item, name)))
    except ValueError:
        return None
    return number if abs(number) < float("inf") else None
