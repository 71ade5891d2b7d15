# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of flatland: walls and lamps around isolines, as plain data and as scene files.

A scene file of flatland is a JSON object. It has the keys "name", "coordinates",
"isosurface_albedo", "exposure" and "comment" of scene_file.py, and these. Points are [x, y].

meshes: List of {"name", "albedo": [r, g, b] in 0..1, "vertices": [[x, y], ...], "segments": [[i,
    j], ...]}.
lights: List of {"name", "corner", "edge": [x, y], "radiance": [r, g, b] in W/(m rad)}. Each emits
    to the left of its edge.
"""

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..io.json_object import JsonObject, parse, read_text
from ..paths import AnyPath
from ..scene.lights import Color
from ..scene.scene import Fit, Isosurfaces, core_isosurfaces
from ..volume.volume import Volume


@dataclass(frozen=True, eq=False)
class Wall:
    """Segments of one color: vertices float32 (n, 2), segments uint32 (m, 2), albedo in 0..1."""

    name: str
    vertices: Array
    segments: Array
    albedo: Color


@dataclass(frozen=True, eq=False)
class Lamp:
    """A segment that emits to the left of its edge, with a radiance in W/(m rad), linear RGB."""

    name: str
    corner: tuple[float, float]
    edge: tuple[float, float]
    radiance: Color


@dataclass(frozen=True, eq=False)
class FlatScene:
    """The material of isolines, and the scene around them. See SceneDescription for coordinates."""

    name: str
    isosurfaces: Isosurfaces
    exposure: float
    walls: list[Wall]
    lamps: list[Lamp]
    coordinates: str = "world"


def load_flat_scene(path: AnyPath) -> FlatScene:
    """Reads a scene file of flatland. Raises LeaflightError naming the object that is wrong."""
    root = parse(read_text(path), str(path))
    root.only("name", "coordinates", "isosurface_albedo", "exposure", "meshes", "lights", "comment")
    return FlatScene(
        root.text("name"),
        Isosurfaces("isolines", root.ramp("isosurface_albedo", largest=1.0)),
        root.positive("exposure"),
        [_wall(item) for item in root.named("meshes", "mesh")],
        [_lamp(item) for item in root.named("lights", "light")],
        root.choice("coordinates", ("world", "box")),
    )


def flat_scene_to_json(scene: FlatScene) -> str:
    """Returns the text of the scene file of a FlatScene."""
    return json.dumps(
        {
            "name": scene.name,
            "coordinates": scene.coordinates,
            "isosurface_albedo": scene.isosurfaces.albedo,
            "exposure": scene.exposure,
            "meshes": [
                {
                    "name": wall.name,
                    "albedo": wall.albedo,
                    "vertices": np.asarray(wall.vertices).tolist(),
                    "segments": np.asarray(wall.segments).tolist(),
                }
                for wall in scene.walls
            ],
            "lights": [asdict(lamp) for lamp in scene.lamps],
        }
    )


def flat_box() -> FlatScene:
    """Returns the box of thesis chapter 3, its lamp at the bottom (flatland_bump_box.json)."""
    folder = Path(__file__).parent.parent / "scenes"
    return load_flat_scene(folder / "flatland_bump_box.json")


def _wall(item: JsonObject) -> Wall:
    item.only("name", "albedo", "vertices", "segments")
    vertices = item.points("vertices", 2, axes="xy")
    segments = item.faces("segments", (2,), len(vertices))
    return Wall(
        item.name,
        vertices,
        np.array(segments, dtype=np.uint32),
        item.color("albedo", largest=1.0),
    )


def _lamp(item: JsonObject) -> Lamp:
    item.only("name", "corner", "edge", "radiance")
    edge = item.vector("edge", 2)
    if not any(edge):
        raise item.error('"edge" must be longer than 0, or the lamp does not shine')
    return Lamp(item.name, item.vector("corner", 2), edge, item.color("radiance"))


def fit_flat_scene(scene: FlatScene, volume: Volume) -> FlatScene:
    """Returns the scene in world coordinates; box coordinates are fitted to the height field."""
    if scene.coordinates == "world":
        return scene
    fit = Fit.around([volume])
    return replace(
        scene,
        walls=[replace(wall, vertices=fit.vertices(wall.vertices)) for wall in scene.walls],
        lamps=[
            replace(lamp, corner=fit.point(lamp.corner), edge=fit.vector(lamp.edge))
            for lamp in scene.lamps
        ],
        coordinates="world",
    )


def core_flat_scene(
    scene: FlatScene, field: _core.Field2, isovalue_range: tuple[float, float]
) -> _core.Scene2:
    """Returns the core's scene of a scene in world coordinates. Raises LeaflightError."""
    if scene.isosurfaces.texture is not None:
        raise LeaflightError(
            f"{scene.isosurfaces.texture.name}: no image can color the isolines of another: leave "
            "the texture out."
        )
    walls = [
        _core.Mesh2(wall.name, wall.vertices, wall.segments, wall.albedo) for wall in scene.walls
    ]
    lamps = [
        _core.AreaLight2(lamp.name, lamp.corner, lamp.edge, lamp.radiance) for lamp in scene.lamps
    ]
    volume = core_isosurfaces(_core.Volume2, scene.isosurfaces, field)
    return _core.Scene2([volume], walls, lamps, isovalues=isovalue_range)
