# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench bake`: bakes with the default settings beside Cycles, which bakes one isosurface.

The bake lights all isosurfaces of its range. At one of them compare.py measures its error against
Cycles. Cycles bakes the vertices of that one to the same error (cycles_peer.py). Bake and Cycles
take turns, so that other work of the machine slows both equally.
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from leaflight.bake.bake import bake
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.compare import compare
from leaflight.measure.truth import without
from volume_recipes import colin27, engine, generated, heptane, nucleon
from leaflight.volume.volume import bump_box
from .cycles_peer import Peer
from .interpolation import cost_at
from .repetitions import repetitions


# Names of the bake's statistics that a row keeps.
KEPT = ("estimated_rms_percent", "estimated_error_percent", "passes", "rays", "texels")


@dataclass(frozen=True)
class Case:
    """volumes(folder, fineness): see volume_recipes.py; isovalue: that Cycles bakes, too; scene: of
    the package, None is the Cornell box.
    """

    name: str
    volumes: object
    isovalue: float
    scene: str = None


CASES = (
    Case("bump box, 40^3", generated(bump_box, 40), 47.0, "bump_box.json"),
    Case("bump box, 100^3", generated(bump_box, 100), 47.0, "bump_box.json"),
    Case("nucleon (nucleon.raw)", nucleon, 100.5),
    Case("Colin27 (ch2.nii.gz)", colin27, 45.5),
    Case("engine (engine.vti)", engine, 100.5),
    Case("heptane (heptane.nii.gz)", heptane, 80.5),
)
QUICK_CASES = (replace(CASES[0], name="bump box, 16^3", volumes=generated(bump_box, 16)),)


@dataclass(frozen=True)
class BakeEffort:
    """points, paths: at which `compare` takes the error, and of Cycles at each; most_paths: of one
    pass of Cycles over all vertices, which bounds its time; often(seconds): see repetitions.py.
    """

    cases: tuple = CASES
    points: int = 3000
    paths: int = 1024
    most_paths: int = 100_000_000
    often: object = repetitions


QUICK_BAKES = BakeEffort(QUICK_CASES, 200, 64, 1_000_000, lambda _: 1)


def measure_bakes(effort, run, *, folder=None, seed=0, threads=0):
    """Returns (rows, absent): a dict for each case there is, and the names of the others.

    folder: with the files of real volumes, or None; run(work, label) returns work(progress). A row:

    name, isovalue, nodes     the volume, and the isosurface that is compared with Cycles
    bake_seconds              time by the clock, median over the repetitions
    rms_percent               difference from Cycles by compare(), which includes Cycles' noise
    judge_noise_percent       noise of Cycles in it
    error_percent             the first without the second, in squares
    noise_percent, texture_percent
                              parts of error_percent (truth.py)
    estimated_rms_percent     noise that the texels report
    estimated_error_percent, passes
                              as in the bake's statistics
    cycles_seconds            time by the clock in which Cycles bakes the vertices of the isosurface
                              to error_percent, interpolated; None outside the measured points
    outside                   FEWER or MORE, the samples that it then takes (interpolation.py)
    break_even                bake_seconds / cycles_seconds, or None
    cycles                    the measured points: dicts of samples at a corner, seconds, and
                              error_percent
    rays, texels, vertices, repetitions

    Raises LeaflightError, also without Blender, and Cancelled.
    """
    rows, absent = [], []
    for case in effort.cases:
        volumes = case.volumes(folder, 1.0)
        if volumes is None:
            absent.append(case.name)
        else:
            rows.append(_row(case, volumes[0], effort, run, seed, threads))
    return rows, absent


def _row(case, volume, effort, run, seed, threads):
    scene = packaged_scene(case.scene) if case.scene else None
    work = {"seed": seed, "threads": threads}

    def step(work, label):
        return run(work, f"bench: {case.name}, {label}")

    def baked():
        start = time.perf_counter()
        found = step(lambda progress: bake(volume, scene, progress=progress, **work), "bake")
        return found, time.perf_counter() - start

    first, seconds = baked()
    known = _known(first, case, effort, step, work)
    error, judge = known["error_percent"], known["judge_noise_percent"]
    peer = Peer.of(first, case.isovalue, effort.most_paths, seed, threads)
    # Two bakes of a large volume take much memory.
    del first
    # Far below the judge's noise nothing is known of the error.
    planned_error = max(error, judge / 4)
    samples = peer.reference_samples(planned_error, judge, effort.paths)
    truth, one_pass = step(lambda progress: peer.reference(samples, progress), "Cycles at length")
    counts = peer.counts(planned_error, samples, one_pass)

    bakes, passes = [seconds], []
    while True:
        start = time.perf_counter()
        passes.append(
            step(lambda progress: peer.measured(counts, len(passes), truth, progress), "Cycles")
        )
        seconds = bakes[-1] + time.perf_counter() - start
        if len(passes) >= effort.often(seconds):
            break
        bakes.append(baked()[1])
    errors = np.sqrt(np.mean([np.square(errors) for errors, _ in passes], axis=0))
    seconds = np.median([seconds for _, seconds in passes], axis=0)
    bake_seconds = float(np.median(bakes))
    cycles_seconds, outside = cost_at(error, errors, seconds)
    return {
        "name": case.name,
        "isovalue": case.isovalue,
        "nodes": list(volume.field().dims),
        "bake_seconds": bake_seconds,
        **known,
        "cycles_seconds": cycles_seconds,
        "outside": outside,
        "break_even": None if cycles_seconds is None else bake_seconds / cycles_seconds,
        "cycles": [
            {"samples": count, "seconds": float(own), "error_percent": float(errs)}
            for count, own, errs in zip(counts, seconds, errors)
        ],
        "vertices": peer.vertices,
        "repetitions": len(bakes),
    }


def _known(baked, case, effort, step, work):
    """Returns the part of a row about a Bake itself, and about its error against Cycles."""
    judged = step(
        lambda progress: compare(
            baked,
            case.isovalue,
            points=effort.points,
            spp=effort.paths,
            reference="cycles",
            progress=progress,
            **work,
        ),
        "error",
    )
    rms, judge = judged["rms_percent"], judged["reference_noise_percent"]
    return {
        "rms_percent": rms,
        "judge_noise_percent": judge,
        "error_percent": without(rms, judge),
        "noise_percent": judged["parts"]["noise_percent"],
        "texture_percent": judged["parts"]["texture_percent"],
        **{name: getattr(baked.statistics, name) for name in KEPT},
    }
