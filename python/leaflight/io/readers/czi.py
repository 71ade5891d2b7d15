# SPDX-License-Identifier: GPL-3.0-or-later
"""Zeiss CZI through Zeiss's library pylibCZIrw, in a subprocess."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ..._core import LeaflightError
from ...arrays import Array
from .channels import Channel, bytes_of_hex, channel_of
from .microscope import Format, Picture, open_pictures

open_volume = partial(open_pictures, kind=Format("CZI file", "pylibCZIrw", __name__))
# Views are positions; phases, rotations and illuminations are channels.
_NAMES = {"T": "T", "V": "P", "R": "C", "I": "C", "H": "C", "B": "C", "C": "C", "Z": "Z"}
_TYPES = {
    "Gray8": "u1",
    "Gray16": "u2",
    "Gray32Float": "f4",
    "Bgr24": "u1",
    "Bgr48": "u2",
    "Bgr96Float": "f4",
}


def pictures(path: Path) -> list[Picture]:
    """Returns the scenes of a file. Runs in the subprocess."""
    from pylibCZIrw import czi

    with czi.open_czi(str(path)) as file:
        types = set(file.pixel_types.values())
        dtypes = [_TYPES[one] for one in types if one in _TYPES]
        colors = {one.startswith("Bgr") for one in types}
        if len(dtypes) < len(types) or len(colors) > 1:
            raise LeaflightError(
                f"{path}: its channels mix the pixel types {', '.join(sorted(types))}; save only "
                "gray values, or only colors."
            )
        xml = ElementTree.fromstring(file.raw_metadata)
        sizes, channels = _voxel_size(xml), _channel_list(xml)
        made = []
        for scene, coordinates in sorted(_scenes(file).items()):
            outer = tuple((_NAMES[d], len(values)) for d, values in _values(coordinates).items())
            box = _box(file, scene)
            inner = (("Y", box[3]), ("X", box[2]), *((("S", 3),) if colors == {True} else ()))
            name = "" if scene < 0 else f"scene {scene}"
            dtype = np.result_type(*dtypes).str
            made.append(Picture(name, outer, inner, dtype, sizes, "m", channels))
        return made


def blocks(path: Path, number: int, places: list[list[int]]) -> Iterator[Array]:
    """Yields planes of a scene. Raises LeaflightError if one is missing. Runs in the subprocess."""
    from pylibCZIrw import czi

    file = czi.CziReader(str(path))
    scene, coordinates = sorted(_scenes(file).items())[number]
    values = _values(coordinates)
    planes = [{d: values[d][k] for d, k in zip(values, place)} for place in places]
    stored = {tuple(one.get(d, 0) for d in values) for one in coordinates}
    for plane in planes:
        if tuple(plane.values()) not in stored:
            # The library would return black.
            where = ", ".join(f"{d} {k}" for d, k in plane.items() if len(values[d]) > 1)
            raise LeaflightError(
                f"{path}: the plane {where} of the recording is missing; fetch the file again, or "
                "choose another frame."
            )
    box, of_scene = _box(file, scene), None if scene < 0 else scene
    return (_plane(file.read(roi=box, plane=plane, scene=of_scene)) for plane in planes)


def _plane(pixels: Array) -> Array:
    """Returns [y, x], or [y, x, s] as red, green, blue, which the file stores in reverse."""
    return pixels[..., 0] if pixels.shape[2] == 1 else pixels[..., ::-1]


def _scenes(file: Any) -> dict[int, list[dict[str, int]]]:
    """Returns {scene: coordinates of its tiles}; the scene is -1 in files without scenes."""
    found: dict[int, list[dict[str, int]]] = {}

    def add(_number: int, tile: Any) -> bool:
        coordinate = dict(tile.coordinate.to_dict())
        found.setdefault(coordinate.pop("S", -1), []).append(coordinate)
        return True

    file.enumerate_subblocks_subset(add, only_layer0=True)
    return found


def _values(coordinates: list[dict[str, int]]) -> dict[str, list[int]]:
    """Returns {dimension: its values}, slowest first."""
    return {
        dimension: sorted({one.get(dimension, 0) for one in coordinates}) for dimension in _NAMES
    }


def _box(file: Any, scene: int) -> tuple[int, int, int, int]:
    """Returns (x, y, width, height) of a scene at full resolution."""
    if scene < 0:
        box = file.total_bounding_rectangle_no_pyramid
    else:
        box = file.scenes_bounding_rectangle_no_pyramid[scene]
    return int(box.x), int(box.y), int(box.w), int(box.h)


def _channel_list(xml: ElementTree.Element) -> list[Channel]:
    """Returns the names of the channels, and their colors for display."""
    shown = {
        one.get("Id"): one.findtext("Color")
        for one in xml.findall("./Metadata/DisplaySetting/Channels/Channel")
    }
    return [
        channel_of(one.get("Name"), bytes_of_hex(shown.get(one.get("Id"))))
        for one in xml.findall("./Metadata/Information/Image/Dimensions/Channels/Channel")
    ]


def _voxel_size(xml: ElementTree.Element) -> list[float | None]:
    """Returns voxel sizes in meters."""
    found: list[float | None] = []
    for axis in "XYZ":
        path = f"./Metadata/Scaling/Items/Distance[@Id='{axis}']/Value"
        text = xml.findtext(path)
        found.append(float(text) if text else None)
    return found
