# SPDX-License-Identifier: GPL-3.0-or-later
"""What surrounds the leaves: meshes and lights, as plain data and as scene files.

A scene file is one JSON object:

    name          text
    coordinates   "world": the numbers are world coordinates; or "box": they are relative to the
                  volume, whose longest side runs from -1 to 1 around its centre, so that the scene
                  fits any volume
    leaf_albedo   [r, g, b] in 0..1, of every isosurface
    exposure      positive factor from radiance to the colour on the screen
    meshes        list of {"name", "albedo": [r, g, b] in 0..1, "vertices": [[x, y, z], ...],
                  "faces": [[i, j, k] or [i, j, k, l], ...]}; Lambertian on both sides
    lights        list of {"name", "corner", "edge_u", "edge_v": [x, y, z], "radiance": [r, g, b]};
                  the rectangle emits radiance in W/(m^2 sr), linear RGB, towards
                  cross(edge_u, edge_v), and neither blocks nor reflects light
    comment       optional text
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from . import _core
from ._core import LeaflightError


@dataclass(frozen=True, eq=False)
class Mesh:
    """Lambertian: vertices float32 (n, 3), triangles uint32 (m, 3), albedo (3,) in 0..1."""

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    albedo: tuple


@dataclass(frozen=True, eq=False)
class RectangleLight:
    """A rectangle that emits radiance (3,) in W/(m^2 sr) towards cross(edge_u, edge_v)."""

    name: str
    corner: tuple
    edge_u: tuple
    edge_v: tuple
    radiance: tuple


@dataclass(frozen=True, eq=False)
class SceneDescription:
    """Everything of a scene but the volume; coordinates is "world" or "box" (see the module)."""

    name: str
    leaf_albedo: tuple
    exposure: float
    meshes: list
    lights: list
    coordinates: str = "world"


def load_scene(path):
    """Reads a scene file. Raises LeaflightError naming the file and the object that is wrong."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise LeaflightError(f"{path}: cannot read the scene file: {reason}.") from None
    return scene_from_json(text, str(path))


def cornell_box():
    """The default surroundings, in box coordinates: scenes/cornell.json."""
    return load_scene(Path(__file__).resolve().parent / "scenes" / "cornell.json")


def fit_scene(description, volume):
    """The description in world coordinates; one in box coordinates is fitted around the volume."""
    if description.coordinates == "world":
        return description
    bounds = np.asarray(volume.field().bounds, dtype=np.float64)
    centre = bounds.mean(axis=0)
    scale = 0.5 * float((bounds[1] - bounds[0]).max())

    def vector(v):
        return tuple(float(x) for x in scale * np.asarray(v))

    meshes = [
        replace(mesh, vertices=(centre + scale * mesh.vertices).astype(np.float32))
        for mesh in description.meshes
    ]
    lights = [
        replace(
            light,
            corner=tuple(float(x) for x in centre + scale * np.asarray(light.corner)),
            edge_u=vector(light.edge_u),
            edge_v=vector(light.edge_v),
        )
        for light in description.lights
    ]
    return replace(description, meshes=meshes, lights=lights, coordinates="world")


def core_scene(description, field, isovalues):
    """The core's scene of a description in world coordinates. Raises LeaflightError."""
    meshes = [_core.Mesh(m.name, m.vertices, m.triangles, m.albedo) for m in description.meshes]
    lights = [
        _core.RectangleLight(light.name, light.corner, light.edge_u, light.edge_v, light.radiance)
        for light in description.lights
    ]
    return _core.Scene(field, description.leaf_albedo, meshes, lights, isovalues)


def scene_to_json(description):
    """The text that scene_from_json turns into the same description again."""
    data = {
        "name": description.name,
        "coordinates": description.coordinates,
        "leaf_albedo": _numbers(description.leaf_albedo),
        "exposure": float(description.exposure),
        "meshes": [
            {
                "name": mesh.name,
                "albedo": _numbers(mesh.albedo),
                "vertices": np.asarray(mesh.vertices, dtype=np.float64).tolist(),
                "faces": np.asarray(mesh.triangles).tolist(),
            }
            for mesh in description.meshes
        ],
        "lights": [
            {
                "name": light.name,
                "corner": _numbers(light.corner),
                "edge_u": _numbers(light.edge_u),
                "edge_v": _numbers(light.edge_v),
                "radiance": _numbers(light.radiance),
            }
            for light in description.lights
        ],
    }
    return json.dumps(data, separators=(",", ":"))


def scene_from_json(text, source="scene"):
    """Parses the text of a scene file; source names it in errors. Raises LeaflightError."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        detail = f"{error.msg}, line {error.lineno}" if hasattr(error, "msg") else "malformed"
        raise LeaflightError(f"{source}: this is not valid JSON ({detail}).") from None
    root = _Object(data, source)
    root.only("name", "coordinates", "leaf_albedo", "exposure", "meshes", "lights", "comment")
    coordinates = root.get("coordinates")
    if coordinates not in ("world", "box"):
        raise root.error('"coordinates" must be "world" or "box"')
    exposure = root.array("exposure")
    if exposure.shape != () or not exposure > 0:
        raise root.error('"exposure" must be a positive number')
    return SceneDescription(
        name=root.text("name"),
        leaf_albedo=root.colour("leaf_albedo", largest=1.0),
        exposure=float(exposure),
        meshes=[_mesh(item) for item in root.objects("meshes", "mesh")],
        lights=[_light(item) for item in root.objects("lights", "light")],
        coordinates=coordinates,
    )


def _mesh(item):
    item.only("name", "albedo", "vertices", "faces")
    vertices = item.array("vertices")
    if vertices.ndim != 2 or vertices.shape[1] != 3 or len(vertices) < 3:
        raise item.error('"vertices" must be a list of at least three [x, y, z]')
    triangles = []
    for face in item.items("faces"):
        if (
            not isinstance(face, list)
            or len(face) not in (3, 4)
            or not all(isinstance(i, int) and 0 <= i < len(vertices) for i in face)
        ):
            raise item.error(
                f'"faces" must hold lists of 3 or 4 vertex indices in 0..{len(vertices) - 1}'
            )
        triangles += [[face[0], face[i], face[i + 1]] for i in range(1, len(face) - 1)]
    return Mesh(
        item.name,
        vertices.astype(np.float32),
        np.array(triangles, dtype=np.uint32).reshape(-1, 3),
        item.colour("albedo", largest=1.0),
    )


def _light(item):
    item.only("name", "corner", "edge_u", "edge_v", "radiance")
    corner, edge_u, edge_v = (item.vector(key) for key in ("corner", "edge_u", "edge_v"))
    lengths = np.linalg.norm(edge_u) * np.linalg.norm(edge_v)
    if not np.linalg.norm(np.cross(edge_u, edge_v)) > 1e-6 * lengths:
        raise item.error(
            '"edge_u" and "edge_v" must span a rectangle, but they are parallel or zero'
        )
    if abs(np.dot(edge_u, edge_v)) > 1e-4 * lengths:
        raise item.error('"edge_u" and "edge_v" must be at right angles')
    return RectangleLight(item.name, corner, edge_u, edge_v, item.colour("radiance"))


class _Object:
    """One object of a scene file and how errors call it."""

    def __init__(self, data, where):
        self.data = data
        self.where = where
        self.name = ""
        if not isinstance(data, dict):
            raise self.error("it must be a JSON object {...}")

    def error(self, what):
        return LeaflightError(f"{self.where}: {what}.")

    def only(self, *keys):
        for key in self.data:
            if key not in keys:
                raise self.error(f'unknown key "{key[:40]}"; known are {", ".join(keys)}')

    def get(self, key):
        if key not in self.data:
            raise self.error(f'the key "{key}" is missing')
        return self.data[key]

    def text(self, key):
        value = self.get(key)
        if not isinstance(value, str):
            raise self.error(f'"{key}" must be text')
        return value

    def items(self, key):
        value = self.get(key)
        if not isinstance(value, list):
            raise self.error(f'"{key}" must be a list')
        return value

    def objects(self, key, kind):
        children = []
        for i, data in enumerate(self.items(key)):
            child = _Object(data, f"{self.where}: {kind} {i + 1}")
            child.name = child.text("name")
            child.where = f'{self.where}: {kind} "{child.name[:60]}"'
            children.append(child)
        return children

    def array(self, key):
        try:
            array = np.array(self.get(key), dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise self.error(f'"{key}" must hold numbers only, in rows of equal length') from None
        if not np.isfinite(array).all():
            raise self.error(f'"{key}" must hold finite numbers')
        return array

    def vector(self, key):
        array = self.array(key)
        if array.shape != (3,):
            raise self.error(f'"{key}" must be three numbers')
        return tuple(float(x) for x in array)

    def colour(self, key, largest=np.inf):
        colour = self.vector(key)
        if min(colour) < 0 or max(colour) > largest:
            allowed = f"between 0 and {largest:g}" if largest < np.inf else "not negative"
            raise self.error(f'"{key}" must be three numbers {allowed}')
        return colour


def _numbers(vector):
    return [float(x) for x in vector]
