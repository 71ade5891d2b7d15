# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a bake is from the path-traced truth on one isosurface."""

import time
from dataclasses import dataclass

import numpy as np

from . import _core
from ._core import LeaflightError

# Random rays by which a point shows itself to the outside.
EXPOSURE_RAYS = 32


def compare(
    bake, isovalue, points=3000, spp=1024, seed=0, threads=0, progress=None, volume=0, back=False
):
    """Compares baked with path-traced radiance at random points of one volume's isosurface.

    back: on its inner side. `isovalue` is the leaf coordinate, as everywhere in a Bake.

    The points are distributed by area over the marching-cubes triangles; the bake is looked up
    where the mesh is, the reference is traced from the leaf itself. Returns a dict with

    rms_percent              RMS error of the colours in percent (thesis Eq. 4.11, corrected: a
                             colour is radiance times exposure, clamped to 0..1)
    relative_rms             RMS error of the radiance over the mean radiance, nothing clamped;
                             None where all is dark
    reference_noise_percent  what the reference's own noise adds to rms_percent (RMS standard error)
    mean_radiance            mean of the reference colours before clamping
    exposed                  the same four, and their points, over the points that can be seen from
                             outside the volume; a scan hides most of an isosurface in the dark;
                             None of the inner side
    and points, spp, isovalue, triangles, bake_seconds, reference_seconds.
    Raises LeaflightError, Cancelled.
    """
    if points < 1 or spp < 2:
        raise LeaflightError("compare needs at least 1 point and 2 samples per point.")
    surface = bake.surface(isovalue, volume, back)
    if len(surface.triangles) == 0:
        raise LeaflightError(
            f"Isovalue {isovalue:g} has no surface inside the data; choose another one."
        )
    positions = random_points(surface.vertices, surface.triangles, points, seed)
    baked = bake.radiance(positions, volume, back).astype(np.float64)

    start = time.perf_counter()
    field, own = bake.volumes[volume].field(), bake.isovalue_of(volume, isovalue)
    on_leaf = _core.project_to_leaf(field, positions, own)
    reference, standard_error = (
        array.astype(np.float64)
        for array in bake.reference(
            on_leaf, isovalue, spp, seed, threads, progress, volume=volume, back=back
        )
    )
    reference_seconds = time.perf_counter() - start

    samples = _Samples(baked, reference, standard_error)
    exposure = bake.scene.exposure
    exposed = None
    if not back:
        seen = _core.exposed(field, on_leaf, own, EXPOSURE_RAYS, seed) > 0
        exposed = samples.only(seen).errors(exposure)
    return {
        "isovalue": float(isovalue),
        "spp": int(spp),
        "triangles": len(surface.triangles),
        **samples.errors(exposure),
        "exposed": exposed,
        "bake_seconds": bake.statistics["seconds"],
        "reference_seconds": reference_seconds,
    }


@dataclass(frozen=True, eq=False)
class _Samples:
    """Radiance at some points, (n, 3) each."""

    baked: np.ndarray
    reference: np.ndarray
    standard_error: np.ndarray

    def only(self, mask):
        return _Samples(self.baked[mask], self.reference[mask], self.standard_error[mask])

    def errors(self, exposure):
        """The figures that compare() documents; None where there are no points."""
        if len(self.baked) == 0:
            names = ("rms_percent", "relative_rms", "reference_noise_percent", "mean_radiance")
            return {"points": 0, **dict.fromkeys(names)}
        mean = float(self.reference.mean())
        return {
            "points": len(self.baked),
            "rms_percent": rms_percent(self.baked, self.reference, exposure),
            "relative_rms": _rms(self.baked - self.reference) / mean if mean > 0 else None,
            "reference_noise_percent": noise_percent(self.standard_error, exposure),
            "mean_radiance": mean * exposure,
        }


def rms_percent(radiance, reference, exposure):
    """RMS error of colours in percent (thesis Eq. 4.11, corrected), of radiance arrays (..., 3).

    A colour is radiance times exposure, clamped to 0..1.
    """
    colours, truth = (np.clip(np.float64(x) * exposure, 0, 1) for x in (radiance, reference))
    return 100.0 * _rms(colours - truth)


def noise_percent(standard_error, exposure):
    """What errors of a reference radiance, an array, add to rms_percent: squares add up."""
    return 100.0 * exposure * _rms(np.float64(standard_error))


def random_points(vertices, triangles, count, seed):
    """Points (count, 3), float64, uniformly distributed over the area of the triangles."""
    rng = np.random.default_rng(seed)
    a, b, c = (vertices[triangles[:, k]].astype(np.float64) for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    cumulative = np.cumsum(areas)
    chosen = np.searchsorted(cumulative, rng.random(count) * cumulative[-1], side="right")
    chosen = np.minimum(chosen, len(triangles) - 1)
    root, v = np.sqrt(rng.random(count))[:, None], rng.random(count)[:, None]
    a, b, c = a[chosen], b[chosen], c[chosen]
    return a + root * (b - a) + root * v * (c - b)


def _rms(values):
    return float(np.sqrt(np.mean(np.square(values))))
