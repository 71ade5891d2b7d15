# SPDX-License-Identifier: GPL-3.0-or-later
"""Imaris images in HDF5: DataSet/ResolutionLevel 0/TimePoint 0/Channel 0/Data.

https://imaris.oxinst.com/support/imaris-file-format
"""

import re

import h5py

from .attributes import attribute, text_of
from .axes import Axis
from .channels import Channel, channel_of
from .hdf5_image import Image, image_of
from .hdf5_links import resolved

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
