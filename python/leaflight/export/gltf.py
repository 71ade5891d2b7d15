# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit isosurfaces as glTF 2.0 in one binary file (.glb), for browsers and slides.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
"""

import json
import struct
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Surface
from ..io.output import check_writable, replaced
from ..paths import AnyPath
from ..scene.volume_texture import identifiers
from ..version import __version__
from ..volume.units import METERS

# A quarter turn about x, because z points up in the world and y in glTF.
_UP = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
_SECONDS = 0.1
# Stands for NaN, which glTF forbids.
LACKING = float(np.finfo(np.float32).min)
# Smallest size in meters that viewers do not clip. The unit of smaller objects becomes a meter.
_SMALLEST = 1e-4
# Codes of the format for types of arrays, and for their use.
_TYPES = {"float32": 5126, "uint32": 5125}
_SHAPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
_VERTICES, _INDICES = {"target": 34962}, {"target": 34963}
_MATERIAL = {
    "name": "lit by the bake",
    # Viewers without the extension then add as little light as possible.
    "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0},
    "extensions": {"KHR_materials_unlit": {}},
    "doubleSided": True,
}


def write_glb(
    path: AnyPath, surfaces: Mapping[float, Surface], exposure: float, seconds: float = _SECONDS
) -> None:
    """Writes Surfaces, {isovalue: Surface}. Raises LeaflightError.

    Coordinates are those of the world; the root node takes them to meters, with y up. Vertices have
    POSITION, NORMAL, COLOR_0 and _RADIANCE. COLOR_0 is float RGBA, linear as glTF demands: radiance
    times the exposure, clamped to 0..1. _RADIANCE is float, W/(m^2 sr), linear RGB. The values
    of volumes that color a surface are float, _NAME, and LACKING where there are none. The material
    is KHR_materials_unlit, because colors contain the light. Several surfaces are the frames of an
    animation, each shown for `seconds`. Viewers without animation show the first.
    """
    check_writable(path, ".glb")
    file, frames = _File(), range(1, len(surfaces) + 1)
    turn = {"rotation": _UP, "scale": [_meters(surfaces.values())] * 3, "children": list(frames)}
    file.nodes = [{"name": "Leaflight", **turn}]
    for isovalue, surface in surfaces.items():
        name = f"isovalue {isovalue:g}"
        hidden = {"scale": [0.0, 0.0, 0.0]} if file.meshes else {}
        file.nodes.append({"name": name, "mesh": len(file.meshes), **hidden})
        file.meshes.append({"name": name, "primitives": [_primitive(file, surface, exposure)]})
    animations = [_animation(file, frames, seconds)] if len(surfaces) > 1 else []
    with replaced(path) as temporary:
        temporary.write_bytes(file.content(animations))


class _File:
    """A file in memory: arrays in `body`, and the objects that refer to them by number."""

    def __init__(self) -> None:
        self.body = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.nodes: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []

    def add(self, numbers: Array, use: dict[str, int] | None = None, bounds: bool = False) -> int:
        """Appends an array, float32 or uint32 (n,) or (n, k); returns its number."""
        numbers = np.ascontiguousarray(numbers)
        rows = numbers.reshape(len(numbers), -1)
        place = {"buffer": 0, "byteOffset": len(self.body), "byteLength": numbers.nbytes}
        kind = {"componentType": _TYPES[numbers.dtype.name], "type": _SHAPES[rows.shape[1]]}
        if bounds:
            kind |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append({"bufferView": len(self.views), "count": len(numbers), **kind})
        self.views.append({**place, **(use or {})})
        self.body += numbers.astype(numbers.dtype.newbyteorder("<")).tobytes()
        return len(self.accessors) - 1

    def content(self, animations: Sequence[dict[str, Any]]) -> bytes:
        """Returns the file: a header, the JSON and the arrays, each padded to four bytes."""
        document = {
            "asset": {"version": "2.0", "generator": f"Leaflight {__version__}"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": [_MATERIAL],
            "extensionsUsed": ["KHR_materials_unlit"],
            **({"animations": animations} if animations else {}),
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.body)}],
        }
        text = json.dumps(document, separators=(",", ":")).encode("ascii")
        text += b" " * (-len(text) % 4)
        length = 12 + 8 + len(text) + 8 + len(self.body)
        if length >= 1 << 32:
            raise LeaflightError(
                f"The .glb would have {length / 2**30:.1f} GiB, but the format allows 4: export "
                "fewer isovalues, or .usdc."
            )
        return b"".join(
            [
                struct.pack("<4sII", b"glTF", 2, length),
                struct.pack("<I4s", len(text), b"JSON"),
                text,
                struct.pack("<I4s", len(self.body), b"BIN\0"),
                self.body,
            ]
        )


def _primitive(file: _File, surface: Surface, exposure: float) -> dict[str, Any]:
    # Write floats, because some readers confuse 16 bits with 8.
    colors = np.ones((len(surface.radiance), 4), np.float32)
    colors[:, :3] = np.clip(surface.radiance * np.float32(exposure), 0.0, 1.0)
    attributes = {
        "POSITION": file.add(surface.vertices, _VERTICES, bounds=True),
        "NORMAL": file.add(_unit(surface.normals), _VERTICES),
        "COLOR_0": file.add(colors, _VERTICES),
        "_RADIANCE": file.add(surface.radiance, _VERTICES),
    }
    for name, values in identifiers(surface.values, ["radiance"]).items():
        attributes[f"_{name.upper()}"] = file.add(np.nan_to_num(values, nan=LACKING), _VERTICES)
    indices = file.add(surface.triangles.astype(np.uint32).ravel(), _INDICES)
    return {"attributes": attributes, "indices": indices, "material": 0}


def _animation(file: _File, nodes: Sequence[int], seconds: float) -> dict[str, Any]:
    """Shows the nodes one after the other: visible ones have the scale 1, others 0."""
    ends = seconds * np.arange(len(nodes) + 1, dtype=np.float32)
    channels, samplers = [], []
    for frame, node in enumerate(nodes):
        times, shown = [0.0], [float(frame == 0)]
        if frame > 0:
            times, shown = [0.0, ends[frame]], [0.0, 1.0]
        times, shown = [*times, ends[frame + 1]], [*shown, 0.0]
        if frame == len(nodes) - 1:
            # The last node stays until the animation starts again.
            shown[-1] = 1.0
        scales = np.repeat(np.array(shown, np.float32)[:, None], 3, axis=1)
        given, found = file.add(np.array(times, np.float32), bounds=True), file.add(scales)
        samplers.append({"input": given, "output": found, "interpolation": "STEP"})
        channels.append({"sampler": frame, "target": {"node": node, "path": "scale"}})
    return {"name": "isovalues", "channels": channels, "samplers": samplers}


def _meters(surfaces: Collection[Surface]) -> float:
    """Returns the meters per unit of the world; 1 if unknown or if the object is too small."""
    points = np.concatenate([surface.vertices for surface in surfaces])
    scale = METERS.get(next(iter(surfaces)).unit, 1.0)
    return scale if scale * float(np.ptp(points, axis=0).max()) >= _SMALLEST else 1.0


def _unit(normals: Array) -> Array:
    """Normalizes normals, as glTF demands; takes +z where a field is flat."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(length > 0, normals / np.maximum(length, 1e-30), [0.0, 0.0, 1.0]).astype(
        np.float32
    )
