# SPDX-License-Identifier: GPL-3.0-or-later
"""`bench bake`: default bakes against Cycles, which bakes one isosurface.

The bake lights all isosurfaces of its range. compare() measures its error at one of them against
Cycles. Cycles bakes the vertices of that one to the same error (cycles_peer.py). Bake and Cycles
alternate, so that other work of the machine slows both equally.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from leaflight.bake.bake import bake
from leaflight.io.scene_file import packaged_scene
from leaflight.measure.compare import compare
from leaflight.measure.cycles import find_blender
from leaflight.measure.truth import without
from leaflight.volume.volume import bump_box
from written import table
from volume_recipes import absent_text, colin27, engine, generated, heptane, nucleon

from .cycles_peer import FEWER, Peer, cost_at
from .page import REPETITIONS, measured_on, repetitions


@dataclass(frozen=True)
class Case:
    """A case. volumes: see volume_recipes.py; isovalue: of the isosurface that Cycles bakes; scene:
    of the package, None is the Cornell box.
    """

    name: str
    volumes: Callable
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


@dataclass(frozen=True)
class Effort:
    """The effort. points, paths: points and paths per point for `compare`; most_paths: upper bound
    of one pass of Cycles over all vertices, which limits its time; often(seconds): see page.py.
    """

    cases: tuple = CASES
    points: int = 3000
    paths: int = 1024
    most_paths: int = 100_000_000
    often: Callable = repetitions


QUICK = Effort(
    (Case("bump box, 16^3", generated(bump_box, 16), 47.0, "bump_box.json"),),
    points=200,
    paths=64,
    most_paths=1_000_000,
    often=lambda _: 1,
)


def bakes_section(options):
    """Returns lines of Markdown. Raises LeaflightError without Blender."""
    find_blender()
    effort = QUICK if options.quick else Effort()
    rows, points, absent = [], [], []
    for case in effort.cases:
        volumes = case.volumes(options.data, 1.0)
        if volumes is None:
            absent.append(case.name)
        elif options.only in case.name:
            row, of_cycles = _measured(case, volumes[0], effort)
            rows.append(row)
            points += of_cycles
    return [
        "## Bakes against Cycles",
        "",
        measured_on(),
        "",
        "- Each bake has default settings and lights all isosurfaces of its default range. RMS % "
        "is its error against Cycles at one isosurface, as `compare` reports it. *Noise* and "
        "*texture* are parts of it. Their squares add up with those of the reference's noise and "
        "of the mesh.",
        "- *Cycles s* is the time in which Cycles bakes the vertices of this one isosurface to the "
        "same error, without the reference's noise. The mesh is marching cubes at the nodes. "
        "*Break-even* is bake s over Cycles s. For more isosurfaces the bake is faster.",
        "- Cycles is measured at the samples below, against many more. Values "
        "between them are interpolated, and none is extrapolated. Blender's start, the setup of "
        "the scene and errors between the vertices do not count.",
        "- Seconds are wall-clock medians. Bake and Cycles take turns, "
        f"{REPETITIONS} times, or fewer if one turn takes minutes (*repetitions*).",
        *absent_text(absent),
        "",
        *table(rows),
        "",
        "*Samples* of Cycles are paths at each corner of a triangle:",
        "",
        *table(points),
    ]


def _measured(case, volume, effort):
    """Returns the row of a bake, and the rows of Cycles by number of samples."""
    first, seconds = _baked(case, volume)
    statistics = first.statistics
    judged = compare(
        first, case.isovalue, points=effort.points, spp=effort.paths, reference="cycles"
    )
    rms, judge = judged["rms_percent"], judged["reference_noise_percent"]
    error = without(rms, judge)
    peer = Peer.of(first, case.isovalue, effort.most_paths)
    # Free the first bake, because two of a large volume take much memory.
    del first
    # Errors far below the noise of the reference cannot be measured.
    planned_error = max(error, judge / 4)
    samples = peer.reference_samples(planned_error, judge, effort.paths)
    truth, one_pass = peer.reference(samples)
    counts = peer.counts(planned_error, samples, one_pass)

    bakes, passes = [seconds], []
    while True:
        start = time.perf_counter()
        passes.append(peer.measured(counts, len(passes), truth))
        seconds = bakes[-1] + time.perf_counter() - start
        if len(passes) >= effort.often(seconds):
            break
        bakes.append(_baked(case, volume)[1])
    errors = np.sqrt(np.mean([np.square(errors) for errors, _ in passes], axis=0))
    seconds = np.median([seconds for _, seconds in passes], axis=0)
    bake_seconds = float(np.median(bakes))
    cycles_seconds, outside = cost_at(error, errors, seconds)
    name = f"{case.name} at {case.isovalue:g}"
    row = {
        "bake": name,
        "texels": f"{statistics.texels:,}",
        "million rays": f"{statistics.rays / 1e6:.1f}",
        "bake s": f"{bake_seconds:.2f}",
        "RMS %": f"{rms:.2f}",
        "noise %": f"{judged['parts']['noise_percent']:.2f}",
        "texture %": f"{judged['parts']['texture_percent']:.2f}",
        "noise of the reference %": f"{judge:.2f}",
        "Cycles s": None if cycles_seconds is None else f"{cycles_seconds:.2f}",
        "break-even": break_even(bake_seconds, cycles_seconds, outside, seconds),
        "vertices": f"{peer.vertices:,}",
        "repetitions": f"{len(bakes)}",
    }
    return row, [
        {"bake": name, "samples": f"{count:,}", "s": f"{second:.2f}", "error %": f"{error:.2f}"}
        for count, second, error in zip(counts, seconds, errors)
    ]


def break_even(bake_seconds, cycles_seconds, outside, seconds):
    """Returns the ratio, or words if it is outside the measured points."""
    if outside is None:
        return f"{bake_seconds / cycles_seconds:.2f}"
    side, end = ("above", seconds[0]) if outside == FEWER else ("below", seconds[-1])
    return f"{side} {bake_seconds / end:.2g}: {outside}"


def _baked(case, volume):
    """Returns (Bake, wall-clock seconds)."""
    scene = packaged_scene(case.scene) if case.scene else None
    start = time.perf_counter()
    return bake(volume, scene), time.perf_counter() - start
