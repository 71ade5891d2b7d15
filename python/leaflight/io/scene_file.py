# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files: a SceneDescription as one JSON object with these keys.

name: Text.
coordinates: "world" for world coordinates, or "box". In "box" the longest side of the box around
    all volumes is from -1 to 1 around its center, so that the scene fits any volume.
isosurface_albedo: Albedo of every isosurface of every volume. It is [r, g, b] in 0..1, or stops
    [[isovalue, [r, g, b]], ...] in ascending isovalues.
isosurface_emission, isosurface_scattering, isosurface_ior, capped: Optional, as "emission",
    "scattering", "ior" and "capped" of a volume.
volumes: List of volumes, in place of isosurface_* and capped.
exposure: Positive factor from radiance to the color on the screen.
meshes: List of meshes.
lights: List of lights. They neither block nor reflect light.
environment: Optional {"radiance": [r, g, b], "name", "image"}. The image is a latitude-longitude
    image file. Its optional "rotation" is about +z in degrees, or "world_to_image" is a 3 x 3
    matrix.
comment: Optional text.

A volume has "name" and "albedo", and these optional keys.

"emission": As albedo, but radiance in W/(m^2 sr).
"scattering": "diffuse", "mirror" or "glass".
"ior": Refractive index of glass (1.5).
"isovalues": Isovalues [lo, hi] at the common isovalues 0 and 1.
"capped": True closes the isosurfaces at the border of the volume.
"texture": {"channels": [...]}, which colors the isosurfaces by other volumes. There is one channel,
    or three for red, green and blue. Each has "name", "source" and optionally "reading", as a
    volume. "colors" are stops [[value, [r, g, b]], ...]. Instead, "map" is a color map such as
    "VIRIDIS" over "range": [low, high], by default that of the data. "reverse", "symmetric" and
    "steps" are those of texture_of(). "nearest": true takes the value of the nearest voxel.
    "labels": true takes the colors of labels instead, by the table of the file. A texture
    multiplies the albedo.
"source": File, relative to the scene file, or a generated volume.
"reading": Options of read_volume() for the source, such as {"frame": 1}.

A mesh has "name", "albedo": [r, g, b] in 0..1, "vertices": [[x, y, z], ...] and "faces": [[i, j, k]
or [i, j, k, l], ...]. Optional keys are "scattering", "ior", "emission": [r, g, b], "texture" and
"uv". The texture is an image file, relative to the scene file, that multiplies the albedo. "uv" is
[[[u, v] for each corner] for each face].

A light has "name", "type" and the keys of its type.

"area": The default. "corner", "edge_u", "edge_v", and "radiance" towards cross(edge_u, edge_v) in
W/(m^2 sr). "ellipse": True is the inscribed ellipse.
"point": "position", "radius" (0), and "intensity" in W/sr.
"spot": As point. Also "axis", "angle" of the cone in degrees, "blend" of its edge in 0..1 (0), and
"cosine_falloff" (false).
"sun": "direction" in which light travels, "irradiance" in W/m^2, and "angle" of its disc in degrees
(0).

Colors are linear RGB. An image may be embedded: {"width", "height", "pixels"}. The pixels are
little-endian float32 RGB, bottom row first, compressed by zlib, in base64.
"""

import json
import math
from collections.abc import Callable
from dataclasses import MISSING, fields, replace
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..paths import AnyPath
from ..scene.lights import AreaLight, Cone, Light, PointLight, SunLight
from ..scene.scene import IDENTITY, Environment, Isosurfaces, Mesh, SceneDescription
from ..scene.volume_texture import VolumeTexture
from .images import read_texture
from .json_object import JsonObject, parse, read_text
from .readers.reading import OPTIONS
from .sources import is_generated
from .texture_file import packed, texture_data, texture_from, unpacked

SCATTERING = ("diffuse", "mirror", "glass")
LIGHTS = ("area", "point", "spot", "sun")
BLACK = (0.0, 0.0, 0.0)
# The core's limits of the refractive index.
IOR = (0.1, 10.0)


def load_scene(path: AnyPath) -> SceneDescription:
    """Reads a scene file. Raises LeaflightError naming the file and the object that is wrong."""
    return scene_from_json(read_text(path), str(path), Path(path).parent)


def cornell_box() -> SceneDescription:
    """Returns the default walls, in box coordinates: scenes/cornell.json."""
    return packaged_scene("cornell.json")


def packaged_scene(name: str) -> SceneDescription:
    """Returns the SceneDescription of a scene file of the package. Raises LeaflightError."""
    return load_scene(Path(__file__).parent.parent / "scenes" / name)


def scene_from_json(text: str, source: str = "scene", folder: AnyPath = ".") -> SceneDescription:
    """Parses the text of a scene file. Raises LeaflightError.

    source: The file's name in errors. folder: Folder of the files that it names.
    """
    root = parse(text, source)
    both = ("name", "coordinates", "exposure", "meshes", "lights", "environment", "comment")
    if "volumes" in root:
        root.only("volumes", *both)
        isosurfaces = [_isosurfaces(item, folder) for item in root.named("volumes", "volume")]
        if not isosurfaces:
            raise root.error('"volumes" must name at least one volume')
    else:
        single = (
            "isosurface_albedo",
            "isosurface_emission",
            "isosurface_scattering",
            "isosurface_ior",
            "capped",
        )
        root.only(*single, *both)
        isosurfaces = [_material(root, "isosurfaces", "isosurface_")]
    return SceneDescription(
        name=root.text("name"),
        isosurfaces=isosurfaces,
        exposure=root.positive("exposure"),
        meshes=[_mesh(item, folder) for item in root.named("meshes", "mesh")],
        lights=[_light(item) for item in root.named("lights", "light")],
        environment=_environment(root.child("environment"), folder)
        if "environment" in root
        else None,
        coordinates=root.choice("coordinates", ("world", "box")),
    )


def _material(item: JsonObject, name: str, prefix: str = "") -> Isosurfaces:
    """Returns the Isosurfaces of an object whose keys have this prefix."""
    return Isosurfaces(
        name=name,
        albedo=item.ramp(prefix + "albedo", largest=1.0),
        emission=item.ramp(prefix + "emission", default=BLACK),
        scattering=item.choice(prefix + "scattering", SCATTERING, SCATTERING[0]),
        ior=item.number(prefix + "ior", *IOR, default=1.5),
        capped=item.flag("capped"),
    )


def _isosurfaces(item: JsonObject, folder: AnyPath) -> Isosurfaces:
    item.only(
        *("name", "source", "reading", "albedo", "emission", "scattering", "ior", "isovalues"),
        *("capped", "texture"),
    )
    material = _material(item, item.name)
    isovalues = source = None
    if "isovalues" in item:
        lo_hi = item.array("isovalues")
        if lo_hi.shape != (2,) or not lo_hi[0] < lo_hi[1]:
            raise item.error('"isovalues" must be two numbers, the lower first')
        isovalues = tuple(lo_hi.tolist())
    if "source" in item:
        source = item.text("source")
        if not is_generated(source):
            source = str(Path(folder) / source)
    reading = None
    if "reading" in item:
        item.child("reading").only(*OPTIONS)
        reading = item.get("reading")
    texture = texture_from(item.child("texture"), folder) if "texture" in item else None
    return replace(material, isovalues=isovalues, source=source, reading=reading, texture=texture)


def _mesh(item: JsonObject, folder: AnyPath) -> Mesh:
    item.only(
        *("name", "albedo", "vertices", "faces", "scattering", "ior", "emission", "texture", "uv")
    )
    vertices = item.points("vertices", 3)
    faces = item.faces("faces", (3, 4), len(vertices))
    if ("texture" in item) != ("uv" in item):
        present, missing = ("texture", "uv") if "texture" in item else ("uv", "texture")
        raise item.error(f'"{present}" also needs "{missing}"')
    textured = "texture" in item
    return Mesh(
        item.name,
        vertices,
        np.array(_triangles(faces), dtype=np.uint32),
        item.color("albedo", largest=1.0),
        item.choice("scattering", SCATTERING, SCATTERING[0]),
        item.number("ior", *IOR, default=1.5),
        item.color("emission", default=BLACK),
        _image(item, "texture", folder) if textured else None,
        _uv(item, faces) if textured else None,
    )


def _triangles(faces: list[list[Any]]) -> list[list[Any]]:
    """Splits each face of 3 or 4 corners into one or two triangles."""
    return [[face[0], face[i], face[i + 1]] for face in faces for i in range(1, len(face) - 1)]


def _uv(item: JsonObject, faces: list[list[int]]) -> Array:
    corners = item.items("uv")
    if len(corners) != len(faces) or any(
        not isinstance(uv, list) or len(uv) != len(face) for uv, face in zip(corners, faces)
    ):
        raise item.error('"uv" must hold a list for each face, with [u, v] for each of its corners')
    coordinates = JsonObject({"uv": _triangles(corners)}, item.where).array("uv")
    if coordinates.shape[1:] != (3, 2):
        raise item.error('"uv" must hold [u, v], two numbers, for each corner')
    return coordinates.astype(np.float32)


def _light(item: JsonObject) -> Light:
    kind = item.choice("type", LIGHTS, LIGHTS[0])
    read: dict[str, Callable[[JsonObject], Light]] = {
        "area": _area,
        "point": _point,
        "spot": _point,
        "sun": _sun,
    }
    return read[kind](item)


def _area(item: JsonObject) -> AreaLight:
    item.only("name", "type", "corner", "edge_u", "edge_v", "radiance", "ellipse")
    corner, edge_u, edge_v = (item.vector(key) for key in ("corner", "edge_u", "edge_v"))
    lengths = np.linalg.norm(edge_u) * np.linalg.norm(edge_v)
    if not np.linalg.norm(np.cross(edge_u, edge_v)) > 1e-6 * lengths:
        raise item.error(
            '"edge_u" and "edge_v" must span a rectangle, but they are parallel or zero'
        )
    if abs(np.dot(edge_u, edge_v)) > 1e-4 * lengths:
        raise item.error('"edge_u" and "edge_v" must be at right angles')
    radiance = item.color("radiance")
    return AreaLight(item.name, corner, edge_u, edge_v, radiance, item.flag("ellipse"))


def _point(item: JsonObject) -> PointLight:
    spot = item.text("type") == "spot"
    item.only(
        *("name", "type", "position", "radius", "intensity"),
        *(("axis", "angle", "blend", "cosine_falloff") if spot else ()),
    )
    cone = None
    if spot:
        angle = item.number("angle", 0, 180)
        if not angle > 0:
            raise item.error('"angle" must be above 0, or the spot does not shine')
        cone = Cone(
            item.direction("axis"),
            math.radians(angle),
            item.number("blend", 0, 1, default=0.0),
            item.flag("cosine_falloff"),
        )
    radius = item.number("radius", 0, np.inf, default=0.0)
    return PointLight(item.name, item.vector("position"), radius, item.color("intensity"), cone)


def _sun(item: JsonObject) -> SunLight:
    item.only("name", "type", "direction", "irradiance", "angle")
    angle = item.number("angle", 0, 180, default=0.0)
    if angle == 180:
        raise item.error('"angle" must be below 180 degrees')
    direction = item.direction("direction")
    return SunLight(item.name, direction, item.color("irradiance"), math.radians(angle))


def _environment(item: JsonObject, folder: AnyPath) -> Environment:
    item.only("name", "radiance", "image", "rotation", "world_to_image")
    matrix = np.array(IDENTITY)
    if "world_to_image" in item:
        matrix = item.array("world_to_image")
        if matrix.shape != (3, 3) or abs(np.linalg.det(matrix)) < 1e-9:
            raise item.error('"world_to_image" must be an invertible 3 x 3 matrix')
    if "rotation" in item:
        angle = math.radians(item.number("rotation", -np.inf, np.inf))
        cosine, sine = math.cos(angle), math.sin(angle)
        matrix = matrix @ [[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]]
    x, y, z = matrix.tolist()
    return Environment(
        item.text("name", "environment"),
        item.color("radiance"),
        _image(item, "image", folder) if "image" in item else None,
        (tuple(x), tuple(y), tuple(z)),
    )


def _image(item: JsonObject, key: str, folder: AnyPath) -> Array:
    """Returns an image file or an embedded image, float32 [row, column, 3], bottom row first."""
    value = item.get(key)
    if isinstance(value, str):
        try:
            return read_texture(Path(folder) / value)
        except LeaflightError as error:
            raise LeaflightError(f"{item.where}: {error}") from None
    image = item.child(key)
    image.only("width", "height", "pixels")
    width, height = (int(image.number(side, 1, 65536)) for side in ("width", "height"))
    pixels = unpacked(image, "pixels", 3 * width * height, np.dtype("<f4"))
    # Copy the array, because one over bytes is read-only.
    return pixels.reshape(height, width, 3).astype(np.float32)


def scene_to_json(description: SceneDescription) -> str:
    """Returns a text that scene_from_json turns into the same description again."""
    data = _plain(description) | {"coordinates": description.coordinates}
    data["volumes"] = [_plain(isosurfaces) for isosurfaces in description.isosurfaces]
    data["meshes"] = [_plain(mesh) for mesh in description.meshes]
    data["lights"] = [_light_data(light) for light in description.lights]
    if description.environment is not None:
        data["environment"] = _plain(description.environment)
    del data["isosurfaces"]
    return json.dumps(data, separators=(",", ":"))


# Keys of a scene file whose names differ from the fields.
KEYS = {"triangles": "faces"}


def _plain(item: Any) -> dict[str, Any]:
    """Returns the fields of a dataclass that differ from their defaults, as JSON data."""
    data = {}
    for field in fields(item):
        value = _json(getattr(item, field.name))
        if field.default is MISSING or value != _json(field.default):
            data[KEYS.get(field.name, field.name)] = value
    return data


def _json(value: object) -> object:
    if isinstance(value, VolumeTexture):
        return texture_data(value)
    if isinstance(value, np.ndarray):
        # Floating-point arrays [row, column, 3] are images; the last axis of uv is 2.
        return _embedded(value) if value.shape[2:] == (3,) else value.tolist()
    if isinstance(value, (list, tuple)):
        return [_json(item) for item in value]
    if isinstance(value, Real) and not isinstance(value, bool):
        return float(value)
    return value


def _embedded(image: Array) -> dict[str, object]:
    height, width, _ = image.shape
    return {"width": width, "height": height, "pixels": packed(image.astype(np.float32))}


def _light_data(light: Light) -> dict[str, Any]:
    data = _plain(light)
    if isinstance(light, PointLight):
        cone = data.pop("cone", None)
        data["type"] = "point" if cone is None else "spot"
        if cone is not None:
            data |= _plain(cone)
    elif isinstance(light, SunLight):
        data["type"] = "sun"
    if "angle" in data:
        # 14 digits are exact after conversion to radians and back.
        data["angle"] = float(f"{math.degrees(data['angle']):.14g}")
    return data
