# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of isosurfaces in scene files (scene_file.py)."""

import base64
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..paths import AnyPath
from ..scene.volume_texture import MOST_STEPS, Stops, VolumeTexture, label_texture, texture_of
from ..volume.memory import VOXEL_TYPES, as_voxels
from ..volume.volume import Volume
from .json_object import JsonObject
from .readers.reading import OPTIONS, read_volume
from .sources import is_generated, open_volume

# Upper bound on the nodes along an axis, so that their product can count bytes.
_MOST_NODES = 1 << 20
_TYPES = {np.dtype(kind).name: np.dtype(kind) for kind in VOXEL_TYPES}


def texture_from(item: JsonObject, folder: AnyPath) -> VolumeTexture:
    """Returns the texture of a volume. Raises LeaflightError. folder: of the files it names."""
    keys = ("channels", "colors", "map", "range", "nearest", "labels")
    item.only(*keys, "reverse", "symmetric", "steps")
    channels = [_channel(channel, folder) for channel in item.named("channels", "channel")]
    if len(channels) not in (1, 3):
        raise item.error('"channels" must be one volume, or three for red, green and blue')
    colors: str | Stops | None = None
    if "colors" in item:
        colors = item.stops("colors", largest=1.0)
    elif "map" in item:
        colors = item.text("map")
    value_range = None
    if "range" in item:
        low, high = item.vector("range", 2)
        value_range = low, high
    try:
        if item.flag("labels"):
            return label_texture(channels[0])
        return texture_of(
            channels,
            colors,
            value_range,
            item.flag("nearest"),
            reverse=item.flag("reverse"),
            symmetric=item.flag("symmetric"),
            steps=int(item.number("steps", 0, MOST_STEPS, 0)),
        )
    except LeaflightError as error:
        raise LeaflightError(f"{item.where}: {error}") from None


def texture_data(texture: VolumeTexture) -> dict[str, Any]:
    """Returns the object that texture_from() reads, with all values."""
    data: dict[str, Any] = {
        "channels": [_channel_data(channel) for channel in texture.channels],
        "colors": [[value, list(color)] for value, color in texture.colors],
    }
    return data | ({"nearest": True} if texture.nearest else {})


def _channel(item: JsonObject, folder: AnyPath) -> Volume:
    if "source" in item:
        item.only("name", "source", "reading")
        if "reading" in item:
            item.child("reading").only(*OPTIONS)
        reading = item.get("reading") if "reading" in item else {}
        if "label_table" in reading:
            reading = {**reading, "label_table": Path(folder) / str(reading["label_table"])}
        source = item.text("source")
        if is_generated(source):
            return open_volume(source, **reading)
        return read_volume(Path(folder) / source, **reading)
    item.only("name", "type", "dims", "values", "index_to_world", "unit")
    dims = [int(n) for n in item.vector("dims")]
    if not all(1 <= n <= _MOST_NODES for n in dims):
        raise item.error(f'"dims" must be three numbers in 1..{_MOST_NODES}')
    matrix = item.array("index_to_world")
    if matrix.shape != (4, 4):
        raise item.error('"index_to_world" must be a 4 x 4 matrix')
    kind = _TYPES[item.choice("type", tuple(_TYPES))]
    values = unpacked(item, "values", dims[0] * dims[1] * dims[2], kind.newbyteorder("<"))
    unit = item.text("unit", "")
    return Volume(values.astype(kind).reshape(dims[::-1]), matrix, item.name, unit=unit)


def _channel_data(volume: Volume) -> dict[str, Any]:
    values = as_voxels(volume.values)
    return {
        "name": volume.name,
        "type": values.dtype.name,
        "dims": list(values.shape[::-1]),
        "values": packed(values),
        "index_to_world": np.asarray(volume.index_to_world, np.float64).tolist(),
        **({"unit": volume.unit} if volume.unit else {}),
    }


def packed(values: Array) -> str:
    """Returns the values of an array as text: little-endian, compressed by zlib, in base64."""
    # Higher levels hardly compress floating-point numbers more.
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    return base64.b64encode(zlib.compress(little.data, level=1)).decode()


def unpacked(item: JsonObject, key: str, count: int, kind: "np.dtype[Any]") -> Array:
    """Returns `count` numbers of a text of packed(), read-only. Raises LeaflightError."""
    size = count * kind.itemsize
    try:
        decompressor = zlib.decompressobj()
        compressed = base64.b64decode(item.text(key), validate=True)
        content = decompressor.decompress(compressed, size)
    except (ValueError, zlib.error):
        raise item.error(f'"{key}" is not zlib in base64; embed it again') from None
    if len(content) != size or not decompressor.eof:
        raise item.error(f'"{key}" does not hold {count} numbers of type {kind.name}')
    return np.frombuffer(content, dtype=kind)
