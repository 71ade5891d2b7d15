# SPDX-License-Identifier: GPL-3.0-or-later
"""Path-traced radiance at vertices of isosurfaces, against which the report measures errors."""

import time
from dataclasses import dataclass

import numpy as np
from leaflight import _core
from leaflight.bake.color_error import noise_percent, rms_percent
from leaflight.scene.scene import core_scene, covered, isovalue_at


@dataclass(frozen=True, eq=False)
class Isosurface:
    """An isosurface and some of its vertices.

    volume: its number; isovalue: the common isovalue; vertices: float32 (n, 3), world; normals and
    triangles: of the mesh; chosen: (m,), numbers of the judged vertices.
    """

    volume: int
    isovalue: float
    vertices: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    chosen: np.ndarray

    @property
    def points(self):
        return self.vertices[self.chosen]


@dataclass(frozen=True, eq=False)
class Isosurfaces:
    """The reference that judges bakes; all isosurfaces count equally.

    truth, standard_error: float32 (n, 3), the radiance of paths at each of the points, one surface
    after the other, and its standard error
    exposure: the exposure of the scene
    seconds: seconds of a processor for one path at one point
    """

    surfaces: list
    truth: np.ndarray
    standard_error: np.ndarray
    exposure: float
    paths: int
    seconds: float

    @property
    def noise(self):
        """Noise of the reference, which is part of error() as a sum of squares."""
        return noise_percent(self.truth, self.standard_error, self.exposure)

    @property
    def color(self):
        """The mean color."""
        return float(np.clip(self.truth * self.exposure, 0, 1).mean())

    def seconds_to(self, error):
        """Returns the processor seconds in which paths light one point with this error().

        The reference's own noise is subtracted from the error.
        """
        own = max(error**2 - self.noise**2, 1e-12)
        return self.seconds * self.paths * self.noise**2 / own

    def radiance(self, baked):
        """Returns the radiance (n, 3) of a Bake at the points."""
        return np.concatenate([baked.radiance(one.points, one.volume) for one in self.surfaces])

    def error(self, radiance):
        """Returns RMS error in percent (thesis Eq. 4.11, corrected) of a radiance (n, 3)."""
        return rms_percent(radiance, self.truth, self.exposure)

    def spread(self, radiances):
        """Returns the RMS deviation, in percent, among bakes that differ only in their seed."""
        colors = np.clip(np.float64(radiances) * self.exposure, 0, 1)
        return 100.0 * float(np.sqrt(colors.var(axis=0, ddof=1).mean()))


def isosurfaces(volumes, scene, isovalue_range, isovalues, vertices, paths, seed):
    """Returns the Isosurfaces of each volume at each common isovalue; some are empty.

    scene: a scene in world coordinates, with Isosurfaces for each volume
    isovalue_range: (lo, hi) of the common isovalue
    vertices: number of vertices to judge; none is inside another volume's isosurface
    """
    fields = [volume.field() for volume in volumes]
    rng = np.random.default_rng(seed)
    share = max(1, vertices // (len(fields) * len(isovalues)))
    surfaces = []
    for number, field in enumerate(fields):
        for isovalue in isovalues:
            mesh = _core.contour(field, isovalue_at(scene, number, isovalue))
            points, normals, triangles = mesh
            seen = np.flatnonzero(~covered(scene, fields, number, isovalue, points))
            chosen = np.sort(rng.choice(seen, min(share, len(seen)), replace=False))
            surfaces.append(Isosurface(number, isovalue, points, normals, triangles, chosen))
    surfaces = [one for one in surfaces if len(one.chosen)]
    core = core_scene(scene, fields, isovalue_range)

    def traced(one):
        own = isovalue_at(scene, one.volume, one.isovalue)
        points = _core.project_to_isosurface(fields[one.volume], one.points, own)
        return _core.reference(core, points, one.isovalue, paths, seed, volume=one.volume)

    start = time.process_time()
    found = [np.concatenate(parts) for parts in zip(*map(traced, surfaces))]
    seconds = (time.process_time() - start) / (paths * len(found[0]))
    truth, standard_error = found
    return Isosurfaces(surfaces, truth, standard_error, scene.exposure, paths, seconds)
