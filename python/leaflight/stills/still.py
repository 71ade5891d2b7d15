# SPDX-License-Identifier: GPL-3.0-or-later
"""still(): ray-traces one isosurface with its baked light."""

from collections.abc import Sequence

import leaflight._core as _core
import numpy as np

from .._core import LeaflightError
from ..arrays import Array
from ..bake.baked import Bake
from ..progress_bar import with_progress
from ..scene.scene import ramp_at
from ..volume.setting_error import SettingError
from .camera import Camera
from .first_view import camera_around_bake
from .lamps import headlight, lamps_of
from .walls import SeenWalls

# Rays per batch, which bounds the memory and the delay of a cancel.
_RAYS = 1 << 18
_LARGEST = 16384
# Brightness of a white back that faces the viewer, if its light was not baked.
UNBAKED = 0.3


@with_progress("still")
def still(
    bake: Bake,
    isovalue: float,
    camera: Camera | None = None,
    size: tuple[int, int] = (1280, 720),
    samples: int = 2,
    walls: bool = True,
    local: bool = False,
    *,
    progress: _core.Progress | None = None,
) -> Array:
    """Renders a picture of a Bake, float32 [row, column, RGBA], top row first.

    RGB is linear radiance in W/(m^2 sr), times alpha, the covered share of a pixel. Rays hit the
    isosurface itself, not a mesh of it, and look up the light there. Backs that were not baked are
    shaded by a light at the camera, which shows only their shape.

    isovalue: The common isovalue (see Bake), of all volumes.
    camera: A Camera. None frames the isosurface (first_view.py).
    size: Size (width, height) in pixels.
    samples: Number of rays along each side of a pixel.
    walls: True shows the scene's meshes, except those that hide the volumes. Without baked light
        they are shaded locally.
    local: True uses local shading (lamps.py) for everything.
    progress: As for bake().
    Raises LeaflightError, Cancelled.
    """
    width, height = size
    if not (0 < width <= _LARGEST and 0 < height <= _LARGEST):
        raise SettingError(
            f"The size of the picture is {width} x {height} pixels: choose 1 to {_LARGEST} for "
            "each side.",
            "size",
        )
    if not 1 <= samples <= 16:
        raise SettingError(
            f"The number of rays per side of a pixel is {samples}: choose 1 to 16.", "samples"
        )
    check_diffuse(bake)
    bake.check_isovalue(isovalue)
    camera = camera or camera_around_bake(bake, isovalue=isovalue, size=size)
    progress = progress or _core.Progress()
    seen = SeenWalls(bake, isovalue, np.asarray(camera.position), local) if walls else None
    isosurfaces = [
        SeenIsosurface(bake, number, isovalue, local) for number in range(len(bake.volumes))
    ]
    picture = np.empty((height, width, 4), np.float32)
    rows = max(1, _RAYS // (width * samples * samples))
    for top in range(0, height, rows):
        if progress.cancelled:
            raise _core.Cancelled("The still was cancelled.")
        block = range(top, min(top + rows, height))
        directions = camera.directions(width, height, block, samples)
        found = _seen(isosurfaces, seen, camera.position, directions.reshape(-1, 3))
        found = found.reshape(len(block), samples, width, samples, 4)
        picture[top : block.stop] = found.mean(axis=(1, 3))
    return picture


def check_diffuse(bake: Bake) -> None:
    """Raises LeaflightError if isosurfaces are mirrors or glass, which store no light."""
    for isosurfaces in bake.scene.isosurfaces:
        if isosurfaces.scattering != "diffuse":
            raise LeaflightError(
                f'"{isosurfaces.name}" is a mirror or glass, so its appearance depends on the '
                "view: render it in Blender."
            )


def back_side(bake: Bake, volume: int) -> str:
    """Returns the state of a volume's back: "baked", "dark" or "local" (shaded locally)."""
    if bake.grids[volume].has_back:
        return "baked"
    return "dark" if bake.provenance.both_sides else "local"


class SeenIsosurface:
    """The isosurface of one volume with its light."""

    def __init__(self, bake: Bake, volume: int, isovalue: float, local: bool = False) -> None:
        self._field, self._grid = bake.volumes[volume].field(), bake.grids[volume]
        self._own = bake.isovalue_of(volume, isovalue)
        self._local, self._back = local, back_side(bake, volume)
        self._exposure = bake.scene.exposure
        self._isosurfaces, self._lamps = bake.scene.isosurfaces[volume], lamps_of(bake.scene)

    def hits(self, origins: Array, directions: Array) -> tuple[Array, Array]:
        """Returns (distances (n,), infinite for none; radiance (n, 3)) for rays (n, 3)."""
        distances, is_back = _core.isosurface_hits(self._field, origins, directions, self._own)
        radiance = np.zeros((len(origins), 3))
        hit = np.isfinite(distances)
        points = origins[hit] + distances[hit, None] * directions[hit]
        radiance[hit] = self._radiance(points, is_back[hit] == 1, origins[hit])
        return distances, radiance

    def _radiance(self, points: Array, is_back: Array, eyes: Array) -> Array:
        found = np.zeros((len(points), 3))
        if self._local:
            shaded = np.ones(len(points), bool)
        else:
            found[~is_back] = self._grid.lookup(self._field, points[~is_back])
            if self._back == "baked":
                found[is_back] = self._grid.lookup(self._field, points[is_back], True)
            shaded = is_back & (self._back == "local")
        if shaded.any():
            normals = _core.normals(self._field, points[shaded]).astype(np.float64)
            normals[is_back[shaded]] *= -1.0
            albedo, emission = (
                ramp_at(ramp, self._own)
                for ramp in (self._isosurfaces.albedo, self._isosurfaces.emission)
            )
            if self._isosurfaces.texture is not None:
                albedo = albedo * self._isosurfaces.texture.at(points[shaded])
            if self._local:
                light = self._lamps.irradiance(points[shaded], normals, eyes[shaded])
                found[shaded] = albedo * light + emission
            else:
                facing = headlight(points[shaded], normals, eyes[shaded])
                found[shaded] = UNBAKED / self._exposure * albedo * facing
        return found


def _seen(
    isosurfaces: Sequence[SeenIsosurface],
    walls: SeenWalls | None,
    eye: Sequence[float],
    directions: Array,
) -> Array:
    """Returns RGBA (n, 4) of the nearest hit on each ray."""
    origins = np.broadcast_to(np.asarray(eye, np.float64), directions.shape)
    origins = np.ascontiguousarray(origins)
    nearest, radiance = np.full(len(directions), np.inf), np.zeros((len(directions), 3))
    surfaces: list[SeenIsosurface | SeenWalls] = [*isosurfaces]
    if walls is not None:
        surfaces.append(walls)
    for surface in surfaces:
        distances, found = surface.hits(origins, directions)
        nearer = distances < nearest
        nearest[nearer], radiance[nearer] = distances[nearer], found[nearer]
    return np.concatenate([radiance, np.isfinite(nearest)[:, None]], axis=1)
