# SPDX-License-Identifier: GPL-3.0-or-later
"""The types of lamps. Each neither blocks nor reflects light.

fitted(fit): Returns the lamp in world coordinates, from those of the box. core(): Returns the lamp
of the core. STRENGTH: Name of the field with its strength, a color.
"""

from dataclasses import astuple, dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import leaflight._core as _core

if TYPE_CHECKING:
    from .scene import Fit

Vector = tuple[float, float, float]
Color = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class AreaLight:
    """A rectangle, or the ellipse inscribed in it, that emits towards cross(edge_u, edge_v).

    radiance: Color in W/(m^2 sr).
    """

    name: str
    corner: Vector
    edge_u: Vector
    edge_v: Vector
    radiance: Color
    ellipse: bool = False

    STRENGTH: ClassVar[str] = "radiance"

    def fitted(self, fit: "Fit") -> "AreaLight":
        edge_u, edge_v = fit.vector(self.edge_u), fit.vector(self.edge_v)
        return replace(self, corner=fit.point(self.corner), edge_u=edge_u, edge_v=edge_v)

    def core(self) -> _core.AreaLight:
        return _core.AreaLight(*astuple(self))


@dataclass(frozen=True, eq=False)
class Cone:
    """The cone of a spot.

    axis: Unit vector.
    angle: Angle from edge to edge in radians, at most pi.
    blend: Part of the cone over which its edge is soft, 0..1.
    cosine_falloff: True if the intensity also falls with the cosine to the axis.
    """

    axis: Vector
    angle: float
    blend: float = 0.0
    cosine_falloff: bool = False


@dataclass(frozen=True, eq=False)
class PointLight:
    """A sphere that emits equally in all directions, or within a cone.

    intensity: Color in W/sr; on the axis of a spot.
    """

    name: str
    position: Vector
    radius: float
    intensity: Color
    cone: Cone | None = None

    STRENGTH: ClassVar[str] = "intensity"

    def fitted(self, fit: "Fit") -> "PointLight":
        r, g, b = (fit.scale**2 * x for x in self.intensity)
        place, radius = fit.point(self.position), fit.scale * self.radius
        return replace(self, position=place, radius=radius, intensity=(r, g, b))

    def core(self) -> _core.PointLight:
        cone: Any = () if self.cone is None else astuple(self.cone)
        return _core.PointLight(self.name, self.position, self.radius, self.intensity, *cone)


@dataclass(frozen=True, eq=False)
class SunLight:
    """Parallel light.

    direction: Unit vector in which light travels.
    irradiance: Irradiance in W/m^2 on a surface facing it.
    angle: Diameter of the sun's disc in radians, below pi.
    """

    name: str
    direction: Vector
    irradiance: Color
    angle: float = 0.0

    STRENGTH: ClassVar[str] = "irradiance"

    def fitted(self, fit: "Fit") -> "SunLight":
        return self

    def core(self) -> _core.SunLight:
        return _core.SunLight(*astuple(self))


Light = AreaLight | PointLight | SunLight
# Types of lamps by name.
LIGHTS: dict[str, type[Light]] = {kind.__name__: kind for kind in (AreaLight, PointLight, SunLight)}


def strengths_of(light: Light) -> Color:
    """Returns the strength (r, g, b) of a lamp of a scene, in the unit of its kind."""
    strengths: Color = getattr(light, light.STRENGTH)
    return strengths
