# SPDX-License-Identifier: GPL-3.0-or-later
"""How far bakes are from Cycles, an independent judge, and what keeps them from it.

Each case is baked once, and some isosurfaces of it are measured by Cycles at random points of the
mesh that users see (cycles.py), and by the core's path tracer on the leaf next to these.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..bake.bake import bake
from ..bake.color_error import REACH, noise_percent, rms_percent
from ..io.scene_file import cornell_box, packaged_scene
from ..measure.sides import LeafSide
from ..measure.truth import errors_of, without
from ..measure.volume_recipes import (
    bunny,
    colin27,
    generated,
    neuron_stack,
    nucleon,
    tooth,
)
from ..volume.particles import hydrogen
from ..volume.volume import bump_box
from .fits import Estimate

# What is held against the floor of its texture may err this many times as much.
OF_FLOOR = 1.15


@dataclass(frozen=True)
class Case:
    """What is baked, and how near to Cycles it must be.

    volumes(folder, fineness): see volume_recipes.py; isovalues: that are judged; goals: of each,
    RMS in percent, None is OF_FLOOR times the floor of the texture; texels: a node, along each
    axis; refine: how many times they are halved where light varies most; rays, paths: as shares of
    the effort's; scene: of the package, None is the Cornell box.
    """

    name: str
    volumes: object
    isovalues: tuple
    goals: tuple = None
    texels: float = 1.0
    refine: int = 0
    rays: float = 1.0
    paths: float = 1.0
    scene: str = None

    def goal(self, isovalue, floor):
        """The RMS in percent that is allowed."""
        if self.goals is None:
            return OF_FLOOR * floor
        return self.goals[self.isovalues.index(isovalue)]


BUMP_BOX = Case(
    "bump box, 100^3",
    generated(bump_box, 100),
    (20.0, 47.0, 100.0),
    (2.0, 2.0, 2.0),
    scene="bump_box.json",
)
HYDROGEN = Case(
    "hydrogen, 64^3", generated(hydrogen, 64), (0.02, 0.15, 0.4), (2.0, 2.0, 2.0), refine=2
)
CASES = (
    BUMP_BOX,
    Case("nucleon (nucleon.raw)", nucleon, (60.5, 100.5, 140.5), (2.0, 2.0, 2.0), refine=3),
    HYDROGEN,
    Case(
        "bunny (bunny_ct_half.nrrd)",
        bunny,
        (400.5, 800.5, 1200.5),
        (2.0, 2.0, 2.0),
        refine=2,
    ),
    Case(
        "Colin27 (ch2.nii.gz), fine",
        colin27,
        (24.5, 45.5, 70.5),
        (3.0, 3.0, 4.0),
        texels=2.0,
        rays=0.25,
    ),
    Case(
        "Colin27 (ch2.nii.gz), refined",
        colin27,
        (24.5, 45.5, 70.5),
        (3.0, 3.0, 4.0),
        refine=2,
        rays=0.5,
    ),
    Case("Colin27 (ch2.nii.gz)", colin27, (100.5,)),
    # Its floor is so low that noise counts, that of Cycles too.
    Case(
        "tooth (tooth16.raw)",
        tooth,
        (500.5, 650.5, 900.5),
        refine=1,
        rays=4.0,
        paths=4.0,
    ),
    Case("neuron stack (rivulet_neuron.tif.zip)", neuron_stack, (20.5, 60.5, 100.5)),
)
# The same in little, of what needs no data.
QUICK_CASES = (
    replace(BUMP_BOX, name="bump box, 48^3", volumes=generated(bump_box, 48)),
    replace(HYDROGEN, name="hydrogen, 32^3", volumes=generated(hydrogen, 32)),
)


@dataclass(frozen=True)
class CyclesEffort:
    """rays: of a texel; points: of each isosurface; paths: of Cycles and of the path tracer, at
    each point; floor_samples: of the texels that tell the floor; judged: whether there are goals.
    """

    cases: tuple = CASES
    rays: int = 32
    photons: int = 2_000_000
    points: int = 1500
    paths: int = 1024
    floor_samples: int = 256
    judged: bool = True


QUICK_CYCLES = CyclesEffort(
    cases=QUICK_CASES,
    rays=8,
    photons=500_000,
    points=400,
    paths=256,
    floor_samples=64,
    judged=False,
)


@dataclass(frozen=True)
class CyclesRow:
    """One isosurface of a case. rays: of a texel; paths: of Cycles, at a point; texels, seconds: of
    the whole bake, by the clock; errors: errors_of() it against Cycles.

    parts: parts_of() these; floor: RMS in percent that converged texels leave, the noise of theirs
    and of Cycles taken out; goal: RMS in percent that is allowed, None where nothing is judged.
    """

    case: Case
    isovalue: float
    rays: int
    paths: int
    texels: int
    seconds: float
    errors: dict
    parts: dict
    floor: float
    goal: float

    @property
    def error(self):
        return self.errors["rms_percent"]

    @property
    def passed(self):
        """Whether the goal is met; None where nothing is judged."""
        return None if self.goal is None else self.error <= self.goal

    @property
    def bias(self):
        """By how many percent the mean is off, an Estimate; NaN where all is dark."""
        ratio, error = self.errors["mean_ratio"], self.errors["mean_ratio_error"]
        if ratio is None:
            return Estimate(np.nan, np.nan, np.nan)
        bias, reach = 100 * (ratio - 1), 100 * REACH * error
        return Estimate(bias, bias - reach, bias + reach)


def measure_against_cycles(effort, run, *, folder=None, seed=0, threads=0):
    """Returns (rows, absent): a CyclesRow for each isosurface, and names of cases without data.

    folder: with the files of the real ones, or None; run(work, label): see experiments.py.
    Raises LeaflightError, also without Blender, and Cancelled.
    """
    rows, absent = [], []
    for case in effort.cases:
        volumes = case.volumes(folder, 1.0)
        if volumes is None:
            absent.append(case.name)
        else:
            rows += _rows(case, volumes, effort, run, seed, threads)
    return rows, absent


def _rows(case, volumes, effort, run, seed, threads):
    scene = packaged_scene(case.scene) if case.scene else cornell_box()
    settings = {
        "resolution": max(2, round(case.texels * max(volumes[0].field().dims))),
        "seed": seed,
        "threads": threads,
    }

    def step(work, label):
        return run(work, f"against Cycles: {case.name}, {label}")

    def baked(label, **more):
        return step(
            lambda progress: bake(volumes, scene, progress=progress, **settings, **more), label
        )

    rays = max(1, round(case.rays * effort.rays))
    final = baked("bake", samples=rays, photons=effort.photons, refine=case.refine)
    paths = max(1, round(case.paths * effort.paths))
    # Another seed than the bakes'.
    work = {"spp": paths, "seed": seed + 1, "threads": threads}
    found = [_found(LeafSide(final, c), effort.points, work, step) for c in case.isovalues]
    converged = baked(
        "floor",
        isovalues=final.isovalues,
        estimator="path",
        samples=effort.floor_samples,
        only_at=np.concatenate([truth.points for _, truth, _ in found]),
    )
    rows = []
    for side, truth, path in found:
        floor = floor_percent(converged, truth)
        rows.append(
            CyclesRow(
                case,
                side.isovalue,
                rays,
                paths,
                final.statistics["texels"],
                final.statistics["seconds"],
                errors_of(side.baked(truth.points), truth, final.scene.exposure),
                side.parts(truth, path),
                floor,
                case.goal(side.isovalue, floor) if effort.judged else None,
            )
        )
    return rows


def _found(side, points, work, step):
    """The side with the Truth of Cycles and that of the path tracer at the same points."""
    truth = step(
        lambda progress: side.by_cycles(points, progress=progress, **work),
        f"Cycles at {side.isovalue:g}",
    )
    path = step(
        lambda progress: side.path_traced_at(truth.points, progress=progress, **work),
        f"paths at {side.isovalue:g}",
    )
    return side, truth, path


def floor_percent(converged, truth):
    """RMS in percent of a bake against the truth, without the noise that either reports."""
    exposure, weights = converged.scene.exposure, truth.weights
    radiance = converged.radiance(truth.points)
    error = converged.radiance_error(truth.points)[:, None]
    return without(
        rms_percent(radiance, truth.radiance, exposure, weights),
        noise_percent(radiance, error, exposure, weights),
        noise_percent(truth.radiance, truth.standard_error, exposure, weights),
    )
