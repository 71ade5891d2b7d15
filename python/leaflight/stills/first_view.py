# SPDX-License-Identifier: GPL-3.0-or-later
"""The first view of a bake: isovalue, direction and distance.

The camera looks into a room from its open side, at a patient from the front, and at other objects
from where their silhouette is largest. The isosurface fills the picture.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Bake
from ..scene.lights import Vector
from ..volume.first_isovalue import default_isovalue
from .camera import ANGLE, Camera, bounds_of

# Elevation of the camera in degrees, and that for flat objects.
ELEVATION, ELEVATION_OF_FLAT = 10.0, 50.0
# Share of the picture's height or width that the front of the isosurface's box fills.
FILLED = 0.8
# Share of the vertices on each side that may be dust; the frame ignores them.
DUST = 0.002
# Ratios by which another silhouette must be larger to be chosen.
CLEARLY_LARGER, FLAT = 1.2, 2.5

_MOST_POINTS = 200_000
_CELLS = 64
_AZIMUTHS = (0.0, 90.0, 180.0, 270.0)
# Azimuth of a patient's front; readers orient patients to right, front and up.
_FRONT = 180.0


@dataclass(frozen=True)
class Framing:
    """The position of an isosurface in a picture of any size.

    target: Middle of the isosurface in the world.
    back: Unit direction from the middle to the viewer.
    up: Upright direction.
    half: Half extents to the right, up and towards the viewer.
    angle: Angle of view across the picture's shorter side, in degrees.
    """

    target: Vector
    back: Vector
    half: Vector
    up: Vector = (0.0, 0.0, 1.0)
    angle: float = ANGLE

    def camera(self, size: tuple[int, int] = (1, 1), zoom: float = 1.0) -> Camera:
        """Returns the Camera for which the isosurface fills its share of a picture of this size."""
        if not zoom > 0.0:
            raise LeaflightError(f"The zoom is {zoom:g}: choose a positive number.")
        width, height = np.maximum(size, 1)
        tangent = math.tan(math.radians(0.5 * self.angle)) / min(width, height)
        wide, high, deep = self.half
        distance = deep + max(wide / width, high / height) / tangent / FILLED
        position = np.add(self.target, np.multiply(self.back, distance / zoom))
        return Camera(tuple(position.tolist()), self.target, self.up, self.angle)


def default_isovalue_of(bake: Bake, volume: int = 0) -> float:
    """Returns the common isovalue of a Bake that is shown first, within the range."""
    bake.check_volume(volume)
    low, high = bake.isovalues
    middle = 0.5 * (low + high)
    if len(bake.volumes) > 1:
        return middle
    isovalue = default_isovalue(bake.volumes[volume])
    return isovalue if low < isovalue < high else middle


def camera_around_bake(
    bake: Bake,
    azimuth: float | None = None,
    elevation: float | None = None,
    zoom: float = 1.0,
    isovalue: float | None = None,
    size: tuple[int, int] = (1, 1),
) -> Camera:
    """Returns a Camera with the isosurface of a Bake in a picture of this size, see framing()."""
    return framing(bake, isovalue, azimuth, elevation).camera(size, zoom)


def framing(
    bake: Bake,
    isovalue: float | None = None,
    azimuth: float | None = None,
    elevation: float | None = None,
) -> Framing:
    """Returns the Framing of the isosurfaces of a Bake's volumes.

    isovalue: None is the default one.
    azimuth: Degrees around +z, 0 from -y. None chooses.
    elevation: Degrees above the horizon. None chooses.
    Raises LeaflightError.
    """
    isovalue = default_isovalue_of(bake) if isovalue is None else isovalue
    points = _points(bake, isovalue)
    free = _free_azimuths(bake, points.mean(axis=0))
    is_patient = any(volume.patient for volume in bake.volumes)
    if azimuth is None and is_patient and _FRONT in free:
        azimuth = _FRONT
    if azimuth is None:
        azimuth = _largest([(_silhouette(points, _back(each, 0.0)), each) for each in free])
    if elevation is None:
        side, top = (_silhouette(points, _back(azimuth, height)) for height in (0.0, 89.9))
        is_flat = not is_patient and top > FLAT * side
        elevation = ELEVATION_OF_FLAT if is_flat else ELEVATION
    if not -90.0 < elevation < 90.0:
        raise LeaflightError(
            f"The elevation of the view is {elevation:g} degrees: choose between -90 and 90."
        )
    back = _back(azimuth, elevation)
    axes = Camera(tuple(back), (0.0, 0.0, 0.0)).axes() * [[1.0], [1.0], [-1.0]]
    low, high = np.quantile(points @ axes.T, (DUST, 1.0 - DUST), axis=0)
    half = np.maximum(0.5 * (high - low), 1e-6 * max(high - low))
    target = 0.5 * (high + low) @ axes
    return Framing(tuple(target.tolist()), tuple(back.tolist()), tuple(half.tolist()))


def _points(bake: Bake, isovalue: float) -> Array:
    """Returns vertices (n, 3) of the isosurfaces, thinned if there are many.

    Empty isosurfaces give the corners of the volumes.
    """
    found = [
        _core.contour(volume.field(), bake.isovalue_of(number, isovalue), normals=False)[0]
        for number, volume in enumerate(bake.volumes)
    ]
    points: Array = np.concatenate(found).astype(np.float64)
    if len(points) == 0:
        return np.array(bounds_of(bake))
    return points[:: max(1, len(points) // _MOST_POINTS)]


def _back(azimuth: float, elevation: float) -> Array:
    a, e = math.radians(azimuth), math.radians(elevation)
    return np.array([math.sin(a) * math.cos(e), -math.cos(a) * math.cos(e), math.sin(e)])


def _free_azimuths(bake: Bake, middle: Array) -> list[float]:
    """Returns azimuths from which no mesh hides the center; if some face a wall, only these."""
    origins = np.repeat(middle[None], len(_AZIMUTHS), axis=0)
    directions = np.array([_back(azimuth, 0.0) for azimuth in _AZIMUTHS])
    is_free = np.ones(len(_AZIMUTHS), bool)
    for mesh in bake.scene.meshes:
        vertices = np.ascontiguousarray(mesh.vertices, np.float32)
        triangles = np.ascontiguousarray(mesh.triangles, np.uint32)
        core = _core.Mesh(mesh.name, vertices, triangles, (0.0, 0.0, 0.0))
        is_free &= np.isinf(_core.mesh_hits(core, origins, directions)[0])
    faces_a_wall = is_free & ~np.roll(is_free, 2)
    chosen = faces_a_wall if faces_a_wall.any() else is_free if is_free.any() else ~is_free
    return [azimuth for azimuth, use in zip(_AZIMUTHS, chosen) if use]


def _largest(candidates: Sequence[tuple[float, float]]) -> float:
    """Returns the first item of (area, item), unless another area is clearly larger."""
    area, what = candidates[0]
    for other, of_other in candidates[1:]:
        if other > CLEARLY_LARGER * area:
            area, what = other, of_other
    return what


def _silhouette(points: Array, back: Array) -> int:
    """Returns the area that points cover as seen from a direction, in equal squares."""
    size = float(np.ptp(points, axis=0).max()) / _CELLS
    right, up, _ = Camera(tuple(back), (0.0, 0.0, 0.0)).axes()
    seen = points @ np.stack([right, up], axis=1)
    cells = ((seen - seen.min(axis=0)) / max(size, 1e-30)).astype(np.int64)
    return len(np.unique(cells[:, 0] * 4 * _CELLS + cells[:, 1]))
