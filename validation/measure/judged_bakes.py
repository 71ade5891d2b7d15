# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares default bakes with Cycles, an independent reference, and with their own error estimates.

Each case is baked once, with the default settings. Cycles measures some isosurfaces at random
points of the mesh that users see (cycles.py). The core's path tracer measures the nearest points of
the isosurface. The bake is compared with both.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from leaflight.bake.bake import bake
from leaflight.bake.estimate import Estimate, estimate
from leaflight.bake.settings import DEFAULT_ERROR
from leaflight.bake.statistics import Statistics
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.sampling import Sampling
from leaflight.measure.sides import IsosurfaceSide
from leaflight.measure.truth import errors_of
from leaflight.volume.particles import hydrogen, lapr, neuron, nucleons
from leaflight.volume.volume import bump_box
from volume_recipes import (
    amos,
    aneurism,
    bunny,
    colin27,
    electron_density,
    engine,
    generated,
    heptane,
    hydrogen_vti,
    isabel,
    neuron_stack,
    nucleon,
    orbital,
    tooth,
)

# Seed of the reference, which differs from the bake's.
SEED = 1
REACHED, REPORTED, EXCEEDED = "reached", "reported", "exceeded"


@dataclass(frozen=True)
class Case:
    """A case to bake.

    volumes: volumes(folder, fineness), see volume_recipes.py
    isovalues: common isovalues to judge, on each of the volumes
    scene: a scene of the package; None is the Cornell box
    """

    name: str
    volumes: Callable
    isovalues: tuple
    scene: str = None


CASES = (
    Case("bump box, 40^3", generated(bump_box, 40), (20.0, 47.0, 100.0), "bump_box.json"),
    Case("bump box, 100^3", generated(bump_box, 100), (20.0, 47.0, 100.0), "bump_box.json"),
    Case("hydrogen, 64^3", generated(hydrogen, 64), (0.02, 0.15, 0.4)),
    Case("neuron, 150^3", generated(neuron, 150), (30.0, 60.0, 80.0)),
    Case("nucleons, 2 x 101^3", generated(nucleons, 101), (0.2, 0.4, 0.6), "nucleons.json"),
    Case("LAPR, 2 x 120^3", generated(lapr, 120), (0.2, 0.4, 0.6), "lapr.json"),
    Case("orbital (N2O_homo+lumo.cube.gz)", orbital, (-0.05, 0.02, 0.1)),
    Case("nucleon (nucleon.raw)", nucleon, (60.5, 100.5, 140.5)),
    Case("hydrogen (hydrogen.vti)", hydrogen_vti, (0.02, 0.15, 0.4)),
    Case("electron density (1jzv.ccp4)", electron_density, (0.5, 1.0, 1.5)),
    Case("Isabel (isabel_02.vti)", isabel, (10.0, 20.0, 40.0)),
    Case("tooth (tooth16.raw)", tooth, (500.5, 650.5, 900.5)),
    Case("Colin27 (ch2.nii.gz)", colin27, (24.5, 45.5, 70.5, 100.5)),
    Case("engine (engine.vti)", engine, (50.5, 100.5, 150.5)),
    Case("neuron stack (rivulet_neuron.tif.zip)", neuron_stack, (20.5, 60.5, 100.5)),
    Case("aneurism (aneurism.nrrd)", aneurism, (30.5, 60.5, 100.5)),
    Case("bunny (bunny_ct_half.nrrd)", bunny, (400.5, 800.5, 1200.5)),
    Case("abdomen (amos_0336.mhd)", amos, (-500.5, -200.5, 150.5)),
    Case("heptane (heptane.nii.gz)", heptane, (20.5, 40.5, 80.5)),
)
# Smaller cases, which need no data.
QUICK_CASES = (
    replace(CASES[1], name="bump box, 48^3", volumes=generated(bump_box, 48)),
    replace(CASES[2], name="hydrogen, 32^3", volumes=generated(hydrogen, 32)),
)


@dataclass(frozen=True)
class CyclesEffort:
    """The effort of the comparison.

    points: points of each isosurface
    paths: paths of Cycles and of the path tracer at each point
    noise: percent above which Cycles measures once more, with as many paths as it needs
    judged: True if there are verdicts
    """

    cases: tuple = CASES
    points: int = 1200
    paths: int = 1024
    noise: float = 0.5
    judged: bool = True


QUICK_CYCLES = CyclesEffort(QUICK_CASES, points=400, paths=256, noise=np.inf, judged=False)


@dataclass(frozen=True)
class BakeRow:
    """The bake of a case: its statistics, and the Estimate before it."""

    case: Case
    nodes: tuple
    before: Estimate
    statistics: Statistics

    @property
    def after(self):
        """The error in percent that the bake estimates at its end."""
        return self.statistics.estimated_error_percent

    @property
    def reported(self):
        """True if the bake reported an error above the target before and afterwards."""
        return min(self.before.error, self.after) > DEFAULT_ERROR


@dataclass(frozen=True)
class CyclesRow:
    """One isosurface of a bake. volume: its name, None if there is only one; paths: of Cycles, per
    point; errors: errors_of() the bake against Cycles; parts: parts_of() them.
    """

    bake: BakeRow
    volume: str
    isovalue: float
    paths: int
    errors: dict
    parts: dict
    judged: bool

    @property
    def verdict(self):
        """Returns one of three verdicts, or None if nothing is judged."""
        if not self.judged:
            return None
        if self.errors["rms_percent"] <= DEFAULT_ERROR:
            return REACHED
        return REPORTED if self.bake.reported else EXCEEDED


def measure_against_cycles(effort, folder=None):
    """Returns (rows, absent): a CyclesRow for each isosurface, and names of cases without data.

    folder: contains the files of real volumes, or None. Raises LeaflightError, also without
    Blender.
    """
    rows, absent = [], []
    for case in effort.cases:
        volumes = case.volumes(folder, 1.0)
        if volumes is None:
            absent.append(case.name)
        else:
            rows += _rows(case, volumes, effort)
    return rows, absent


def _rows(case, volumes, effort):
    print(f"{case.name} ...", file=sys.stderr)
    scene = packaged_scene(case.scene) if case.scene else None
    before = estimate(volumes, scene)
    baked = bake(volumes, scene)
    judged = [
        (number, isovalue, *_judged(IsosurfaceSide(baked, isovalue, number), effort))
        for number in range(len(volumes))
        for isovalue in case.isovalues
    ]
    of_bake = BakeRow(case, tuple(volumes[0].field().dims), before, baked.statistics)
    names = [volume.name for volume in volumes] if len(volumes) > 1 else [None]
    return [
        CyclesRow(of_bake, names[number], isovalue, paths, errors, parts, effort.judged)
        for number, isovalue, paths, errors, parts in judged
    ]


def _judged(side, effort):
    """Returns (paths, errors, their parts) of an IsosurfaceSide."""
    exposure = side.bake.scene.exposure

    def errors(truth):
        return errors_of(side.baked(truth.points), truth, exposure)

    paths = effort.paths
    truth = side.by_cycles(Sampling(effort.points, paths, SEED), None)
    noise = errors(truth)["reference_noise_percent"]
    if noise > effort.noise:
        paths = int(np.ceil(paths * (noise / effort.noise) ** 2))
        truth = side.by_cycles(Sampling(effort.points, paths, SEED), None)
    path = side.path_traced_at(truth.points, Sampling(spp=paths, seed=SEED), None)
    return paths, errors(truth), side.parts(truth, path)
