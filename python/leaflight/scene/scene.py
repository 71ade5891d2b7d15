# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as plain data: isosurfaces, meshes, lights and environment.

A color is (r, g, b), linear. A ramp is one color for all isovalues, or a list of stops (isovalue,
color). Stops ascend in the isovalue of that volume, in data units. A ramp is linear between stops
and constant beyond. Scene files hold the same data (scene_file.py).

The common isovalue c selects the isosurfaces that are seen together. With one volume it is the
isovalue. With several it is within 0..1, and a volume with the isovalues (lo, hi) shows lo + c (hi
- lo).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from typing import TYPE_CHECKING, Any, TypeVar

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..volume.first_isovalue import default_isovalue_range
from ..volume.volume import Volume
from .lights import Color, Light, Vector
from .volume_texture import VolumeTexture

if TYPE_CHECKING:
    from typing_extensions import TypeIs

Ramp = Color | list[tuple[float, Color]]

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class Isosurfaces:
    """The material of all isosurfaces of one volume.

    albedo: Ramp in 0..1. It is also the color of a mirror or of glass.
    emission: Ramp of radiance in W/(m^2 sr), from both sides.
    scattering: "diffuse", "mirror" or "glass".
    ior: Refractive index of the inside.
    isovalues: Isovalues (lo, hi), in data units, at the common isovalues 0 and 1 of several
        volumes. For a single volume it is the isovalue range to bake. None is
        default_isovalue_range(volume).
    capped: True closes the isosurfaces at the border of the volume (Volume.capped).
    source: Path of the volume, as on the command line. None if the caller gives the volume.
    reading: Options of read_volume() for the source, by name; or None.
    texture: Colors by another volume, which multiply the albedo; or None.
    """

    name: str
    albedo: Ramp
    emission: Ramp = (0.0, 0.0, 0.0)
    scattering: str = "diffuse"
    ior: float = 1.5
    isovalues: tuple[float, float] | None = None
    capped: bool = False
    source: str | None = None
    reading: dict[str, Any] | None = None
    texture: VolumeTexture | None = None

    def texture_on(self, field: _core.Field) -> _core.VolumeTexture | None:
        """Returns the texture for RadianceGrid.with_texture() of a grid of this field, or None."""
        return None if self.texture is None else self.texture.core().on(field)


@dataclass(frozen=True, eq=False)
class Mesh:
    """A mesh of the walls, with the same material on both sides.

    vertices: Positions, float32 (n, 3).
    triangles: Vertex numbers, uint32 (m, 3).
    albedo: Color in 0..1. It is also that of a mirror or of glass.
    scattering: "diffuse", "mirror" or "glass".
    ior: Refractive index of glass.
    emission: Radiance in W/(m^2 sr), from both sides.
    texture: Image that multiplies the albedo, linear in 0..1, float32 [row, column, 3], bottom row
        first.
    uv: Texture coordinates of each triangle's corners, float32 (m, 3, 2).
    """

    name: str
    vertices: Array
    triangles: Array
    albedo: Color
    scattering: str = "diffuse"
    ior: float = 1.5
    emission: Color = (0.0, 0.0, 0.0)
    texture: Array | None = None
    uv: Array | None = None


@dataclass(frozen=True, eq=False)
class Environment:
    """Light from infinity: a radiance in W/(m^2 sr) that multiplies the image, if there is one.

    image: Latitude-longitude image, float32 [row, column, 3], bottom row first. Its center column
        is seen along +x, its upper rows towards +z.
    world_to_image: Rotation of a direction before lookup, 3 x 3 as nested tuples.
    """

    name: str
    radiance: Color
    image: Array | None = None
    world_to_image: tuple[Vector, Vector, Vector] = IDENTITY


@dataclass(frozen=True, eq=False)
class SceneDescription:
    """A scene without its volumes.

    isosurfaces: One Isosurfaces for each volume, or a single one for all.
    exposure: Positive factor from radiance to the displayed color.
    meshes: List of Mesh.
    lights: List of AreaLight, PointLight and SunLight.
    environment: An Environment or None.
    coordinates: "world" or "box". In "box" the longest side of the box around all volumes is from
        -1 to 1 around its center, and intensities are at this scale (see fit_scene).
    """

    name: str
    isosurfaces: list[Isosurfaces]
    exposure: float
    meshes: list[Mesh]
    lights: list[Light]
    environment: Environment | None = None
    coordinates: str = "world"

    def colored_by(self, texture: VolumeTexture, volume: int = 0) -> "SceneDescription":
        """Returns the scene with white isosurfaces of a volume (its number) under a texture."""
        isosurfaces = list(self.isosurfaces)
        isosurfaces[volume] = replace(isosurfaces[volume], texture=texture, albedo=(1.0, 1.0, 1.0))
        return replace(self, isosurfaces=isosurfaces)


def match_isosurfaces(description: SceneDescription, volumes: Sequence[Volume]) -> SceneDescription:
    """Returns the description with one Isosurfaces per volume; several volumes get isovalues.

    A single Isosurfaces is copied to any number of volumes and takes their names. Raises
    LeaflightError if the numbers differ.
    """
    isosurfaces = list(description.isosurfaces)
    if len(isosurfaces) == 1 and len(volumes) > 1:
        isosurfaces = [replace(isosurfaces[0], name=volume.name, source=None) for volume in volumes]
    if len(isosurfaces) != len(volumes):
        raise LeaflightError(
            f'The scene "{description.name}" describes {len(isosurfaces)} volumes, but '
            f"{len(volumes)} are given: give as many."
        )
    if len(volumes) > 1:
        isosurfaces = [
            replace(one, isovalues=one.isovalues or default_isovalue_range(volume))
            for one, volume in zip(isosurfaces, volumes)
        ]
    return replace(description, isosurfaces=isosurfaces)


def fit_scene(
    description: SceneDescription, volumes: Volume | list[Volume] | tuple[Volume, ...]
) -> SceneDescription:
    """Returns the description in world coordinates; box coordinates are fitted to the volumes.

    volumes: A Volume or a list of them.
    Radiances do not change. A point light's intensity grows with the square of the scale, so that
    scenes of any size are equally bright.
    """
    if description.coordinates == "world":
        return description
    fit = Fit.around(volumes if isinstance(volumes, (list, tuple)) else [volumes])
    return fitted(description, fit)


def fitted(description: SceneDescription, fit: "Fit") -> SceneDescription:
    """Converts a description from box to world coordinates by a Fit."""
    return replace(
        description,
        meshes=[replace(mesh, vertices=fit.vertices(mesh.vertices)) for mesh in description.meshes],
        lights=[light.fitted(fit) for light in description.lights],
        coordinates="world",
    )


# A point in the plane or in space.
_Place = TypeVar("_Place", tuple[float, float], Vector)


@dataclass(frozen=True, eq=False)
class Fit:
    """The transformation from box to world coordinates, in space or in the plane."""

    center: Array
    scale: float

    @classmethod
    def around(cls, volumes: Sequence[Volume]) -> "Fit":
        bounds = np.array([volume.field().bounds for volume in volumes], dtype=np.float64)
        return cls.of_box(bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0))

    @classmethod
    def of_box(cls, low: Array, high: Array) -> "Fit":
        """Returns the Fit to the box between two corners, each (3,)."""
        return cls(0.5 * (low + high), 0.5 * float((high - low).max()))

    def vertices(self, vertices: Array) -> Array:
        return np.asarray(self.center + self.scale * vertices, np.float32)

    def point(self, p: _Place) -> _Place:
        return tuple((self.center + self.scale * np.asarray(p)).tolist())

    def vector(self, v: _Place) -> _Place:
        return tuple((self.scale * np.asarray(v)).tolist())


def is_color(ramp: Ramp) -> "TypeIs[Color]":
    """Returns True if a ramp is one color, not a list of stops."""
    return len(ramp) == 3 and all(isinstance(x, Real) for x in ramp)


def ramp_at(ramp: Ramp, isovalue: float) -> Array:
    """Returns the color (3,) of a ramp at an isovalue in data units."""
    if is_color(ramp):
        return np.array(ramp, dtype=np.float64)
    isovalues, colors = [stop[0] for stop in ramp], np.array([stop[1] for stop in ramp])
    return np.array([np.interp(isovalue, isovalues, channel) for channel in colors.T])


def isovalue_at(description: SceneDescription, volume: int, c: float) -> float:
    """Returns the isovalue, in data units, of a volume (its number) at a common isovalue."""
    if len(description.isosurfaces) == 1:
        return c
    isovalues = description.isosurfaces[volume].isovalues
    assert isovalues is not None
    lo, hi = isovalues
    return lo + c * (hi - lo)


def covered(
    description: SceneDescription,
    fields: Sequence[_core.Field],
    volume: int,
    c: float,
    points: Array,
) -> Array:
    """Returns a mask (n,) of world points (n, 3) inside other isosurfaces, except glass."""
    hidden = np.zeros(len(points), bool)
    for other, (field, material) in enumerate(zip(fields, description.isosurfaces, strict=True)):
        if other != volume and material.scattering != "glass":
            hidden |= field.sample(points) >= isovalue_at(description, other, c)
    return hidden


def core_scene(
    description: SceneDescription,
    fields: Sequence[_core.Field],
    isovalue_range: tuple[float, float],
) -> _core.Scene:
    """Returns the core's scene of a description in world coordinates, one Isosurfaces per field.

    fields: list of _core.Field. isovalue_range: (lo, hi) of the common isovalue.

    Raises LeaflightError.
    """
    ranges = [
        isosurfaces.isovalues if len(fields) > 1 else None
        for isosurfaces in description.isosurfaces
    ]
    volumes = [
        core_isosurfaces(_core.Volume, isosurfaces, field, isovalues)
        for isosurfaces, field, isovalues in zip(description.isosurfaces, fields, ranges)
    ]
    for volume, isosurfaces in zip(volumes, description.isosurfaces):
        if isosurfaces.texture is not None:
            volume.set_texture(isosurfaces.texture.core())
    meshes = [_core_mesh(mesh) for mesh in description.meshes]
    lights = [light.core() for light in description.lights]
    return _core.Scene(volumes, meshes, lights, isovalue_range, _core_environment(description))


# Types of the core, in space or in the plane.
_Field = TypeVar("_Field")
_Volume = TypeVar("_Volume")
_Stops = list[tuple[float, Sequence[float]]]


def core_isosurfaces(
    kind: Callable[[str, _Field, _Stops, _Stops, str, float, float, float], _Volume],
    isosurfaces: Isosurfaces,
    field: _Field,
    isovalues: tuple[float, float] | None = None,
) -> _Volume:
    """Returns the core's volume, a kind (_core.Volume or Volume2), of a field.

    isovalues: (lo, hi) at the common isovalues 0 and 1; None if the common isovalue is the
        isovalue.
    """
    lo, hi = isovalues or (0.0, 1.0)

    def stops(ramp: Ramp) -> _Stops:
        stops = [(lo, ramp)] if is_color(ramp) else ramp
        return [((isovalue - lo) / (hi - lo), tuple(color)) for isovalue, color in stops]

    return kind(
        isosurfaces.name,
        field,
        stops(isosurfaces.albedo),
        stops(isosurfaces.emission),
        isosurfaces.scattering,
        isosurfaces.ior,
        lo,
        hi - lo,
    )


def _core_mesh(mesh: Mesh) -> _core.Mesh:
    return _core.Mesh(
        mesh.name,
        mesh.vertices,
        mesh.triangles,
        mesh.albedo,
        mesh.scattering,
        mesh.ior,
        mesh.emission,
        _core_texture(mesh.texture, mesh.name),
        mesh.uv,
    )


def _core_texture(pixels: Array | None, name: str) -> _core.Texture | None:
    try:
        return None if pixels is None else _core.Texture(pixels)
    except LeaflightError as error:
        raise LeaflightError(f'The image of "{name}" cannot be used: {error}') from None


def _core_environment(description: SceneDescription) -> _core.Environment | None:
    environment = description.environment
    if environment is None:
        return None
    image = _core_texture(environment.image, environment.name)
    return _core.Environment(
        environment.name, environment.radiance, image, environment.world_to_image
    )
