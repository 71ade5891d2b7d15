# SPDX-License-Identifier: GPL-3.0-or-later
"""Leica LIF through liffile, in a subprocess."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from ...arrays import Array
from .channels import Channel, channel_of
from .microscope import Format, Picture, open_pictures

open_volume = partial(open_pictures, kind=Format("LIF file", "liffile", __name__))
# Wavelengths are channels, and tiles of a mosaic are positions.
_NAMES = {"λ": "C", "Λ": "C", "M": "P"}
# Codes of liffile for the axes of space.
_SPACE = {"1": "X", "2": "Y", "3": "Z"}
# Colors of Leica's lookup tables.
_COLORS = {
    **{"Red": (1, 0, 0), "Green": (0, 1, 0), "Blue": (0, 0, 1), "Gray": (1, 1, 1)},
    **{"Cyan": (0, 1, 1), "Magenta": (1, 0, 1), "Yellow": (1, 1, 0)},
}


def pictures(path: Path) -> list[Picture]:
    """Returns the images of a file. Runs in the subprocess."""
    import liffile

    with liffile.LifFile(path) as file:
        return [_picture(image) for image in _images(file)]


def _images(file: Any) -> list[Any]:
    """Returns the images, without photon histograms."""
    import liffile

    return [image for image in file.images if isinstance(image, liffile.LifImage)]


def _split(image: Any) -> int:
    """Returns the number of axes outside planes."""
    names = list(image.sizes)
    return len(names) - (3 if names[-1] == "S" else 2)


def _picture(image: Any) -> Picture:
    axes = tuple((_NAMES.get(name, name), int(n)) for name, n in image.sizes.items())
    outer, inner = axes[: _split(image)], axes[_split(image) :]
    sizes, unit = _voxel_size(image)
    return Picture(image.name, outer, inner, image.dtype.str, sizes, unit, _channel_list(image))


def _channel_list(image: Any) -> list[Channel]:
    """Returns the dyes of the channels, and the colors of their lookup tables."""
    path = "./Data/Image/ImageDescription/Channels/ChannelDescription"
    found = sorted(image.xml_element.findall(path), key=lambda one: int(one.get("BytesInc")))
    channels = []
    for one in found:
        about = {
            each.findtext("Key"): each.findtext("Value") for each in one.iter("ChannelProperty")
        }
        channels.append(channel_of(about.get("DyeName"), _COLORS.get(one.get("LUTName"))))
    return channels


def _voxel_size(image: Any) -> tuple[list[float | None], str]:
    """Returns the distance between the first and the last voxel, divided by the steps."""
    found: dict[str, float] = {}
    unit = ""
    path = "./Data/Image/ImageDescription/Dimensions/DimensionDescription"
    for dimension in image.xml_element.findall(path):
        axis = _SPACE.get(dimension.get("DimID"))
        steps = int(dimension.get("NumberOfElements")) - 1
        if axis is not None and steps > 0:
            found[axis] = float(dimension.get("Length")) / steps
            unit = dimension.get("Unit")
    return [found.get(axis) for axis in "XYZ"], unit


def blocks(path: Path, number: int, places: list[list[int]]) -> Iterator[Array]:
    """Yields planes of an image. Runs in the subprocess."""
    import liffile

    with liffile.LifFile(path) as file:
        image = _images(file)[number]
        # Colors are sorted in memory.
        colors = "S" in image.sizes
        values = image.asarray() if colors else image.asarray(out="memmap")
        for place in places:
            yield values[tuple(place)]
