# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures error against time on the bump box: leaflight.bake, the thesis's methods, and Cycles.

The effort of leaflight.bake is its texels per axis; it takes as many passes as its error needs. The
effort of the thesis's methods is their rays per texel, which doubles along each curve, like the
photons. Bakes are repeated with other seeds, curve after curve, so that other work of the machine
slows all equally. Time is processor time of all threads, because other work affects it less than
wall-clock time.
"""

import contextlib
import sys
import tempfile
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from leaflight.bake.bake import bake
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.cycles import bake_vertices
from leaflight.scene.scene import fit_scene, match_isosurfaces
from leaflight.volume.volume import bump_box

from .bake import bake as bake_fixed_samples
from .isosurfaces import isosurfaces
from .settings import Scattered

ISOVALUES = (20.0, 47.0, 100.0)
# Photons per ray of a texel, as in the defaults of `thesis.bake`.
PHOTONS = 2_000_000 // 32
# Rays per scattered sample.
RAYS = 32
BAKE = "leaflight.bake"
CYCLES = "Cycles, one isosurface"
# Name of the curve with the default estimator of thesis.bake.
GATHER = "gather"
# Unit of the samples of a curve, by its group; other groups have rays per texel.
UNITS = {"bake": "texels per axis", "Cycles": "paths per corner"}


@dataclass(frozen=True)
class CurveEffort:
    """The effort of the curves.

    texels: nodes per axis, and texels per axis of the thesis's methods
    resolutions: texels per axis along the curve of leaflight.bake
    rays: rays per texel along the curves of the thesis's methods
    slow_rays: rays per texel along the curves of slow estimators
    cycles: samples a corner of Cycles
    vertices: vertices of the reference in all
    paths: paths of the reference at each vertex
    """

    texels: int = 100
    resolutions: tuple = (25, 50, 100, 199)
    rays: tuple = (1, 2, 4, 8, 16, 32, 64)
    slow_rays: tuple = (1, 2, 4, 8)
    cycles: tuple = (1, 2, 4, 8, 16, 32, 64, 128, 256)
    repetitions: int = 3
    vertices: int = 1500
    paths: int = 65_536


QUICK_CURVES = CurveEffort(
    texels=40,
    resolutions=(10, 20, 40, 79),
    rays=(1, 2, 4, 8, 16, 32),
    slow_rays=(1, 2, 4, 8),
    cycles=(1, 2, 4, 8, 16, 32, 64, 128),
    repetitions=2,
    vertices=600,
    paths=16_384,
)


@dataclass(frozen=True)
class Kind:
    """A kind of bake along a curve, and the curve's group."""

    name: str
    group: str
    estimator: str = "gather"
    strategy: str = None
    slow: bool = False

    def efforts(self, effort):
        """Returns the samples along the curve."""
        if self.group == "bake":
            return effort.resolutions
        return [rays for rays in effort.rays if not self.slow or rays in effort.slow_rays]


KINDS = (
    Kind(BAKE, "bake"),
    Kind("gather", "estimators"),
    Kind("path", "estimators", "path"),
    Kind("volumetric", "estimators", "volumetric"),
    Kind("thesis", "estimators", "thesis", slow=True),
    Kind("uniform", "strategies", strategy="uniform"),
    Kind("stratified", "strategies", strategy="stratified"),
    Kind("importance", "strategies", strategy="importance"),
)


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a curve.

    samples: see UNITS; costs: a Cost for each repetition. error: RMS in percent over all
    repetitions; noise: its random part.
    """

    samples: int
    costs: list
    error: float
    noise: float

    @property
    def seconds(self):
        """Median seconds of the repetitions."""
        return float(np.median([cost.seconds for cost in self.costs]))

    @property
    def peak(self):
        return max(cost.peak for cost in self.costs)


@dataclass(frozen=True, eq=False)
class Curve:
    name: str
    group: str
    points: list

    @property
    def unit(self):
        """Unit of the samples of the curve's points."""
        return UNITS.get(self.group, "rays per texel")


@dataclass(frozen=True, eq=False)
class Curves:
    """curves: the last is that of Cycles, if there is one; reference: the Isosurfaces."""

    curves: list
    reference: object
    effort: CurveEffort

    def of(self, name):
        """Returns the Curve of a name, or None."""
        return next((curve for curve in self.curves if curve.name == name), None)


@dataclass(frozen=True)
class Cost:
    """The cost of a bake. seconds: processor time of all threads; rays: None if unknown; peak: peak
    memory of the process in bytes; file: bytes, None without a file.
    """

    seconds: float
    rays: int
    peak: int
    file: int


def measured(work):
    """Returns (Bake, Cost) of work(), which bakes."""
    # Reset the peak memory, which Linux may allow.
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    start = time.process_time()
    baked = work()
    seconds = time.process_time() - start
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        path = Path(folder) / "bake.vdb"
        baked.save(path)
        size = path.stat().st_size
    return baked, Cost(seconds, baked.statistics.rays, baked.statistics.peak_memory_bytes, size)


def measure_curves(effort, *, cycles=True, kinds=KINDS):
    """Returns the Curves of the bump box in its scene; cycles: whether Cycles gets a curve."""
    volume = bump_box(effort.texels)
    scene = packaged_scene("bump_box.json")
    scene = fit_scene(match_isosurfaces(scene, [volume]), [volume])
    # Use another seed than all bakes.
    reference = isosurfaces(
        [volume],
        scene,
        volume.data_range(),
        ISOVALUES,
        effort.vertices,
        effort.paths,
        seed=effort.repetitions,
    )
    # (radiance at the points, Cost) of each repetition, by curve and samples.
    runs = {}
    for repetition in range(effort.repetitions):
        for kind in kinds:
            for samples in kind.efforts(effort):
                print(f"{kind.name}, {samples}, seed {repetition} ...", file=sys.stderr)
                work = partial(_baked, volume, scene, kind, samples, repetition)
                baked, cost = measured(work)
                found = reference.radiance(baked), cost
                runs.setdefault((kind.name, samples), []).append(found)
        if cycles:
            found = _by_cycles(scene, reference, effort.cycles, repetition)
            for samples, one in zip(effort.cycles, found):
                runs.setdefault((CYCLES, samples), []).append(one)
    names = [(kind.name, kind.group) for kind in kinds] + [(CYCLES, "Cycles")] * cycles
    curves = [Curve(*name, _points(name[0], runs, reference)) for name in names]
    return Curves(curves, reference, effort)


def _baked(volume, scene, kind, samples, seed):
    """Bakes all isosurfaces with this number of samples (UNITS)."""
    settings = {"isovalues": volume.data_range(), "seed": seed}
    if kind.group == "bake":
        return bake(volume, scene, resolution=samples, **settings)
    count = max(1, samples * volume.values.size // RAYS)
    scattered = kind.strategy and Scattered(kind.strategy, count)
    settings |= {"estimator": kind.estimator, "photons": samples * PHOTONS}
    settings |= {"samples": RAYS if scattered else samples, "scattered": scattered}
    return bake_fixed_samples(volume, scene, **settings)


def _by_cycles(scene, reference, samples, seed):
    """Returns (radiance at the points, Cost of one isosurface) for each number of samples.

    A warm-up pass comes first. Blender's start and its building of the scene do not count.
    """
    radiance, seconds, peaks = [], [], []
    for surface in reference.surfaces:
        mesh = surface.vertices, surface.normals, surface.triangles
        passes = [(count, seed) for count in (samples[0], *samples)]
        found = bake_vertices(scene, surface.isovalue, mesh, passes)
        radiance.append(found.radiance[1:, surface.chosen])
        seconds.append(found.processor_seconds[1:])
        peaks.append(found.peaks[1:])
    costs = [
        Cost(float(mean), None, int(peak), None)
        for mean, peak in zip(np.mean(seconds, axis=0), np.max(peaks, axis=0))
    ]
    return list(zip(np.concatenate(radiance, axis=1), costs))


def _points(name, runs, reference):
    points = []
    for (curve, samples), found in runs.items():
        if curve == name:
            radiances = np.array([radiance for radiance, _ in found])
            error = np.sqrt(np.mean([reference.error(one) ** 2 for one in radiances]))
            noise = reference.spread(radiances)
            points.append(Point(samples, [cost for _, cost in found], float(error), noise))
    return points
